#include "unit/scene_pbrt/pbrt_text.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "image/io/image_io.h"

namespace sightline {
namespace {

template <class Node>
const Node& node_of(const Scene& scene, std::size_t texture) {
  return std::get<Node>(scene.textures.at(texture).node);
}

TEST(PbrtTextures, NodesAreBuiltFromNamesAndConstants) {
  const Scene scene = parse_world(
      "Texture \"a\" \"spectrum\" \"constant\" \"rgb value\" [.1 .2 .3]\n"
      "Texture \"b\" \"spectrum\" \"scale\" \"texture tex\" \"a\" \"float scale\" .5\n"
      "Texture \"c\" \"spectrum\" \"mix\" \"texture tex1\" \"a\" \"texture tex2\" \"b\" \"float amount\" .25\n"
      "Material \"diffuse\" \"texture reflectance\" \"c\"\n" +
      std::string(kTriangle));
  EXPECT_TRUE(scene.warnings.empty());
  const auto& material = std::get<DiffuseMaterial>(scene.materials[0].model);
  EXPECT_EQ(material.reflectance.value, Color(1));
  const auto& mix = node_of<MixTexture>(scene, material.reflectance.texture.index);
  EXPECT_EQ(node_of<ConstantTexture>(scene, mix.first.index).value, Vec4(0.1f, 0.2f, 0.3f, 1));
  EXPECT_EQ(node_of<ConstantTexture>(scene, mix.amount.index).value.x, 0.25f);
  const auto& scale = node_of<ScaleTexture>(scene, mix.second.index);
  EXPECT_EQ(scale.texture, mix.first);
  EXPECT_EQ(node_of<ConstantTexture>(scene, scale.factor.index).value.x, 0.5f);
}

TEST(PbrtTextures, CheckerboardCoordinatesAreThoseOfPbrt) {
  const Scene scene = parse_world(
      "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 4 \"float vscale\" 8 \"float udelta\" .25 \"float vdelta\" .5\n");
  const auto& board = std::get<CheckerboardTexture>(scene.textures.back().node);
  // At pbrt's (u, v) = (0.3, 0.1), that is our v = 0.9: (4 u + 0.25, 8 v + 0.5).
  const Vec2 st = board.uv.matrix * Vec2(0.3f, 0.9f) + board.uv.offset;
  EXPECT_NEAR(st.x, 1.45f, 1e-5f);
  EXPECT_NEAR(st.y, 1.3f, 1e-5f);
  EXPECT_EQ(node_of<ConstantTexture>(scene, board.even.index).value.x, 1);
  EXPECT_EQ(node_of<ConstantTexture>(scene, board.odd.index).value.x, 0);
}

TEST(PbrtTextures, SharedNamesOfFloatsAndSpectraAreApart) {
  const Scene scene = parse_world(
      "Texture \"t\" \"float\" \"constant\" \"float value\" .25\nTexture \"t\" \"spectrum\" \"constant\" \"rgb value\" [1 0 0]\n"
      "Material \"coateddiffuse\" \"texture reflectance\" \"t\" \"texture roughness\" \"t\"\n" +
      std::string(kTriangle));
  const auto& material = std::get<CoatedDiffuseMaterial>(scene.materials[0].model);
  EXPECT_EQ(node_of<ConstantTexture>(scene, material.alpha_u.texture.index).value.x, 0.25f);
  EXPECT_EQ(node_of<ConstantTexture>(scene, material.reflectance.texture.index).value.y, 0);
}

TEST(PbrtTextures, WhatIsMissingBecomesGreyWithAWarning) {
  const Scene scene =
      parse_world("Texture \"wood\" \"spectrum\" \"marble\" \"integer octaves\" 3\nMaterial \"diffuse\" \"texture reflectance\" \"wod\"\n" +
                  std::string(kTriangle));
  EXPECT_TRUE(warns_of(scene, "test.pbrt:2:1: texture type 'marble' is not supported; mid-grey is used"));
  EXPECT_TRUE(warns_of(scene, "test.pbrt:3:20: there is no spectrum texture 'wod' (did you mean 'wood'?)"));
  EXPECT_EQ(scene.warnings.size(), 2u);
  const auto& material = std::get<DiffuseMaterial>(scene.materials[0].model);
  EXPECT_EQ(node_of<ConstantTexture>(scene, material.reflectance.texture.index).value.x, 0.5f);
}

TEST(PbrtTextures, NestingThatWouldExplodeIsRefused) {
  std::string text = "WorldBegin Texture \"t0\" \"float\" \"constant\"\n";
  for (int i = 0; i < 30; ++i) {
    text += "Texture \"t" + std::to_string(i + 1) + "\" \"float\" \"scale\" \"texture tex\" \"t" + std::to_string(i) +
            "\" \"texture scale\" \"t" + std::to_string(i) + "\"\n";
  }
  EXPECT_NE(error_of(text).find("textures are nested too deeply"), std::string::npos);
}

class PbrtImages : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = std::filesystem::path(testing::TempDir()) / ("sightline_pbrt_images_" + std::to_string(::getpid()));
    std::filesystem::create_directories(directory_);
    const std::vector<std::uint8_t> pixels = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
    write_file(directory_ / "four.png", encode_png(2, 2, 3, pixels));
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }
  Scene load(const std::string& world) {
    std::ofstream(directory_ / "scene.pbrt") << "WorldBegin\n" << world;
    return load_pbrt(directory_ / "scene.pbrt", {}, context_);
  }
  std::filesystem::path directory_;
  Context context_;
};

TEST_F(PbrtImages, OptionsOfImageMapsArrive) {
  const Scene scene = load(
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" \"string filter\" \"point\" \"string wrap\" \"clamp\" "
      "\"float scale\" 2 \"bool invert\" true \"string encoding\" \"linear\" \"float uscale\" 3 \"float vscale\" 2 \"float vdelta\" .25\n"
      "Texture \"d\" \"float\" \"imagemap\" \"string filename\" \"four.png\"\n");
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.images.size(), 1u);  // read once
  const auto& node = node_of<ImageTexture>(scene, 0);
  EXPECT_EQ(node.image, ImageId(0));
  EXPECT_EQ(node.filter, TextureFilter::nearest);
  EXPECT_EQ(node.wrap_u, Wrap::clamp);
  EXPECT_EQ(node.wrap_v, Wrap::clamp);
  EXPECT_EQ(node.scale, 2);
  EXPECT_TRUE(node.invert);
  EXPECT_EQ(node.encoding, ColorEncoding::linear);
  EXPECT_EQ(node_of<ImageTexture>(scene, 1).encoding, ColorEncoding::srgb);
  EXPECT_EQ(node_of<ImageTexture>(scene, 1).filter, TextureFilter::linear);
  // pbrt looks up row 1 - (2 v + 0.25) from the top; at v = 0.25 that is 0.25. Our v there is 0.75.
  const Vec2 st = node.uv.matrix * Vec2(0.5f, 0.75f) + node.uv.offset;
  EXPECT_NEAR(st.x, 1.5f, 1e-6f);
  EXPECT_NEAR(st.y, 0.25f, 1e-6f);
}

TEST_F(PbrtImages, AnotherEndingIsFoundAndAMissingImageIsGrey) {
  const Scene scene = load(
      "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"four.tga\"\nTexture \"b\" \"spectrum\" \"imagemap\" \"string "
      "filename\" \"five.tga\"\n");
  EXPECT_EQ(scene.images.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<ImageTexture>(scene.textures[0].node));
  EXPECT_EQ(node_of<ConstantTexture>(scene, 1).value, Vec4(0.5f, 0.5f, 0.5f, 1));
  EXPECT_TRUE(warns_of(scene, "four.png is used instead"));
  EXPECT_TRUE(warns_of(scene, "scene.pbrt:3:1: "));
  EXPECT_TRUE(warns_of(scene, "five.tga: image not found"));
}

TEST_F(PbrtImages, NormalMapsAreLinearAndAMissingOneIsLeftOut) {
  const Scene scene = load("Material \"diffuse\" \"string normalmap\" \"four.png\"\n" + std::string(kTriangle) +
                           "Material \"diffuse\" \"string normalmap\" \"no.png\"\n" + kTriangle);
  ASSERT_TRUE(scene.materials[0].normal_map.valid());
  EXPECT_EQ(node_of<ImageTexture>(scene, scene.materials[0].normal_map.index).encoding, ColorEncoding::linear);
  EXPECT_FALSE(scene.materials[1].normal_map.valid());
}

TEST_F(PbrtImages, ASquareEnvironmentIsOctahedralAndAWideOneALatLongOfV3) {
  const Scene scene = load("Rotate 90 0 0 1 Scale 2 2 2 LightSource \"infinite\" \"string filename\" \"four.png\" \"float scale\" 3\n");
  ASSERT_TRUE(scene.environment && scene.environment->image);
  EXPECT_EQ(scene.environment->mapping, EnvironmentMapping::octahedral);
  expect_near(scene.environment->scale, Color(3));
  expect_near(scene.environment->world_from_environment * Vec3(1, 0, 0), {0, 1, 0});
  EXPECT_TRUE(scene.images.empty());
  write_file(directory_ / "wide.png", encode_png(2, 1, 3, std::vector<std::uint8_t>(6, 9)));
  const Scene wide = load("LightSource \"infinite\" \"string mapname\" \"wide.png\"\n");
  EXPECT_EQ(wide.environment->mapping, EnvironmentMapping::latlong);
  // pbrt-v3: z is the top row, u = 0.5 looks along -x, larger u along -y.
  expect_near(wide.environment->world_from_environment * Vec3(0, 1, 0), {0, 0, 1});
  expect_near(wide.environment->world_from_environment * Vec3(0, 0, -1), {-1, 0, 0});
  expect_near(wide.environment->world_from_environment * Vec3(1, 0, 0), {0, -1, 0});
  EXPECT_TRUE(warns_of(wide, "not square"));
}

}  // namespace
}  // namespace sightline
