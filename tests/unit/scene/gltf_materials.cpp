// Metallic-roughness materials, textures and the extensions that are honoured.
#include <gtest/gtest.h>

#include "gltf_file.h"

namespace sightline::test {
namespace {

/// A file with one material on one triangle; textures 0 to 3 have undecodable pictures, which is enough to look at their nodes.
Scene load_material(nlohmann::json material, nlohmann::json extra = nlohmann::json::object()) {
  GltfFile file;
  for (int i = 0; i < 4; ++i) {
    file.push("images", {{"uri", "data:image/png;base64,AAA" + std::string(1, static_cast<char>('A' + i))}});
    file.push("textures", {{"source", i}, {"sampler", 0}});
  }
  file.push("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
  file.push("materials", std::move(material));
  file.json.update(extra, true);
  file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", file.add_triangle_positions()}}}, {"material", 0}})}});
  return file.load();
}

const MetallicRoughnessMaterial& model_of(const Scene& scene) { return std::get<MetallicRoughnessMaterial>(scene.materials.at(0).model); }

TEST(GltfMaterial, DefaultsAreThoseOfTheFormat) {
  const Scene scene = load_material(nlohmann::json::object());
  EXPECT_EQ(model_of(scene).base_color.value, Color(1));
  EXPECT_EQ(model_of(scene).metallic.value, 1);
  EXPECT_EQ(model_of(scene).roughness.value, 1);
  EXPECT_FALSE(scene.materials[0].two_sided);
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::opaque);
  EXPECT_EQ(scene.materials[0].emission.value, Color(0));
}

TEST(GltfMaterial, PackedTextureFeedsMetalFromBlueAndRoughnessFromGreen) {
  const Scene scene = load_material({{"pbrMetallicRoughness",
                                      {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                                       {"metallicFactor", 0.5},
                                       {"roughnessFactor", 0.25},
                                       {"metallicRoughnessTexture", {{"index", 1}}}}}});
  const MetallicRoughnessMaterial& model = model_of(scene);
  EXPECT_EQ(model.base_color.value, Color(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(model.metallic.channel, 2);
  EXPECT_EQ(model.roughness.channel, 1);
  EXPECT_EQ(model.metallic.value, 0.5f);
  EXPECT_EQ(model.roughness.value, 0.25f);
  EXPECT_TRUE(model.metallic.texture.valid());
  EXPECT_EQ(model.metallic.texture, model.roughness.texture);
}

TEST(GltfMaterial, EmissionIsScaledByItsStrength) {
  const Scene scene = load_material({{"emissiveFactor", {1, 0.5, 0}},
                                     {"doubleSided", true},
                                     {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 12}}}}}});
  EXPECT_EQ(scene.materials[0].emission.value, Color(12, 6, 0));
  EXPECT_TRUE(scene.materials[0].two_sided);
  EXPECT_TRUE(scene.materials[0].emission_two_sided);
}

TEST(GltfMaterial, AlphaComesFromTheBaseColour) {
  const Scene mask = load_material({{"alphaMode", "MASK"},
                                    {"alphaCutoff", 0.3},
                                    {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.9}}, {"baseColorTexture", {{"index", 0}}}}}});
  EXPECT_EQ(mask.materials[0].alpha_mode, AlphaMode::mask);
  EXPECT_EQ(mask.materials[0].alpha_cutoff, 0.3f);
  EXPECT_EQ(mask.materials[0].alpha.value, 0.9f);
  EXPECT_EQ(mask.materials[0].alpha.channel, 3);
  EXPECT_EQ(mask.materials[0].alpha.texture, model_of(mask).base_color.texture);

  const Scene blend = load_material({{"alphaMode", "BLEND"}});
  EXPECT_EQ(blend.materials[0].alpha_mode, AlphaMode::blend);
  EXPECT_FALSE(blend.warnings.empty());
}

TEST(GltfMaterial, OneUnreadablePictureIsAWarningAndNeutral) {
  const Scene scene =
      load_material({{"normalTexture", {{"index", 2}, {"scale", 0.5}}}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  EXPECT_EQ(scene.warnings.size(), 2u);
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(std::get<ConstantTexture>(scene.textures[model_of(scene).base_color.texture.index].node).value, Vec4(1));
  EXPECT_EQ(std::get<ConstantTexture>(scene.textures[scene.materials[0].normal_map.index].node).value, Vec4(0.5f, 0.5f, 1, 1));
  EXPECT_EQ(scene.materials[0].normal_scale, 0.5f);
  for (const ImageAsset& image : scene.images) EXPECT_NE(image.image, nullptr);
}

/// A 1x1 picture that every reader knows: 24-bit BMP.
std::string bitmap_uri() {
  std::vector<unsigned char> bmp(58, 0);
  bmp[0] = 'B', bmp[1] = 'M', bmp[2] = 58, bmp[10] = 54, bmp[14] = 40, bmp[18] = 1, bmp[22] = 1, bmp[26] = 1, bmp[28] = 24;
  bmp[34] = 4, bmp[56] = 255;
  return "data:image/bmp;base64," + base64(std::as_bytes(std::span(bmp)));
}

TEST(GltfMaterial, SamplersEncodingsAndTransformsReachTheTexture) {
  const Scene scene = load_material(
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0},
           {"extensions", {{"KHR_texture_transform", {{"offset", {0.25, 0.5}}, {"scale", {2, 3}}, {"rotation", 1.5707963267948966}}}}}}},
         {"metallicRoughnessTexture", {{"index", 0}}}}}},
      {{"images", {{{"uri", bitmap_uri()}}, {{"uri", "data:,a"}}, {{"uri", "data:,b"}}, {{"uri", "data:,c"}}}}});
  ASSERT_EQ(scene.warnings.size(), 0u) << scene.warnings[0];
  ASSERT_EQ(scene.textures.size(), 2u);
  ASSERT_EQ(scene.images.size(), 1u) << "one image, however many textures";

  const auto& color = std::get<ImageTexture>(scene.textures[model_of(scene).base_color.texture.index].node);
  EXPECT_EQ(color.encoding, ColorEncoding::srgb);
  EXPECT_EQ(color.wrap_u, Wrap::clamp);
  EXPECT_EQ(color.wrap_v, Wrap::mirror);
  EXPECT_EQ(color.filter, TextureFilter::nearest);
  // Scaled to (2, 6), then a quarter turn counter-clockwise with v down: (u, v) -> (v, -u).
  const Vec2 uv = color.uv.matrix * Vec2(1, 2) + color.uv.offset;
  EXPECT_NEAR(uv.x, 6 + 0.25f, 1e-5f);
  EXPECT_NEAR(uv.y, -2 + 0.5f, 1e-5f);

  const auto& packed = std::get<ImageTexture>(scene.textures[model_of(scene).metallic.texture.index].node);
  EXPECT_EQ(packed.encoding, ColorEncoding::linear);
  EXPECT_EQ(packed.uv.matrix, glm::mat2(1));
}

TEST(GltfMaterial, UnknownExtensionsMakeOneWarningThatListsThem) {
  const Scene scene =
      load_material(nlohmann::json::object(),
                    {{"extensionsUsed", {"KHR_materials_unlit", "KHR_lights_punctual", "ACME_foo"}}, {"extensionsRequired", {"ACME_foo"}}});
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("ACME_foo, KHR_materials_unlit"), std::string::npos) << scene.warnings[0];
  EXPECT_EQ(scene.warnings[0].find("KHR_lights_punctual"), std::string::npos);
}

TEST(GltfMaterial, RequiredCompressionIsAnErrorThatSaysSo) {
  GltfFile file;
  file.json["extensionsRequired"] = {"KHR_texture_transform", "KHR_draco_mesh_compression"};
  const std::string error = error_of(file);
  EXPECT_NE(error.find("/extensionsRequired/1"), std::string::npos) << error;
  EXPECT_NE(error.find("KHR_draco_mesh_compression"), std::string::npos) << error;
}

}  // namespace
}  // namespace sightline::test
