#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline {
namespace {

Scene with_material(const std::string& directives) { return parse_world(directives + "\n" + kTriangle); }

template <class Model>
Model model_of(const Scene& scene) {
  EXPECT_EQ(scene.materials.size(), 1u);
  return std::get<Model>(scene.materials.at(0).model);
}

TEST(PbrtMaterials, DefaultsAreThoseOfPbrt) {
  EXPECT_FLOAT_EQ(model_of<DiffuseMaterial>(with_material("")).reflectance.value.x, 0.5f);
  EXPECT_FLOAT_EQ(model_of<DiffuseMaterial>(with_material("Material \"diffuse\"")).reflectance.value.x, 0.5f);
  const auto coated = model_of<CoatedDiffuseMaterial>(with_material("Material \"coateddiffuse\""));
  EXPECT_FLOAT_EQ(coated.reflectance.value.y, 0.5f);
  EXPECT_FLOAT_EQ(coated.eta, 1.5f);
  EXPECT_FLOAT_EQ(coated.alpha_u.value, 0);
  EXPECT_TRUE(coated.remap_roughness);
  const auto glass = model_of<DielectricMaterial>(with_material("Material \"dielectric\""));
  EXPECT_FLOAT_EQ(glass.eta, 1.5f);
  EXPECT_FALSE(glass.thin);
  EXPECT_TRUE(model_of<DielectricMaterial>(with_material("Material \"thindielectric\" \"float eta\" 1.3")).thin);
  const auto leaf = model_of<DiffuseTransmissionMaterial>(with_material("Material \"diffusetransmission\" \"float scale\" 2"));
  EXPECT_FLOAT_EQ(leaf.reflectance.value.x, 0.5f);
  EXPECT_FLOAT_EQ(leaf.transmittance.value.x, 0.5f);
  EXPECT_TRUE(std::holds_alternative<InterfaceMaterial>(with_material("Material \"interface\"").materials[0].model));
}

TEST(PbrtMaterials, ParametersArrive) {
  const auto metal =
      model_of<ConductorMaterial>(with_material("MakeNamedMaterial \"m\" \"string type\" \"conductor\" \"float uroughness\" .1 \"float "
                                                "vroughness\" [ .2 ] \"bool remaproughness\" false "
                                                "\"rgb k\" [3 2 1] \"rgb eta\" [.2 .9 1.1] NamedMaterial \"m\""));
  EXPECT_FLOAT_EQ(metal.alpha_u.value, 0.1f);
  EXPECT_FLOAT_EQ(metal.alpha_v.value, 0.2f);
  EXPECT_FALSE(metal.remap_roughness);
  EXPECT_EQ(metal.eta.value, Color(0.2f, 0.9f, 1.1f));
  EXPECT_EQ(metal.k.value, Color(3, 2, 1));
  const auto rough = model_of<CoatedDiffuseMaterial>(
      with_material("Material \"coateddiffuse\" \"float roughness\" .3 \"float eta\" 1.4 \"rgb reflectance\" [1 .4 .01]"));
  EXPECT_FLOAT_EQ(rough.alpha_u.value, 0.3f);
  EXPECT_FLOAT_EQ(rough.alpha_v.value, 0.3f);
  EXPECT_FLOAT_EQ(rough.eta, 1.4f);
  EXPECT_EQ(rough.reflectance.value, Color(1, 0.4f, 0.01f));
}

TEST(PbrtMaterials, AConductorsReflectanceIsThatAtNormalIncidence) {
  const auto metal = model_of<ConductorMaterial>(with_material("Material \"conductor\" \"rgb reflectance\" [.9 .5 .1]"));
  for (int c = 0; c < 3; ++c) {
    const float n = metal.eta.value[c], k = metal.k.value[c];
    EXPECT_NEAR(((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k), Color(0.9f, 0.5f, 0.1f)[c], 1e-5f);
  }
}

TEST(PbrtMaterials, MixPicksTheSecondByTheAmount) {
  const Scene scene = with_material(
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"b\" \"string type\" \"conductor\"\n"
      "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .25");
  const Material& material = scene.materials[scene.meshes[0].material_of(0).index];
  const auto& mix = std::get<MixMaterial>(material.model);
  EXPECT_TRUE(std::holds_alternative<DiffuseMaterial>(scene.materials[mix.first.index].model));
  EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(scene.materials[mix.second.index].model));
  EXPECT_FLOAT_EQ(mix.amount.value, 0.25f);
  EXPECT_NE(error_of("WorldBegin MakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [\"m\" \"m\"]")
                .find("'m' of the mix is not defined yet"),
            std::string::npos);
}

TEST(PbrtMaterials, DisplacementIsABumpMap) {
  const Scene scene =
      with_material("Texture \"t\" \"float\" \"constant\" \"float value\" 2\nMaterial \"diffuse\" \"texture displacement\" \"t\"");
  EXPECT_TRUE(scene.materials[0].bump.valid());
  EXPECT_FALSE(with_material("Material \"diffuse\" \"float displacement\" 2").materials[0].bump.valid());
}

TEST(PbrtMaterials, ANameMayBeUsedBeforeItsDefinition) {
  const Scene scene =
      with_material("NamedMaterial \"late\"\n" + std::string(kTriangle) + "MakeNamedMaterial \"late\" \"string type\" \"dielectric\"");
  EXPECT_TRUE(std::holds_alternative<DielectricMaterial>(scene.materials[0].model));
  EXPECT_TRUE(scene.warnings.empty());
  const Scene missing = with_material("MakeNamedMaterial \"wood\" \"string type\" \"diffuse\"\nNamedMaterial \"wodo\"");
  EXPECT_TRUE(warns_of(missing, "test.pbrt:3:1: there is no named material 'wodo' (did you mean 'wood'?)")) << missing.warnings.at(0);
}

TEST(PbrtMaterials, WhatIsNotSupportedIsReported) {
  EXPECT_TRUE(warns_of(with_material("Material \"hair\" \"float eta\" 1.5"), "test.pbrt:2:1: material type 'hair' is not supported"));
  EXPECT_TRUE(warns_of(with_material("Material \"coatedconductor\""), "coatedconductor is approximated"));
  const Scene typo = with_material("Material \"diffuse\"\n \"rgb reflectence\" [1 0 0]");
  EXPECT_TRUE(warns_of(typo, "test.pbrt:3:2: \"rgb reflectence\" has no effect on material type 'diffuse' (did you mean 'reflectance'?)"));
  EXPECT_TRUE(warns_of(with_material("Material \"matte\" \"color Kd\" [.1 .2 .3]"), "pbrt-v3 material 'matte' is read as diffuse"));
}

TEST(PbrtMaterials, MediaAbsorbInsideOfShapes) {
  const Scene scene = with_material(
      "MakeNamedMedium \"green\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.5 .2 .4] \"rgb sigma_s\" [0 0 0] \"float scale\" 2\n"
      "MediumInterface \"green\" \"\" Material \"dielectric\"");
  ASSERT_EQ(scene.media.size(), 1u);
  expect_near(scene.media[0].sigma_a, {1, 0.4f, 0.8f});
  EXPECT_EQ(scene.materials[0].interior, MediumId(0));
  EXPECT_TRUE(scene.warnings.empty());
  const Scene fog =
      with_material("MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [1 1 1]\nMediumInterface \"\" \"fog\"");
  EXPECT_TRUE(warns_of(fog, "medium 'fog' scatters"));
  EXPECT_TRUE(warns_of(fog, "medium 'fog' outside of surfaces"));
}

TEST(PbrtMaterials, OneMaterialForAllShapesThatLookAlike) {
  const std::string triangle = kTriangle;
  const Scene scene =
      parse_world("MakeNamedMaterial \"m\" \"string type\" \"diffuse\" NamedMaterial \"m\"\n" + triangle + triangle +
                  "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [2 2 2]\n" + triangle + triangle + "AttributeEnd\n" + triangle);
  EXPECT_EQ(scene.meshes.size(), 5u);
  EXPECT_EQ(scene.materials.size(), 2u);
}

}  // namespace
}  // namespace sightline
