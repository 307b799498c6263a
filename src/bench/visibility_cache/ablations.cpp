// What single choices cost and give: the paper's, this project's, and those beyond the paper.
#include <fmt/format.h>

#include "bench/visibility_cache/figures.h"
#include "bench/visibility_cache/parts.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

struct Variant {
  const char* name;
  std::vector<std::string> settings;
};

const std::vector<Variant>& variants() {
  static const std::vector<Variant> table = {
      {"as it is", {}},
      {"scanline order", {"order=scanline"}},
      {"no refinement", {"refine=none"}},
      {"scanline order, no refinement", {"order=scanline", "refine=none"}},
      {"floor normals", {"normals=floor"}},
      {"64 neighbours", {"refine=64"}},
      {"refined to two eye paths, as printed", {"depth=3"}},
      {"no rays for important queries", {"importance=0"}},
      {"two rays a cell", {"counters=2"}},
      {"three rays a cell", {"counters=3"}},
      {"residual 0.05", {"residual=0.05"}},
      {"refinement at the light, 1 level", {"light_refine=1"}},
      {"hash: recurrence", {"hash=recurrence"}},
      {"hash: mix64", {"hash=mix64"}},
      {"table of 2^14 slots", {"table_bits=14"}},
      {"table of 2^16 slots", {"table_bits=16"}},
      {"table of 2^20 slots", {"table_bits=20"}},
      {"groups of 64 queries", {"group=64"}},
      {"groups of 4096 queries", {"group=4096"}},
  };
  return table;
}

}  // namespace

Json cache_ablations(const CacheView& view, const CacheBenchOptions& options, const Context& context) {
  constexpr double kEdge = 8;
  context.info(fmt::format("bench visibility-cache: ablations, {}", view.name));
  std::vector<ShotRequest> requests = {{.visibility = "exact"}};
  for (const Variant& variant : variants()) {
    ShotRequest request{.settings = variant.settings};
    request.settings.push_back(fmt::format("ce={}", kEdge));
    requests.push_back(std::move(request));
  }
  const std::vector<Shot> shots = shoot_by_turns(view, requests, options.quick ? 1 : 3, context);
  const std::vector<std::uint8_t> mask = surface_mask(view, 1, {}, context);
  Json rows = Json::array();
  for (std::size_t i = 0; i < variants().size(); ++i) {
    Json row = {{"name", variants()[i].name}, {"settings", variants()[i].settings}};
    row.update(cache_rays(shots[i + 1], shots[0]));
    row.update(cache_errors(shots[0].image, shots[i + 1].image, mask));
    rows.push_back(std::move(row));
  }
  return {{"view", view.name}, {"size", {view.size_px.x, view.size_px.y}}, {"ce", kEdge},
          {"spp", 1},          {"exact_seconds", shots[0].seconds},        {"rows", std::move(rows)}};
}

}  // namespace sightline
