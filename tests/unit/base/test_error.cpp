#include <gtest/gtest.h>

#include <string>

#include "base/core/error.h"

namespace sightline {
namespace {

TEST(Error, IsOneLineOfPlaceMessageActionAndRemedy) {
  Error error = input_error("expected a number, found 'x'");
  error.at("12:7").at("scene.pbrt").during("reading material 'wood'").during("loading the scene").remedy("write a number");
  EXPECT_STREQ(error.what(),
               "scene.pbrt: 12:7: expected a number, found 'x' (while loading the scene, reading material 'wood'); write a number");
}

TEST(Error, WithoutContextIsJustTheMessage) { EXPECT_STREQ(usage_error("no").what(), "no"); }

TEST(Error, LineBreaksOfForeignTextBecomeSpaces) {
  const Error error = input_error("first\nsecond\r\nthird").at("a\nb");
  EXPECT_EQ(std::string(error.what()).find_first_of("\r\n"), std::string::npos);
}

TEST(Error, HelpersSetTheirCodes) {
  EXPECT_EQ(input_error("").code(), ErrorCode::input);
  EXPECT_EQ(usage_error("").code(), ErrorCode::usage);
  EXPECT_EQ(resource_error("").code(), ErrorCode::resource);
}

TEST(Error, SurvivesBeingThrownAndCaughtAsStandardException) {
  try {
    throw input_error("bad").at("f");
  } catch (const std::exception& exception) {
    EXPECT_STREQ(exception.what(), "f: bad");
  }
}

}  // namespace
}  // namespace sightline
