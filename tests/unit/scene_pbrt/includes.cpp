#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline {
namespace {

class PbrtFiles : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = std::filesystem::path(testing::TempDir()) / ("sightline_pbrt_files_" + std::to_string(::getpid()));
    std::filesystem::create_directories(directory_ / "parts");
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }
  void write(const std::string& name, const std::string& text) { std::ofstream(directory_ / name, std::ios::binary) << text; }
  Scene load() { return load_pbrt(directory_ / "scene.pbrt", {}, context_); }
  std::string error() {
    try {
      load();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
      return e.what();
    }
    return "";
  }
  std::filesystem::path directory_;
  Context context_;
};

/// A unit triangle in ascii PLY, with texture coordinates.
constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty float v\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";

TEST_F(PbrtFiles, AnIncludedFileChangesTheState) {
  write("scene.pbrt", "WorldBegin Include \"parts/a.pbrt\"\n" + std::string(kTriangle));
  write("parts/a.pbrt", "Translate 1 0 0 Include \"b.pbrt\" Include \"parts/c.pbrt\"");
  write("parts/b.pbrt", "Translate 0 1 0");  // beside the including file
  write("parts/c.pbrt", "Translate 0 0 1");  // from the main file, as pbrt looks it up
  expect_near(load().meshes.at(0).positions[0], {1, 1, 1});
}

TEST_F(PbrtFiles, AnImportedFileLeavesTheStateAlone) {
  write("scene.pbrt", "WorldBegin Import \"a.pbrt\"\n" + std::string(kTriangle));
  write("a.pbrt", "Translate 1 0 0\n" + std::string(kTriangle));
  const Scene scene = load();
  ASSERT_EQ(scene.meshes.size(), 2u);
  expect_near(scene.meshes[0].positions[0], {1, 0, 0});
  expect_near(scene.meshes[1].positions[0], {0, 0, 0});
}

TEST_F(PbrtFiles, CyclesMissingAndEndlessIncludesAreErrors) {
  write("scene.pbrt", "WorldBegin\n  Include \"a.pbrt\"");
  EXPECT_NE(error().find("scene.pbrt:2:3: the included file 'a.pbrt' is not there"), std::string::npos);
  write("a.pbrt", "Include \"./parts/../a.pbrt\"");
  EXPECT_NE(error().find("a.pbrt:1:1: './parts/../a.pbrt' includes itself"), std::string::npos);
  write("a.pbrt", "Include \"scene.pbrt\"");
  EXPECT_NE(error().find("includes itself"), std::string::npos);
  EXPECT_NE(error_of("WorldBegin Include \"a.pbrt\"").find("out of reach"), std::string::npos);
}

TEST_F(PbrtFiles, FilesThatIncludeOthersAgainAndAgainAreRefused) {
  // Each file includes the next ten times: 10^9 times the last.
  write("scene.pbrt", "WorldBegin Include \"f0.pbrt\"");
  for (int i = 0; i < 9; ++i) {
    std::string text;
    for (int k = 0; k < 10; ++k) text += "Include \"f" + std::to_string(i + 1) + ".pbrt\"\n";
    write("f" + std::to_string(i) + ".pbrt", text);
  }
  write("f9.pbrt", "");
  EXPECT_NE(error().find("far too much is included"), std::string::npos);
}

TEST_F(PbrtFiles, ErrorsInIncludedFilesNameThem) {
  write("scene.pbrt", "WorldBegin Include \"a.pbrt\"");
  write("a.pbrt", "\n Shpae \"sphere\"");
  EXPECT_NE(error().find("a.pbrt:2:2: unknown directive 'Shpae'; did you mean 'Shape'?"), std::string::npos);
}

TEST_F(PbrtFiles, AMeshUsedOnceStandsInWorldSpaceWithItsCoordinatesFlippedOnce) {
  write("m.ply", kPly);
  write("scene.pbrt", "WorldBegin Translate 1 2 3 Scale -1 1 1 Shape \"plymesh\" \"string filename\" \"m.ply\"");
  const Scene scene = load();
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.instances[0].world_from_object, Mat4(1));
  expect_near(scene.meshes[0].positions[0], {1, 2, 3});
  EXPECT_GT(face_normal(scene.meshes[0]).z, 0);  // the transformed normal
  ASSERT_EQ(scene.meshes[0].uvs.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(scene.meshes[0].uvs[i].y, scene.meshes[0].positions[i].y > 2.5f ? 0 : 1);
  }
}

TEST_F(PbrtFiles, AMeshUsedOftenIsReadOnceAndInstanced) {
  write("m.ply", kPly);
  write("scene.pbrt",
        "WorldBegin Shape \"plymesh\" \"string filename\" \"m.ply\" Translate 0 0 4 Shape \"plymesh\" \"string filename\" \"m.ply\"\n"
        "Material \"conductor\" Shape \"plymesh\" \"string filename\" \"m.ply\" ReverseOrientation Shape \"plymesh\" \"string filename\" "
        "\"m.ply\"");
  const Scene scene = load();
  EXPECT_EQ(scene.meshes.size(), 2u);  // one a side
  ASSERT_EQ(scene.instances.size(), 4u);
  expect_near(transform_point(scene.instances[1].world_from_object, {0, 0, 0}), {0, 0, 4});
  EXPECT_FALSE(scene.instances[1].material_override.valid());
  ASSERT_TRUE(scene.instances[2].material_override.valid());
  EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(scene.materials[scene.instances[2].material_override.index].model));
  EXPECT_LT(face_normal(scene.meshes[scene.instances[3].mesh.index]).z, 0);
}

TEST_F(PbrtFiles, ABrokenMeshIsAnErrorThatNamesBothPlacesAndAMissingOneAWarning) {
  write("m.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
  write("scene.pbrt", "WorldBegin\n Shape \"plymesh\" \"string filename\" \"m.ply\"");
  const std::string message = error();
  EXPECT_NE(message.find("m.ply"), std::string::npos) << message;
  EXPECT_NE(message.find("scene.pbrt:2:2"), std::string::npos) << message;
  write("scene.pbrt", "WorldBegin\n Shape \"plymesh\" \"string filename\" \"n.ply\"");
  EXPECT_TRUE(warns_of(load(), "scene.pbrt:2:2: mesh file"));
}

TEST_F(PbrtFiles, SpectraComeFromFiles) {
  write("s.spd", "# grey\n400 0.2\n700 0.2\n");
  write("scene.pbrt", "WorldBegin Material \"diffuse\" \"spectrum reflectance\" \"s.spd\"\n" + std::string(kTriangle));
  expect_near(std::get<DiffuseMaterial>(load().materials.at(0).model).reflectance.value, Color(0.2f));
  write("s.spd", "700 1 400 1");
  EXPECT_NE(error().find("scene.pbrt:1:31: 's.spd' is no list"), std::string::npos) << error();
}

TEST_F(PbrtFiles, TheNumberOfThreadsDoesNotChangeTheScene) {
  write("m.ply", kPly);
  std::string text = "WorldBegin\n";
  for (int i = 0; i < 20; ++i) {
    write("m" + std::to_string(i) + ".ply", kPly);
    text += "Translate 0 0 1 Shape \"plymesh\" \"string filename\" \"m" + std::to_string(i) + ".ply\"\n";
  }
  write("scene.pbrt", text);
  context_.threads = 1;
  const std::uint64_t one = scene_hash(load());
  context_.threads = 4;
  EXPECT_EQ(scene_hash(load()), one);
}

}  // namespace
}  // namespace sightline
