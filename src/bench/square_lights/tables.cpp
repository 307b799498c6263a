#include "bench/square_lights/tables.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "bench/square_lights/square_bench.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;
using cell::count, cell::fixed, cell::percent, cell::scientific, cell::seconds, cell::text;

std::string place(const Json& part) { return text(part["view"]) + ", " + cell::size(part["size"]); }

// Errors in percent, with digits for a few hundredths of one.
std::string l2(const Json& value) { return percent(value, 3); }

std::string milliseconds(const Json& value) { return value.is_number() ? fixed(1000 * value.get<double>(), 1) : "–"; }

std::string megabytes(const Json& value) { return value.is_number() ? fixed(value.get<double>() * 1e-6, 2) : "–"; }

std::vector<BenchTable> error_tables(const Json& views) {
  std::vector<BenchTable> tables;
  for (const Json& view : views) {
    BenchTable table{.title = "Errors over the number of lights: " + place(view),
                     .note = fmt::format("{} vertices, {}; cube map of 6 x {} x {} texels. l2 in percent, against every texel by the same "
                                         "tables (the split of the light alone) and against every texel traced.",
                                         count(view["vertices"]), text(view["material"]), text(view["cube"]), text(view["cube"])),
                     .header = {"light", "s", "l2 of the split", "l2", "nmse", "FLIP"}};
    for (const Json& row : view["rows"])
      table.rows.push_back({text(row["name"]), seconds(row["seconds"]), l2(row["l2_tables"]), l2(row["l2"]), scientific(row["nmse"]),
                            fixed(row["flip"], 4)});
    tables.push_back(std::move(table));
  }
  return tables;
}

std::vector<BenchTable> bake_tables(const Json& views) {
  BenchTable table{.title = "Bakes",
                   .note = "From an empty store; what stands still without its ground. What an earlier view made is not made again.",
                   .header = {"view", "vertices", "bake", "s", "MB"}};
  for (const Json& view : views) {
    for (const Json& row : view["rows"])
      table.rows.push_back(
          {text(view["view"]), count(view["vertices"]), text(row["kind"]), seconds(row["seconds"]), megabytes(row["bytes"])});
  }
  return {table};
}

std::vector<BenchTable> speed_tables(const Json& views) {
  BenchTable table{
      .title = "Frames a second",
      .note =
          "A frame is all of it: the environment turned, parts moved, the scene edited, the method prepared, every vertex lit, camera "
          "rays of a camera that moves, interpolation. Median milliseconds by stage.",
      .header = {"view", "vertices", "parts", "lights", "frames a second", "frame, ms", "edit", "prepare", "light at vertices",
                 "vertices and pixels", "frames a second, shading alone", "rays but primary"}};
  for (const Json& view : views)
    table.rows.push_back({place(view), count(view["vertices"]), text(view["parts"]), text(view["lights"]),
                          fixed(view["frames_per_second"], 1), milliseconds(view["median_frame_seconds"]),
                          milliseconds(view["edit_seconds"]), milliseconds(view["prepare_seconds"]), milliseconds(view["shading_seconds"]),
                          milliseconds(view["pass_seconds"]), fixed(view["shading_frames_per_second"], 1), count(view["occlusion_rays"])});
  return {table};
}

std::vector<BenchTable> edit_tables(const Json& views) {
  BenchTable table{.title = "Materials edited",
                   .note = "Median milliseconds from a changed parameter to the picture that shows it.",
                   .header = {"view", "vertices", "what changes", "edit", "tables and what else is prepared", "picture", "in all"}};
  for (const Json& view : views) {
    for (const Json& row : view["rows"])
      table.rows.push_back({place(view), count(view["vertices"]), text(row["name"]), milliseconds(row["edit_seconds"]),
                            milliseconds(row["prepare_seconds"]), milliseconds(row["pass_seconds"]), milliseconds(row["seconds"])});
  }
  return {table};
}

std::vector<BenchTable> storage_tables(const Json& views) {
  std::vector<BenchTable> tables;
  for (const Json& view : views) {
    const bool occluders = view["tables_of"] == "occluders";
    BenchTable table{.title = fmt::format("Tables of {}: {}", text(view["tables_of"]), place(view)),
                     .note = fmt::format("Ratio against tables of floats. l2 against every texel traced, percentage points more than raw, "
                                         "and l2 against raw itself.{}",
                                         occluders ? " Vertices' tables are compressed with 16 vectors beside them." : ""),
                     .header = {"stored as", "MB", occluders ? "MB an occluder" : "bytes a vertex", "ratio", "baked in, s", "l2",
                                "points more", "l2 against raw"}};
    for (const Json& row : view["rows"])
      table.rows.push_back({text(row["name"]), megabytes(row["bytes"]),
                            occluders ? megabytes(row["bytes_each"]) : fixed(row["bytes_each"], 0), fixed(row["ratio"], 1),
                            seconds(row["bake_seconds"]), l2(row["l2"]), fixed(row["more_points"], 4), l2(row["l2_raw"])});
    tables.push_back(std::move(table));
  }
  return tables;
}

std::vector<BenchTable> rotation_tables(const Json& views) {
  BenchTable table{.title = "The environment turns",
                   .note =
                       "Light turned by R against scene and camera turned back by it; 99.9th percentile of a pixel's change from step to "
                       "step of a full turn, with 30 lights and with every texel.",
                   .header = {"view", "relative rms", "largest, of the mean", "pixels of silhouettes left out", "steps", "change",
                              "change of all texels", "ratio"}};
  for (const Json& view : views) {
    const Json none;
    const auto turned = [&](const char* key) -> const Json& { return view["turned"].is_object() ? view["turned"][key] : none; };
    table.rows.push_back({place(view), scientific(turned("relative_rms")), scientific(turned("largest_of_mean")), count(turned("left_out")),
                          text(view["steps"]), scientific(view["change"]), scientific(view["change_of_all_texels"]),
                          fixed(view["ratio"], 3)});
  }
  return {table};
}

std::vector<BenchTable> moving_tables(const Json& views) {
  std::vector<BenchTable> tables;
  for (const Json& view : views) {
    BenchTable table{.title = "Frames beside the reference: " + place(view),
                     .note = fmt::format("{} vertices, {} frames, {} s each (median); the reference takes {} light samples a pixel of the "
                                         "same cube map. Rays but primary ones: {}.",
                                         count(view["vertices"]), text(view["frames"]), seconds(view["median_frame_seconds"]),
                                         text(view["truth_samples"]), count(view["occlusion_rays"])),
                     .header = {"frame", "FLIP", "l2", "nmse"}};
    for (const Json& row : view["rows"])
      table.rows.push_back({text(row["frame"]), fixed(row["flip"], 4), l2(row["l2"]), scientific(row["nmse"])});
    tables.push_back(std::move(table));
  }
  return tables;
}

std::vector<BenchTable> beyond_tables(const Json& views) {
  std::vector<BenchTable> tables;
  for (const Json& view : views) {
    BenchTable table{.title = "Settings turned on and off: " + place(view),
                     .note = fmt::format("{} lights, against every texel traced.", text(view["lights"])),
                     .header = {"setting", "", "s", "l2", "nmse", "FLIP"},
                     .text_columns = 2};
    for (const Json& row : view["rows"]) {
      std::string settings;
      for (const Json& setting : row["settings"]) settings += (settings.empty() ? "" : " ") + setting.get<std::string>();
      table.rows.push_back(
          {text(row["name"]), settings, seconds(row["seconds"]), l2(row["l2"]), scientific(row["nmse"]), fixed(row["flip"], 4)});
    }
    tables.push_back(std::move(table));
  }
  return tables;
}

}  // namespace

std::vector<BenchTable> square_bench_tables(const Json& results, const std::string& part) {
  if (!results.contains(part) || results[part].empty()) return {};
  const Json& views = results[part];
  if (part == "aims") return {aims_table(views)};
  if (part == "errors") return error_tables(views);
  if (part == "bakes") return bake_tables(views);
  if (part == "speed") return speed_tables(views);
  if (part == "edit") return edit_tables(views);
  if (part == "storage") return storage_tables(views);
  if (part == "rotation") return rotation_tables(views);
  if (part == "moving") return moving_tables(views);
  if (part == "beyond") return beyond_tables(views);
  return {};
}

std::string square_bench_markdown(const Json& results) {
  std::string markdown;
  for (const char* part : {"aims", "errors", "bakes", "speed", "edit", "storage", "rotation", "moving", "beyond"}) {
    for (const BenchTable& table : square_bench_tables(results, part)) markdown += markdown_table(table);
  }
  return markdown;
}

}  // namespace sightline
