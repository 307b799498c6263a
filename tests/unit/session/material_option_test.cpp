#include "session/material_option.h"

#include <gtest/gtest.h>

#include "base/core/error.h"
#include "methods/method.h"
#include "scene/load/load.h"

namespace sightline {
namespace {

MaterialRequest parsed(std::string_view text) { return parse_material(text, {}); }

std::string error_of(std::string_view text) {
  try {
    parsed(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage) << text;
    return error.what();
  }
  return "";
}

TEST(MaterialOption, ValuesGoWhereTheyAreNamed) {
  const MaterialRequest request = parsed("ward,diffuse=0.1:0.2:0.3,specular=0.4,alpha_x=0.1,alpha_y=0.5");
  EXPECT_EQ(request.material, "");
  const auto& ward = std::get<WardMaterial>(request.model);
  EXPECT_EQ(ward.diffuse.value, Color(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(ward.specular.value, Color(0.4f));
  EXPECT_EQ(ward.alpha_x.value, 0.1f);
  EXPECT_EQ(ward.alpha_y.value, 0.5f);
  EXPECT_EQ(std::get<CookTorranceMaterial>(parsed("cook-torrance,f0=0.9:0.6:0.5,roughness=0.2").model).f0.value, Color(0.9f, 0.6f, 0.5f));
  EXPECT_TRUE(std::get<DielectricMaterial>(parsed("dielectric,thin=true,eta=1.3").model).thin);
}

TEST(MaterialOption, NamesMayHoldCommasAndEqualsSigns) {
  EXPECT_EQ(parsed("car=phong,exponent=5").material, "car");
  EXPECT_EQ(parsed("a,b=c=phong").material, "a,b=c");
  EXPECT_EQ(parsed("a=1,b=2=ward,alpha_x=0.3").material, "a=1,b=2");
  EXPECT_EQ(parsed("=phong").material, "");
}

TEST(MaterialOption, EveryModelHasTheKindOfItsName) {
  for (const MaterialChoice& choice : material_choices()) {
    if (choice.name == "measured") continue;
    const SurfaceModel model = parsed(choice.name).model;
    EXPECT_EQ(name_of(static_cast<MaterialKind>(model.index())), choice.name);
    EXPECT_FALSE(choice.help.empty());
    for (const Setting& setting : choice.parameters.schema().settings()) EXPECT_FALSE(setting.info.help.empty()) << choice.name;
  }
}

TEST(MaterialOption, MistakesAreAnsweredWithWhatWasMeant) {
  EXPECT_NE(error_of("wart").find("did you mean 'ward'"), std::string::npos);
  EXPECT_NE(error_of("ball=cook-torance,roughness=1").find("did you mean 'cook-torrance'"), std::string::npos);
  EXPECT_NE(error_of("ward,alpha_xx=1").find("did you mean 'alpha_x'"), std::string::npos);
  for (const char* text : {"", "=", "x=y", "ward,alpha_x", "ward,alpha_x=", "ward,alpha_x=nan", "ward,alpha_x=-1", "ward,diffuse=1:2",
                           "ward,diffuse=0.1:0.2:0.3:0.4", "ward,diffuse=2", "ward,diffuse=::", "measured", "dielectric,eta=0"})
    EXPECT_NE(error_of(text), "") << text;
}

TEST(MaterialOption, AFileThatIsNotThereIsNamed) {
  try {
    parsed("measured,file=no/such.brdf");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_NE(std::string(error.what()).find("no/such.brdf"), std::string::npos);
  }
}

Scene scene_of(const char* spec) {
  const Context context;
  return load_scene(spec, {}, context);
}

bool is_ward(const Scene& scene, MaterialId id) {
  return id.valid() && std::holds_alternative<WardMaterial>(scene.materials[id.index].model);
}

TEST(MaterialOption, OneMaterialIsReplacedByNameOrNumber) {
  Scene scene = scene_of("builtin:spheres");
  apply_material(scene, parsed("ball 2=ward"));
  apply_material(scene, parsed("0=phong"));
  for (const Material& material : scene.materials) {
    EXPECT_EQ(std::holds_alternative<WardMaterial>(material.model), material.name == "ball 2");
  }
  EXPECT_TRUE(std::holds_alternative<PhongMaterial>(scene.materials[0].model));
  try {
    apply_material(scene, parsed("bal 2=ward"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'ball 2'"), std::string::npos);
  }
}

TEST(MaterialOption, WithoutANameLightsStayAsTheyAre) {
  Scene scene = scene_of("builtin:cornell");
  apply_material(scene, parsed("ward"));
  for (const Material& material : scene.materials)
    EXPECT_EQ(std::holds_alternative<WardMaterial>(material.model), is_black(material.emission.value)) << material.name;
}

TEST(MaterialOption, WithoutANameTheStageStaysAsItIs) {
  for (const char* spec :
       {"builtin:ground,content=builtin:hairball?triangles=500", "builtin:room,content=builtin:hairball?triangles=500"}) {
    Scene scene = scene_of(spec);
    apply_material(scene, parsed("ward"));
    int content = 0, stage = 0;
    for (const Instance& instance : scene.instances) {
      const Mesh& mesh = scene.meshes[instance.mesh.index];
      const MaterialId id = instance.material_override.valid() ? instance.material_override : mesh.material_of(0);
      const bool is_of_stage = mesh.name == "ground" || mesh.name == "room" || mesh.name == "light";
      EXPECT_EQ(is_ward(scene, id), !is_of_stage) << spec << " " << mesh.name;
      ++(is_of_stage ? stage : content);
    }
    EXPECT_GT(content, 0);
    EXPECT_GT(stage, 0);
  }
}

TEST(MaterialOption, GeometryWithoutAMaterialGetsOne) {
  Scene scene;
  Mesh mesh;
  mesh.positions = std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = std::vector<UVec3>{{0, 1, 2}};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({.mesh = MeshId(0)});
  scene.spheres.push_back({});
  apply_material(scene, parsed("ward"));
  EXPECT_TRUE(is_ward(scene, scene.meshes[0].material_of(0)));
  EXPECT_TRUE(is_ward(scene, scene.spheres[0].material));
  EXPECT_EQ(scene.materials.size(), 1u);
}

TEST(MaterialOption, BrushedMeshesWithoutTangentsAreTurnedOnALathe) {
  const auto ball = [] {
    Scene scene;
    Mesh mesh;
    mesh.positions = std::vector<Vec3>{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {-1, 0, -1}};
    mesh.triangles = std::vector<UVec3>{{0, 2, 1}};
    for (const Vec3& p : mesh.positions) mesh.bounds.add(p);
    scene.meshes.push_back(mesh);
    scene.instances.push_back({.mesh = MeshId(0)});
    return scene;
  };
  Scene even = ball(), brushed = ball(), mapped = ball();
  apply_materials(even, {parsed("ward")});
  EXPECT_TRUE(even.meshes[0].tangents.empty());
  apply_materials(brushed, {parsed("ward,alpha_y=0.5")});
  const Mesh& mesh = brushed.meshes[0];
  ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
  const Vec3 center = mesh.bounds.center();
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 tangent(mesh.tangents[i]), from_axis = mesh.positions[i] - center;
    EXPECT_NEAR(glm::length(tangent), 1, 1e-6f);
    EXPECT_EQ(tangent.y, 0);
    EXPECT_NEAR(glm::dot(tangent, from_axis), 0, 1e-6f);
  }
  mapped.meshes[0].uvs = std::vector<Vec2>{{0, 0}, {1, 0}, {0, 1}, {0, 0}};
  apply_materials(mapped, {parsed("conductor,alpha_v=0.5")});
  // The only triangle's third corner is where u is 1.
  const Vec3 along_u = glm::normalize(Vec3(0, 0, 1) - Vec3(1, 0, 0));
  for (const std::size_t corner : {0u, 1u, 2u}) EXPECT_LT(glm::length(Vec3(mapped.meshes[0].tangents[corner]) - along_u), 1e-6f);
}

TEST(MaterialOption, EmissionAndMapsOfTheMaterialStay) {
  Scene scene = scene_of("builtin:cornell");
  Material& material = scene.materials[0];
  material.emission = Color(3);
  material.bump_scale = 7;
  apply_material(scene, {material.name, WardMaterial{}});
  EXPECT_EQ(material.emission.value, Color(3));
  EXPECT_EQ(material.bump_scale, 7);
  EXPECT_TRUE(is_ward(scene, MaterialId(0)));
}

}  // namespace
}  // namespace sightline
