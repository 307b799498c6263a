// Dispatch by ending, and several files as one scene.
#include "scene/load/load.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/core/error.h"

namespace sightline {
namespace {

class Load : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("scene_load_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "folder.ply");
    write("camera.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"camera":0}],
                             "cameras":[{"name":"front","type":"perspective","perspective":{"yfov":1,"znear":1}}]})");
    write("MESH.PLY",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    write("notes.txt", "no scene");
  }
  void write(const char* name, std::string_view text) const { std::ofstream(folder_ / name) << text; }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  ErrorCode code_of(const std::string& spec) const {
    try {
      load_scene(spec, {}, context_);
    } catch (const Error& error) {
      EXPECT_NE(error.place().find(spec), std::string::npos) << error.what();
      return error.code();
    }
    ADD_FAILURE() << spec << " was loaded";
    return ErrorCode::bug;
  }
  std::filesystem::path folder_;
  Context context_;
};

TEST_F(Load, ChoosesTheReaderByTheEndingWhateverItsCase) {
  EXPECT_EQ(load_scene(path("camera.gltf"), {}, context_).cameras.size(), 1u);
  const Scene mesh = load_scene(path("MESH.PLY"), {}, context_);
  EXPECT_EQ(instanced_triangle_count(mesh), 1u);
  EXPECT_EQ(mesh.name, "MESH");
}

TEST_F(Load, MergesSeveralFiles) {
  const std::string specs[] = {path("MESH.PLY"), path("camera.gltf"), path("MESH.PLY")};
  const Scene scene = load_scenes(specs, {}, context_);
  EXPECT_EQ(instanced_triangle_count(scene), 2u);
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].name, "front");
}

TEST_F(Load, SaysWhatIsWrongWithAName) {
  EXPECT_EQ(code_of(path("missing.gltf")), ErrorCode::input);
  EXPECT_EQ(code_of(path("folder.ply")), ErrorCode::input);
  EXPECT_EQ(code_of(path("notes.txt")), ErrorCode::usage);
  EXPECT_THROW(load_scenes({}, {}, context_), Error);
  EXPECT_THROW(load_scene("builtin:no-such-scene", {}, context_), Error);
}

TEST_F(Load, KnowsItsEndings) {
  const std::vector<std::string> endings = scene_file_endings();
  for (const char* ending : {".gltf", ".glb", ".pbrt", ".obj", ".ply"}) {
    EXPECT_EQ(std::count(endings.begin(), endings.end(), ending), 1) << ending;
  }
}

}  // namespace
}  // namespace sightline
