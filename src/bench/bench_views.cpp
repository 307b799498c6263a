#include "bench/bench_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/core/error.h"
#include "base/settings/settings.h"
#include "scene/load/load.h"
#include "session/options_text.h"
#include "session/setup.h"

namespace sightline {
namespace {

struct ViewInfo {
  std::string name, spec;           ///< scene; a path is relative to the data folder
  std::vector<std::string> needs;   ///< files that must be there
  std::optional<Vec3> eye, target;  ///< instead of the scene's own camera
  float fov_deg = 0;
  std::vector<std::string> area_lights, point_lights, directional_lights;
  std::string environment;  ///< file below the data folder
  std::string environment_mapping = "latlong";
  bool own_materials = false;
  IVec2 size_px{1280, 960};
};

constexpr const char* kSponza = "scenes/sponza-dabrovic/sponza.obj";
constexpr const char* kConference = "scenes/conference/conference.ply";
constexpr const char* kKitchen = "pbrt/kitchen/scene-v4.pbrt";
constexpr const char* kStaircase = "pbrt/staircase2/scene-v4.pbrt";
constexpr const char* kForest = "environments/phalzer_forest_01_1k.hdr";

/// Content on a ground under an environment, 800x600.
struct SkyContent {
  const char *name, *file, *parameters;
};
constexpr std::array<SkyContent, 5> kSkyContents = {{{"bunny", "meshes/stanford-bunny.obj", ",normals=smooth"},
                                                     {"armadillo", "meshes/armadillo.obj", ",normals=smooth"},
                                                     {"teapot", "meshes/teapot.obj", ",normals=smooth,min_vertices=40000"},
                                                     {"avocado", "gltf/Avocado/Avocado.gltf", ""},
                                                     {"duck", "gltf/Duck/Duck.glb", ""}}};
/// The plain name is that of the forest.
struct SkyLight {
  const char *suffix, *file, *mapping;
};
constexpr std::array<SkyLight, 4> kSkyLights = {{{"", kForest, "latlong"},
                                                 {"-sun", "environments/noon_grass_1k.hdr", "latlong"},
                                                 {"-window", "environments/st_fagans_interior_1k.hdr", "latlong"},
                                                 {"-grace", "environments/grace_probe.hdr", "angular"}}};

/// 24 point lights in three rows of eight, by turns at two heights.
std::vector<std::string> rows_of_points() {
  std::vector<std::string> lights;
  for (int i = 0; i < 24; ++i) {
    const int column = i / 3;
    const double x = -14 + 4 * column, y = i % 2 == 0 ? 2.5 : 6.5, z = -5.5 + 5.5 * (i % 3);
    lights.push_back(fmt::format("{},{},{} 20,20,20", x, y, z));
  }
  return lights;
}

/// Nine lights under the ceiling, 400 apart.
std::vector<std::string> grid_of_areas() {
  std::vector<std::string> lights;
  lights.reserve(9);
  for (int i = 0; i < 9; ++i)
    lights.push_back(fmt::format("{},640,{} 0,-1,0 100x100 20,20,20", 300 + 400 * (i % 3 - 1), -200 + 400 * (i / 3 - 1)));
  return lights;
}

/// Every content under every environment; two objects that shadow each other, and what moves in parts, under forest and sun.
std::vector<ViewInfo> sky_views() {
  std::vector<ViewInfo> views;
  const auto add = [&](const std::string& name, const std::string& spec, const SkyLight& light, const char* file) {
    ViewInfo view{.name = name + "-sky" + light.suffix, .spec = spec, .needs = {light.file}};
    if (file) view.needs.emplace_back(file);
    view.environment = light.file, view.environment_mapping = light.mapping;
    view.size_px = {800, 600};
    views.push_back(std::move(view));
  };
  for (const SkyContent& content : kSkyContents) {
    for (const SkyLight& light : kSkyLights)
      add(content.name, fmt::format("builtin:ground,content={}{}", content.file, content.parameters), light, content.file);
  }
  for (const SkyLight& light : {kSkyLights[0], kSkyLights[1]}) add("pair", "builtin:pair", light, nullptr);
  // A skin that bends: as the file has it, without ground.
  constexpr const char* kMan = "gltf/CesiumMan/CesiumMan.glb";
  add("man", kMan, kSkyLights[0], kMan);
  views.back().own_materials = true;
  add("movers-5", "builtin:movers,parts=5,vertices=80000", kSkyLights[0], nullptr);
  add("movers-12", "builtin:movers,parts=12,vertices=60000", kSkyLights[0], nullptr);
  return views;
}

std::vector<ViewInfo> make_views() {
  const ViewInfo sponza{.name = "sponza-court",
                        .spec = kSponza,
                        .needs = {kSponza},
                        .eye = Vec3(-12, 3, 0.5f),
                        .target = Vec3(5, 4.5f, 0),
                        .fov_deg = 65,
                        .area_lights = {"0,11,0 0,-1,0 2x2 60,60,60"}};
  ViewInfo points = sponza;
  points.name = "sponza-points", points.area_lights.clear();
  points.point_lights = rows_of_points(), points.directional_lights = {"0.3,-1,0.2 3,3,3"};
  ViewInfo arcade = sponza;
  arcade.name = "sponza-arcade", arcade.area_lights = {"2,9,0 0,-1,0 1x1 200,200,200"};
  arcade.eye = Vec3(-13, 6.5f, -5.2f), arcade.target = Vec3(8, 4, 1);
  const ViewInfo conference{.name = "conference",
                            .spec = kConference,
                            .needs = {kConference},
                            .eye = Vec3(0, 300, 0),
                            .target = Vec3(1000, 100, 0),
                            .fov_deg = 60,
                            .area_lights = {"300,640,-200 0,-1,0 400x400 12,12,12"}};
  ViewInfo nine = conference;
  nine.name = "conference-9", nine.area_lights = grid_of_areas();
  const char* dragon = "meshes/dragon_vrip.ply";
  std::vector<ViewInfo> views = {
      {.name = "dragon-room", .spec = fmt::format("builtin:room,content={}", dragon), .needs = {dragon}},
      sponza,
      {.name = "hairball-room", .spec = "builtin:room,content=hairball"},
      arcade,
      points,
      conference,
      nine,
      {.name = "hairball-open", .spec = "builtin:open-room,content=hairball", .needs = {kForest}, .environment = kForest},
      {.name = "kitchen", .spec = kKitchen, .needs = {kKitchen}, .own_materials = true},
      {.name = "kitchen-vpl", .spec = kKitchen, .needs = {kKitchen}, .own_materials = true},
      {.name = "staircase", .spec = kStaircase, .needs = {kStaircase}, .own_materials = true},
  };
  for (ViewInfo& view : sky_views()) views.push_back(std::move(view));
  return views;
}

const std::vector<ViewInfo>& views() {
  static const std::vector<ViewInfo> table = make_views();
  return table;
}

// The first of the folders that has all files.
std::optional<std::filesystem::path> folder_with(const std::vector<std::string>& files, const std::string& folders) {
  std::size_t begin = 0;
  while (begin <= folders.size()) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    std::filesystem::path folder = folders.substr(begin, end - begin);
    if (std::all_of(files.begin(), files.end(), [&](const std::string& file) { return std::filesystem::exists(folder / file); }))
      return folder;
    begin = end + 1;
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> bench_view_names() {
  std::vector<std::string> names;
  for (const ViewInfo& view : views()) names.push_back(view.name);
  return names;
}

void check_bench_view(const std::string& name) {
  const std::vector<std::string> known = bench_view_names();
  if (name.starts_with("builtin:") || std::find(known.begin(), known.end(), name) != known.end()) return;
  const std::string nearest = nearest_name(name, known);
  throw usage_error("unknown view '" + name + "'")
      .remedy(nearest.empty() ? fmt::format("known: {}", fmt::join(known, ", ")) : "did you mean '" + nearest + "'?");
}

std::optional<BenchView> load_bench_view(const std::string& name, const std::filesystem::path& data, const Context& context) {
  check_bench_view(name);
  ViewInfo info{.name = name, .spec = name};
  for (const ViewInfo& view : views()) {
    if (view.name == name) info = view;
  }
  const std::optional<std::filesystem::path> folder = folder_with(info.needs, data.string());
  if (!folder) return std::nullopt;

  LoadOptions options;
  options.data_directory = *folder;
  const bool builtin = info.spec.starts_with("builtin:");
  BenchView view{name, load_scene(builtin ? info.spec : (*folder / info.spec).string(), options, context), {}};
  // Most views of files show geometry alone: one diffuse material, as the papers' comparisons do.
  if (!builtin && !info.own_materials) {
    view.scene.materials = {Material{}};
    for (Mesh& mesh : view.scene.meshes) mesh.materials = {MaterialId{std::size_t{0}}}, mesh.triangle_materials = {};
    for (Instance& instance : view.scene.instances) instance.material_override = {};
  }
  LightRequest lights;
  lights.area = info.area_lights, lights.point = info.point_lights, lights.directional = info.directional_lights;
  if (!info.environment.empty()) {
    lights.environment = (*folder / info.environment).string();
    lights.environment_mapping = info.environment_mapping;
  }
  apply_lights(view.scene, lights, context);
  ViewRequest request;
  request.eye = info.eye, request.target = info.target;
  if (info.fov_deg > 0) request.fov_deg = info.fov_deg;
  view.camera = choose_camera(view.scene, request);
  view.size_px = info.size_px;
  return view;
}

}  // namespace sightline
