// sightline bake
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/core/error.h"
#include "commands.h"
#include "session/material_option.h"

namespace sightline::app {
namespace {

std::string_view word_of(BakeStore::Event::What what) {
  switch (what) {
    case BakeStore::Event::What::found:
      return "found";
    case BakeStore::Event::What::made:
      return "made";
    default:
      return "rebuilt";
  }
}

}  // namespace

std::shared_ptr<BakeStore> open_bakes(const RenderCommand& command) {
  return std::make_shared<BakeStore>(command.bake_directory ? std::filesystem::path(*command.bake_directory) : default_bake_directory());
}

int run_bake(const CommandLine& line, Console& console, Context& context) {
  const RenderCommand& command = line.render;
  if (command.memory_limit_gib)
    context.memory_budget_bytes = static_cast<std::uint64_t>(std::min(*command.memory_limit_gib, 1e9) * (1u << 30));
  RenderRequest request = command.render;
  request.bakes = open_bakes(command);
  if (request.bakes->directory().empty())
    throw usage_error("no folder to keep bakes in").remedy("give one with --bake-dir, or set HOME or XDG_CACHE_HOME");
  const Method& method = find_method(request.method);
  resolve_settings(method, find_visibility(request.visibility.value_or(method.default_visibility())), request.settings);

  LoadOptions load_options;
  load_options.data_directory = line.common.data_directory;
  const std::vector<MaterialRequest> materials = parse_materials(command.materials, load_options.data_directory);
  Scene scene = load_scenes(command.scenes, load_options, context);
  apply_materials(scene, materials);
  apply_lights(scene, command.lights, context);
  scene = pose(std::move(scene), static_cast<float>(command.frame.value_or(0)) / command.fps);
  const std::shared_ptr<const World> world = World::build(std::move(scene), {}, context);
  bake(world, request, context);
  console.finish();

  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const BakeStore::Event& event : request.bakes->events()) {
    const std::string path = request.bakes->path_of(event.id).string();
    list.push_back({{"kind", event.id.kind},
                    {"key", event.id.key_text()},
                    {"what", word_of(event.what)},
                    {"bytes", event.bytes},
                    {"seconds", event.seconds},
                    {"file", path}});
    if (!command.bake_json)
      fmt::print("{} {:.1f} MB in {:.2f} s: {}\n", word_of(event.what), static_cast<double>(event.bytes) * 1e-6, event.seconds, path);
  }
  if (command.bake_json) fmt::print("{}\n", list.dump(2));
  return kDone;
}

}  // namespace sightline::app
