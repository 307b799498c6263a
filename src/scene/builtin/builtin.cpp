#include "scene/builtin/builtin.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/core/error.h"
#include "scene/builtin/scenes.h"

namespace sightline {
namespace {

std::vector<BuiltinScene> make_table() {
  using namespace builtin;
  return {cornell_scene(),   glass_scene(),   veach_like_scene(), textured_scene(),  spheres_scene(),           room_scene(),
          open_room_scene(), ground_scene(),  movers_scene(),     pair_scene(),      hairball_scene(),          isosurface_scene(),
          plant_scene(),     furnace_scene(), quad_scene(),       two_quads_scene(), lit_sphere_inside_scene(), half_plane_scene()};
}

const BuiltinScene& find_scene(std::string_view name) {
  std::vector<std::string> known;
  for (const BuiltinScene& scene : builtin_scenes()) {
    if (scene.name == name) return scene;
    known.push_back(scene.name);
  }
  const std::string nearest = nearest_name(name, known);
  throw usage_error(fmt::format("there is no builtin scene '{}'", name))
      .remedy(nearest.empty() ? fmt::format("known: {}", fmt::join(known, ", ")) : fmt::format("did you mean '{}'?", nearest));
}

}  // namespace

const std::vector<BuiltinScene>& builtin_scenes() {
  static const std::vector<BuiltinScene> table = make_table();
  return table;
}

Scene build_builtin(std::string_view spec, const LoadOptions& options, const Context& context) {
  const std::size_t name_end = std::min(spec.find_first_of("?,"), spec.size());
  const BuiltinScene& entry = find_scene(spec.substr(0, name_end));
  SettingsValue parameters = entry.parameters;
  try {
    // The first separator chooses the style: after '?' commas belong to values, after ',' the characters '?' and '&' do. So a parameter
    // may itself be a scene with parameters: room,content=hairball?triangles=1000&seed=2.
    const char separator = name_end < spec.size() && spec[name_end] == '?' ? '&' : ',';
    for (std::size_t begin = name_end + 1; begin < spec.size();) {
      const std::size_t end = std::min(spec.find(separator, begin), spec.size());
      if (end > begin) parameters.apply(spec.substr(begin, end - begin));
      begin = end + 1;
    }
    Scene scene = entry.build(parameters, options, context);
    scene.name = entry.name;
    return scene;
  } catch (Error& error) {
    throw error.at("builtin:" + entry.name);
  }
}

}  // namespace sightline
