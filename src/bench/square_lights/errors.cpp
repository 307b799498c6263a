// Figures 9 and 10 as a table: what splitting the light costs, alone and with the tables, beside wavelets of as many terms.
#include <fmt/format.h>

#include "bench/square_lights/parts.h"
#include "image/metrics/metrics.h"

namespace sightline {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kSquareCounts[] = {10, 30, 60, 100};
constexpr int kWaveletCounts[] = {20, 30, 60, 100};

}  // namespace

Json square_differences(const ColorImage& reference, const ColorImage& image, std::span<const std::uint8_t> mask) {
  MetricOptions options;
  options.mask = mask;
  Json errors = Json::object();
  for (const char* name : {"l2", "nmse", "flip"}) errors[name] = find_metric(name).compute(reference, image, options);
  return errors;
}

Json square_errors(const SquareStage& given, const SquareBenchShared& shared, const Context& context) {
  context.info(fmt::format("bench square-lights: errors, {}", given.name));
  SquareStage stage = given;
  set_content_material(stage.scene, glossy_material());
  const BuiltView view = build_stage(stage, 0, context);
  const std::vector<std::uint8_t> mask = surface_mask(view, light_request(1), context);
  const auto picture = [&](const std::vector<std::string>& settings) {
    return shoot(view, square_request(shared.options, shared.bakes, settings), context);
  };
  const Shot traced = picture({"lights=all"}), tables = picture({"lights=all-tables"});
  Json rows = Json::array();
  const auto add = [&](const char* basis, const std::string& name, const Json& count, const Shot& shot) {
    Json row = {{"basis", basis}, {"name", name}, {"lights", count}, {"seconds", shot.seconds}};
    row["l2_tables"] = std::string_view(basis) == "squares" ? square_differences(tables.image, shot.image, mask)["l2"] : Json();
    row.update(square_differences(traced.image, shot.image, mask));
    rows.push_back(std::move(row));
  };
  for (const int count : kSquareCounts) {
    const Shot shot = picture({fmt::format("lights={}", count)});
    add("squares", fmt::format("{} squares", count), count, shot);
  }
  add("squares", "all texels, by tables", Json(), tables);
  for (const bool weighted : {true, false}) {
    for (const int count : kWaveletCounts) {
      const Shot shot =
          picture({"basis=haar", fmt::format("lights={}", count), fmt::format("area_weighted={}", weighted ? "true" : "false")});
      add(weighted ? "haar" : "haar-unweighted", fmt::format("{} wavelets{}", count, weighted ? "" : ", by coefficient alone"), count,
          shot);
    }
  }
  return {{"view", stage.name},
          {"size", {view.size_px.x, view.size_px.y}},
          {"vertices", vertex_count(stage.scene)},
          {"material", "Phong, exponent 50"},
          {"cube", cube_size(shared.options)},
          {"rows", std::move(rows)}};
}

}  // namespace sightline
