// Error over the size of the light, at constant power.
#include <fmt/format.h>

#include <array>
#include <variant>

#include "bench/fragments/bars.h"
#include "bench/fragments/candidates.h"
#include "bench/fragments/parts.h"
#include "bench/fragments/row.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

/// The scene with its rectangles as squares of `side`, of the same power. Nothing if it has none.
std::optional<Scene> with_squares(const Scene& scene, float side) {
  Scene edited = scene;
  bool any = false;
  for (Light& light : edited.lights) {
    auto* rectangle = std::get_if<RectangleLight>(&light.shape);
    if (!rectangle) continue;
    any = true;
    const float area = 4 * glm::length(glm::cross(rectangle->half_u, rectangle->half_v));
    rectangle->radiance *= area / (side * side);
    rectangle->half_u = 0.5f * side * glm::normalize(rectangle->half_u);
    rectangle->half_v = 0.5f * side * glm::normalize(rectangle->half_v);
  }
  if (!any) return std::nullopt;
  return edited;
}

}  // namespace

Json fragment_sizes(const BuiltView& view, const FragmentBenchOptions& options, const Context& context) {
  context.info(fmt::format("bench fragments: sizes of the light, {}", view.name));
  Json rows = Json::array();
  std::vector<double> errors;
  for (const float side : {1.f, 1.5f, 2.f, 2.5f, 3.f, 3.5f}) {
    if (options.quick && side != 1 && side != 3.5f) continue;
    std::optional<Scene> scene = with_squares(view.world->scene(), side);
    if (!scene) {
      context.warn(fmt::format("{}: no rectangle to resize; left out of sizes", view.name));
      return {};
    }
    BuiltView sized = view;
    sized.world = World::edit(*view.world, std::move(*scene), context);
    const FragmentTruth truth = fragment_truth(sized, options, context);
    const RenderRequest request = fragments_request(fragments_default().settings);
    const int rounds = options.rounds > 0 ? options.rounds : options.quick ? 1 : 3;
    const std::vector<Shot> shots = shoot_by_turns(1, rounds, [&](std::size_t) { return shoot(sized, request, context); });
    Json row = {{"side", side}};
    row.update(fragment_row(truth, shots.front()));
    errors.push_back(row["l2"].get<double>());
    rows.push_back(std::move(row));
  }
  return {{"view", view.name},
          {"size", {view.size_px.x, view.size_px.y}},
          {"largest_deviation", largest_deviation(errors)},
          {"rows", std::move(rows)}};
}

}  // namespace sightline
