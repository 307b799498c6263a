// What is computed beforehand: each bake from an empty store.
#include <fmt/format.h>

#include <algorithm>

#include "bench/square_lights/parts.h"

namespace sightline {

using Json = nlohmann::ordered_json;

Json square_bakes(SquareStage stage, const SquareBenchShared& shared, const Context& context) {
  context.info(fmt::format("bench square-lights: bakes, {}", stage.name));
  // What stands still is one object: without the ground its tables are those of the content alone, which the figures are quoted for.
  if (moving_part_count(stage.scene) == 0) remove_ground(stage.scene);
  const BuiltView view = build_stage(stage, 0, context);
  const RenderRequest request = square_request(shared.options, shared.empty_bakes, {});
  const std::size_t known = shared.empty_bakes->events().size();
  const std::uint64_t bytes = bake(view.world, request, context);
  Json rows = Json::array();
  const std::vector<BakeStore::Event> events = shared.empty_bakes->events();
  for (std::size_t i = known; i < events.size(); ++i)
    rows.push_back({{"kind", events[i].id.kind}, {"seconds", events[i].seconds}, {"bytes", events[i].bytes}});
  return {{"view", stage.name},
          {"vertices", vertex_count(stage.scene)},
          {"parts", moving_part_count(stage.scene)},
          {"bytes", bytes},
          {"rows", std::move(rows)}};
}

}  // namespace sightline
