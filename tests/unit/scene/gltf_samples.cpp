// Real files, where SIGHTLINE_DATA names a folder that has them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "base/core/error.h"
#include "scene/load/load.h"

namespace sightline {
namespace {

std::vector<std::filesystem::path> files_below(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  const char* data = std::getenv("SIGHTLINE_DATA");
  if (data == nullptr) return files;
  std::error_code error;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(data) / folder, error)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".gltf" || ending == ".glb") files.push_back(entry.path());
  }
  return files;
}

TEST(GltfSamples, LoadOrSayWhichCompressionIsMissing) {
  Context context;
  for (const std::filesystem::path& file : files_below("gltf")) {
    try {
      const Scene scene = load_gltf(file, {}, context);
      EXPECT_GT(instanced_triangle_count(scene), 0u) << file;
      EXPECT_FALSE(scene_bounds(scene).is_empty()) << file;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("compress"), std::string::npos) << error.what();
    }
  }
}

TEST(GltfSamples, MalformedFilesEndInASceneOrInAnErrorWithAPlace) {
  Context context;
  for (const std::filesystem::path& file : files_below("malformed")) {
    try {
      load_gltf(file, {}, context);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
      EXPECT_TRUE(error.place().starts_with(file.string() + ": ")) << error.what();
    }
  }
}

}  // namespace
}  // namespace sightline
