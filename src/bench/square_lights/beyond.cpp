// Settings beyond the paper and ablations of it, each turned alone.
#include <fmt/format.h>

#include "bench/square_lights/parts.h"

namespace sightline {

using Json = nlohmann::ordered_json;

namespace {

struct Variant {
  const char* name;
  std::vector<std::string> settings;
};

const std::vector<Variant>& variants() {
  static const std::vector<Variant> table = {
      {"as it is", {}},
      {"coverage: mean over turns", {"coverage=average"}},
      {"coverage: by the gradient", {"coverage=gradient"}},
      {"light by pixel", {"shading=pixel"}},
      {"visibility by summed areas", {"tables=summed"}},
      {"regions as merged", {"exchange=false"}},
      {"regions as merged by moments", {"merge=moments", "exchange=false"}},
      {"regions as the paper merges them", {"merge=paper", "exchange=false"}},
      {"occluders by the product of what they leave", {"combine=product"}},
      {"squares split by the bound, 1 %", {"split=0.01"}},
      {"squares split by the bound, 0.1 %", {"split=0.001"}},
      {"no penalty of area", {"area_penalty=false"}},
      {"the paper's radius", {"paper_radius=true"}},
      {"the horizon hides", {"count_horizon=true"}},
      {"far shells not zoomed", {"zoom=false"}},
  };
  return table;
}

}  // namespace

Json square_beyond(const SquareStage& given, const SquareBenchShared& shared, const Context& context) {
  context.info(fmt::format("bench square-lights: settings turned on and off, {}", given.name));
  SquareStage stage = given;
  set_content_material(stage.scene, glossy_material());
  const BuiltView view = build_stage(stage, 0.25f * stage.scene.animation_duration_s, context);
  const std::vector<std::uint8_t> mask = surface_mask(view, light_request(1), context);
  const Shot traced = shoot(view, square_request(shared.options, shared.bakes, {"lights=all"}), context);
  // The first picture of all is no slower than the others for being the first.
  shoot(view, square_request(shared.options, shared.bakes, {}), context);
  Json rows = Json::array();
  for (const Variant& variant : variants()) {
    const Shot shot = shoot(view, square_request(shared.options, shared.bakes, variant.settings), context);
    Json row = {{"name", variant.name}, {"settings", variant.settings}, {"seconds", shot.seconds}};
    row.update(square_differences(traced.image, shot.image, mask));
    rows.push_back(std::move(row));
  }
  return {{"view", stage.name}, {"size", {view.size_px.x, view.size_px.y}}, {"lights", 30}, {"rows", std::move(rows)}};
}

}  // namespace sightline
