#include "bench/fragments/truth.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>

#include "base/core/error.h"
#include "bench/fragments/aims.h"
#include "image/io/image_io.h"

namespace sightline {
namespace {

BuiltView cornell(const Context& context) { return *load_built_view("builtin:cornell", "", IVec2(24, 20), true, context); }

std::filesystem::path empty_folder(const char* name) {
  std::filesystem::path folder = testing::TempDir() + name;
  std::filesystem::remove_all(folder);
  return folder;
}

TEST(FragmentTruth, ThePictureIsKeptAndTakenFromItsFile) {
  const Context context;
  const BuiltView view = cornell(context);
  FragmentBenchOptions options{.cache = empty_folder("fragment-truth"), .truth_samples = 16};
  const FragmentTruth made = fragment_truth(view, options, context);
  const std::filesystem::path file = options.cache / truth_file_name(view, 16);
  ASSERT_TRUE(std::filesystem::exists(file));
  const FragmentTruth kept = fragment_truth(view, options, context);
  EXPECT_EQ(kept.image.pixels, made.image.pixels);
  EXPECT_EQ(kept.mask, made.mask);
  // Truly from the file: damage is noticed.
  const std::byte nothing{0};
  write_file(file, {&nothing, 1});
  EXPECT_THROW(fragment_truth(view, options, context), Error);
}

TEST(FragmentTruth, WithoutAFolderNothingIsWritten) {
  const Context context;
  const BuiltView view = cornell(context);
  const FragmentBenchOptions options{.truth_samples = 4};
  EXPECT_EQ(fragment_truth(view, options, context).samples, 4);
  EXPECT_FALSE(std::filesystem::exists(truth_file_name(view, 4)));
}

TEST(FragmentTruth, SizeSamplesSceneAndCameraHaveTheirOwnFiles) {
  const Context context;
  BuiltView view = cornell(context);
  const std::string name = truth_file_name(view, 16);
  EXPECT_NE(truth_file_name(view, 17), name);
  BuiltView other = view;
  other.size_px.x += 1;
  EXPECT_NE(truth_file_name(other, 16), name);
  other = view;
  other.camera.world_from_camera[3].x += 0.5f;
  EXPECT_NE(truth_file_name(other, 16), name);
  other = view;
  Scene scene = view.world->scene();
  scene.lights.push_back({"", PointLight{}, {}});
  other.world = World::edit(*view.world, std::move(scene), context);
  EXPECT_NE(truth_file_name(other, 16), name);
  other = view;
  other.name = "builtin:../../x";
  EXPECT_EQ(truth_file_name(other, 16).find('/'), std::string::npos);
}

TEST(FragmentTruth, ErrorsCountTheMasksPixelsAlone) {
  FragmentTruth truth{ColorImage(16, 16, Color(0.5f)), std::vector<std::uint8_t>(256, 1), 4};
  ColorImage image = truth.image;
  image.at(3, 0) = Color(1);
  EXPECT_GT(fragment_errors(truth, image)["l2"].get<double>(), 0);
  truth.mask[3] = 0;
  EXPECT_EQ(fragment_errors(truth, image)["l2"].get<double>(), 0);
}

nlohmann::ordered_json no_results() {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const char* part : {"table", "curve", "sizes", "interactive"}) json[part] = nlohmann::ordered_json::array();
  return json;
}

TEST(FragmentAims, OnlyWhatWasMeasuredIsJudged) {
  nlohmann::ordered_json json = no_results();
  EXPECT_TRUE(fragment_bench_aims(json).empty());
  json["curve"].push_back({{"view", "hairball-room"},
                           {"equal_error", {{"ratio", 1.2}}},
                           {"against_64", 1.9},
                           {"equal_time_db", nullptr},
                           {"ours", {{"l2", 2e-3}, {"flip", 0.01}}}});
  const nlohmann::ordered_json aims = fragment_bench_aims(json);
  ASSERT_EQ(aims.size(), 4u) << aims;
  const bool met[] = {false, true, false, true};
  for (std::size_t i = 0; i < std::size(met); ++i) EXPECT_EQ(aims[i]["met"].get<bool>(), met[i]) << aims[i];
}

TEST(FragmentAims, ThePredecessorIsTheMeasureOfRaysTimeAndError) {
  nlohmann::ordered_json json = no_results();
  const auto row = [](const char* key, double test_rays, double rays, double seconds, double l2) {
    return nlohmann::ordered_json{{"key", key}, {"test_rays", test_rays}, {"rays", rays}, {"seconds", seconds},
                                  {"l2", l2},   {"level0_share", 0.5}};
  };
  json["table"].push_back({{"view", "sponza-court"}, {"rows", {row("default", 10, 50, 1, 1e-4), row("nichols", 20, 100, 1.6, 2e-3)}}});
  const nlohmann::ordered_json aims = fragment_bench_aims(json);
  ASSERT_EQ(aims.size(), 5u) << aims;
  // Half of the pixels are at the finest level, and half of the test rays are too many.
  const bool met[] = {false, false, true, true, true};
  for (std::size_t i = 0; i < std::size(met); ++i) EXPECT_EQ(aims[i]["met"].get<bool>(), met[i]) << aims[i];
}

}  // namespace
}  // namespace sightline
