#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "base/core/error.h"
#include "base/settings/settings.h"

namespace sightline {
namespace {

enum class Mode { full, one_hit, fast };

struct Sample {
  bool shadows = true;
  int light_samples = 4;
  std::int64_t big = 5;
  std::uint32_t count = 6;
  std::uint8_t level = 7;
  float threshold = 0.25f;
  double tolerance = 1e-3;
  Mode mode = Mode::full;
  std::string filter = "gaussian";
  std::string label;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("shadows", &Sample::shadows, {.help = "trace shadow rays"});
    visit("light_samples", &Sample::light_samples, {.help = "a shading point", .minimum = 1, .maximum = 1024});
    visit("big", &Sample::big, {.help = "any"});
    visit("count", &Sample::count, {.help = "any"});
    visit("level", &Sample::level, {.help = "any"});
    visit("threshold", &Sample::threshold, {.help = "splits", .minimum = 0, .maximum = 1, .symbol = "tau"});
    visit("tolerance", &Sample::tolerance, {.help = "stops", .unit = "px"});
    visit("mode", &Sample::mode, {.help = "which", .choices = {"full", "one-hit", "fast"}});
    visit("filter", &Sample::filter, {.help = "which", .choices = {"gaussian", "box"}});
    visit("label", &Sample::label, {.help = "free text"});
  }
};

std::string message_of(const char* assignment) {
  SettingsValue value = SettingsValue::of<Sample>();
  try {
    value.apply(assignment);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    return error.what();
  }
  return "";
}

TEST(Settings, DefaultsAreThoseOfTheStruct) {
  const SettingsValue value = SettingsValue::of<Sample>();
  EXPECT_TRUE(value.as<Sample>().shadows);
  EXPECT_EQ(value.as<Sample>().light_samples, 4);
  EXPECT_EQ(value.to_text().front(), (std::pair<std::string, std::string>("shadows", "true")));
  EXPECT_EQ(value.to_text().size(), 10u);
}

TEST(Settings, EveryTypeIsSetFromText) {
  SettingsValue value = SettingsValue::of<Sample>();
  for (const char* assignment : {"shadows=off", "light_samples=16", "big=-9000000000000000000", "count=4000000000", "level=255",
                                 "threshold=0.125", "tolerance=2.5e-7", "mode=one-hit", "filter=box", "label=a=b c"})
    value.apply(assignment);
  const auto& sample = value.as<Sample>();
  EXPECT_FALSE(sample.shadows);
  EXPECT_EQ(sample.light_samples, 16);
  EXPECT_EQ(sample.big, -9000000000000000000);
  EXPECT_EQ(sample.count, 4000000000u);
  EXPECT_EQ(sample.level, 255);
  EXPECT_EQ(sample.threshold, 0.125f);
  EXPECT_EQ(sample.tolerance, 2.5e-7);
  EXPECT_EQ(sample.mode, Mode::one_hit);
  EXPECT_EQ(sample.filter, "box");
  EXPECT_EQ(sample.label, "a=b c");
}

TEST(Settings, TextRoundTripsForEveryType) {
  const Sample original{.shadows = false,
                        .light_samples = 77,
                        .big = std::numeric_limits<std::int64_t>::min(),
                        .count = 4294967295u,
                        .level = 200,
                        .threshold = 0.1f,
                        .tolerance = 1.0 / 3,
                        .mode = Mode::fast,
                        .filter = "box",
                        .label = "x y=z"};
  const SettingsValue written = SettingsValue::of(original);
  SettingsValue read = SettingsValue::of<Sample>();
  for (const auto& [name, text] : written.to_text()) read.apply(name + "=" + text);
  EXPECT_EQ(read.to_text(), written.to_text());
  EXPECT_EQ(read.as<Sample>().threshold, original.threshold);
  EXPECT_EQ(read.as<Sample>().tolerance, original.tolerance);
  EXPECT_EQ(read.as<Sample>().big, original.big);
}

TEST(Settings, UnknownKeyNamesTheNearest) {
  EXPECT_EQ(message_of("light_sample=3"), "unknown setting 'light_sample'; did you mean 'light_samples'?");
  EXPECT_EQ(message_of("treshold=0.3"), "unknown setting 'treshold'; did you mean 'threshold'?");
}

TEST(Settings, UnknownKeyFarFromAllListsThem) {
  EXPECT_NE(message_of("zzzzzzzz=1").find("known: shadows, light_samples"), std::string::npos);
}

TEST(Settings, MissingEqualsSignIsExplained) { EXPECT_NE(message_of("shadows").find("KEY=VALUE"), std::string::npos); }

TEST(Settings, ValuesOutsideTheRangeAreRefusedWithIt) {
  EXPECT_EQ(message_of("light_samples=0"), "setting light_samples = 0 is outside [1, 1024]");
  EXPECT_EQ(message_of("light_samples=1025"), "setting light_samples = 1025 is outside [1, 1024]");
  EXPECT_EQ(message_of("threshold=1.5"), "setting threshold = 1.5 is outside [0, 1]");
  EXPECT_EQ(message_of("light_samples=1024"), "");
  EXPECT_EQ(message_of("threshold=1"), "");
}

TEST(Settings, ValuesThatTheTypeCannotHoldAreRefused) {
  for (const char* assignment :
       {"count=-1", "count=4294967296", "level=256", "big=9223372036854775808", "light_samples=99999999999999999999"})
    EXPECT_NE(message_of(assignment), "") << assignment;
}

TEST(Settings, WhatIsNotOfTheTypeIsRefused) {
  for (const char* assignment : {"shadows=maybe", "light_samples=4.5", "light_samples=", "light_samples=4 ", "threshold=nan",
                                 "threshold=1,5", "threshold=", "tolerance=1x", "mode=slow", "filter=Box"})
    EXPECT_NE(message_of(assignment), "") << assignment;
}

TEST(Settings, AChoiceThatIsNoneListsThem) { EXPECT_EQ(message_of("mode=slow"), "setting mode = 'slow' is none of full, one-hit, fast"); }

TEST(Settings, BooleansTakeTheUsualWords) {
  for (const char* word : {"true", "on", "yes", "1"}) EXPECT_TRUE(parse_boolean("b", word)) << word;
  for (const char* word : {"false", "off", "no", "0"}) EXPECT_FALSE(parse_boolean("b", word)) << word;
}

TEST(Settings, ARefusedValueLeavesTheOldOne) {
  SettingsValue value = SettingsValue::of<Sample>();
  EXPECT_THROW(value.apply("light_samples=0"), Error);
  EXPECT_EQ(value.as<Sample>().light_samples, 4);
}

TEST(Settings, CopiesAreIndependent) {
  const SettingsValue original = SettingsValue::of<Sample>();
  SettingsValue copy = original;
  copy.apply("light_samples=9");
  EXPECT_EQ(original.as<Sample>().light_samples, 4);
  EXPECT_EQ(copy.as<Sample>().light_samples, 9);
}

TEST(Settings, SchemaTellsWhatHelpNeeds) {
  const Schema schema = Schema::of<Sample>();
  const Setting& threshold = schema.find("threshold");
  EXPECT_EQ(threshold.type, SettingType::real);
  EXPECT_EQ(threshold.info.symbol, "tau");
  EXPECT_EQ(schema.find("mode").type, SettingType::text);
  EXPECT_EQ(schema.find("mode").info.choices.size(), 3u);
  EXPECT_EQ(schema.find("shadows").type, SettingType::boolean);
  EXPECT_EQ(schema.find("count").type, SettingType::integer);
}

TEST(NearestName, IsNothingWhereAllAreFar) {
  const std::vector<std::string> known{"reference", "fragments", "massive"};
  EXPECT_EQ(nearest_name("refrence", known), "reference");
  EXPECT_EQ(nearest_name("Massive", known), "massive");
  EXPECT_EQ(nearest_name("photon-map", known), "");
  EXPECT_EQ(nearest_name("x", {}), "");
}

}  // namespace
}  // namespace sightline
