// The table of methods, and the refusal of scenes that a method cannot handle.
#include <gtest/gtest.h>

#include <set>

#include "base/core/error.h"
#include "methods/method.h"

namespace sightline {
namespace {

/// Knows nothing but point lights and diffuse surfaces.
class ModestMethod final : public Method {
 public:
  const MethodInfo& info() const override {
    static const MethodInfo info{
        .name = "modest", .help = {}, .citation = {}, .lights = {LightKind::point}, .materials = {MaterialKind::diffuse}};
    return info;
  }
  SettingsValue default_settings() const override { return {}; }
  void render_pass(const RenderJob&, SampleRange, Frame&, PassStatistics&, const Context&) const override {}
};

std::string refusal(const Scene& scene) {
  try {
    check_supported(ModestMethod(), scene);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    return error.what();
  }
  return {};
}

TEST(CheckSupported, AcceptsWhatTheMethodNames) {
  Scene scene;
  scene.materials.push_back({.name = "grey"});
  scene.lights.push_back({.name = "bulb", .shape = PointLight{}, .node = {}});
  EXPECT_EQ(refusal(scene), "");
}

TEST(CheckSupported, NamesTheFirstLightItCannotHandle) {
  const std::pair<Light, const char*> lights[] = {{{.name = "lamp", .shape = SpotLight{}, .node = {}}, "spot"},
                                                  {{.name = "lamp", .shape = DirectionalLight{}, .node = {}}, "directional"},
                                                  {{.name = "lamp", .shape = RectangleLight{}, .node = {}}, "rectangle"},
                                                  {{.name = "lamp", .shape = DiskLight{}, .node = {}}, "disk"},
                                                  {{.name = "lamp", .shape = SphereLight{}, .node = {}}, "sphere"}};
  for (const auto& [light, kind] : lights) {
    Scene scene;
    scene.lights.push_back({.name = "bulb", .shape = PointLight{}, .node = {}});
    scene.lights.push_back(light);
    const std::string text = refusal(scene);
    EXPECT_NE(text.find("lamp"), std::string::npos) << text;
    EXPECT_NE(text.find(kind), std::string::npos) << text;
    EXPECT_EQ(text.find("bulb"), std::string::npos) << text;
  }
}

TEST(CheckSupported, EnvironmentsAndGlowingMaterialsAreLightsToo) {
  Scene sky;
  sky.environment = Environment{};
  EXPECT_NE(refusal(sky).find("environment"), std::string::npos);
  Scene glow;
  glow.materials.push_back({.name = "ember", .emission = Color(1)});
  EXPECT_NE(refusal(glow).find("ember"), std::string::npos);
}

TEST(CheckSupported, NamesTheFirstMaterialItCannotHandle) {
  Scene scene;
  scene.materials.push_back({.name = "grey"});
  scene.materials.push_back({.name = "pane", .model = DielectricMaterial{}});
  const std::string text = refusal(scene);
  EXPECT_NE(text.find("pane"), std::string::npos) << text;
  EXPECT_NE(text.find("dielectric"), std::string::npos) << text;
}

TEST(MethodTable, NamesAreUniqueAndFound) {
  std::set<std::string> names;
  for (const Method* method : methods()) {
    EXPECT_TRUE(names.insert(method->info().name).second) << method->info().name;
    EXPECT_EQ(&find_method(method->info().name), method);
    EXPECT_FALSE(method->info().help.empty()) << method->info().name;
  }
  EXPECT_TRUE(names.contains("reference"));
}

TEST(MethodTable, AnUnknownNameIsAUsageErrorThatNamesTheNearest) {
  try {
    find_method("referense");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("'reference'"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sightline
