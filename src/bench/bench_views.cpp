#include "bench/bench_views.h"

#include "base/core/error.h"
#include "scene/load/load.h"
#include "session/options_text.h"
#include "session/setup.h"

namespace sightline {
namespace {

struct ViewInfo {
  std::string name, spec;  ///< scene; a path is relative to the data folder
  std::string needs;       ///< file that must be there, or empty
  std::optional<Vec3> eye, target;
  float fov_deg = 0;
  std::vector<std::string> area_lights;
};

const std::vector<ViewInfo>& views() {
  static const std::vector<ViewInfo> table = {
      {"dragon-room", "builtin:room,content=meshes/dragon_vrip.ply", "meshes/dragon_vrip.ply", {}, {}, 0, {}},
      {"sponza-court",
       "scenes/sponza-dabrovic/sponza.obj",
       "scenes/sponza-dabrovic/sponza.obj",
       Vec3(-12, 3, 0.5f),
       Vec3(5, 4.5f, 0),
       65,
       {"0,11,0 0,-1,0 2x2 60,60,60"}},
      {"hairball-room", "builtin:room,content=hairball", "", {}, {}, 0, {}},
      {"sponza-arcade",
       "scenes/sponza-dabrovic/sponza.obj",
       "scenes/sponza-dabrovic/sponza.obj",
       Vec3(-13, 6.5f, -5.2f),
       Vec3(8, 4, 1),
       65,
       {"2,9,0 0,-1,0 1x1 200,200,200"}},
      {"conference",
       "scenes/conference/conference.ply",
       "scenes/conference/conference.ply",
       Vec3(0, 300, 0),
       Vec3(1000, 100, 0),
       60,
       {"300,640,-200 0,-1,0 400x400 12,12,12"}},
  };
  return table;
}

}  // namespace

std::vector<std::string> bench_view_names() {
  std::vector<std::string> names;
  for (const ViewInfo& view : views()) names.push_back(view.name);
  return names;
}

std::optional<BenchView> load_bench_view(const std::string& name, const std::filesystem::path& data, const Context& context) {
  const ViewInfo* info = nullptr;
  for (const ViewInfo& view : views()) {
    if (view.name == name) info = &view;
  }
  if (!info) throw usage_error("unknown view '" + name + "'");
  if (!info->needs.empty() && !std::filesystem::exists(data / info->needs)) return std::nullopt;

  LoadOptions options;
  options.data_directory = data;
  const bool builtin = info->spec.starts_with("builtin:");
  BenchView view{name, load_scene(builtin ? info->spec : (data / info->spec).string(), options, context), {}};
  // Views of files show geometry alone: one diffuse material, as the papers' comparisons do.
  if (!builtin) {
    view.scene.materials = {Material{}};
    for (Mesh& mesh : view.scene.meshes) mesh.materials = {MaterialId{std::size_t{0}}}, mesh.triangle_materials = {};
    for (Instance& instance : view.scene.instances) instance.material_override = {};
  }
  LightRequest lights;
  lights.area = info->area_lights;
  apply_lights(view.scene, lights, context);
  ViewRequest request;
  request.eye = info->eye, request.target = info->target;
  if (info->fov_deg > 0) request.fov_deg = info->fov_deg;
  view.camera = choose_camera(view.scene, request);
  return view;
}

}  // namespace sightline
