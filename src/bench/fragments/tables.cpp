#include "bench/fragments/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/fragments/fragment_bench.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;
using cell::count, cell::fixed, cell::percent, cell::scientific, cell::seconds, cell::text;

// The method's stages in the order in which they run; others follow.
std::vector<std::string> stages_of(const Json& rows) {
  std::vector<std::string> names = {"primary rays", "geometry", "visibility", "upsampling", "shading", "film"};
  for (const Json& row : rows) {
    if (!row["fragments"].is_number()) continue;
    for (const auto& [name, seconds] : row["stages"].items()) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

std::string place(const Json& part) { return text(part["view"]) + ", " + cell::size(part["size"]); }

Json others(const Json& row) {
  if (!row["other_rays"].is_number()) return {};
  const double penumbrae = row["penumbra_rays"].is_number() ? row["penumbra_rays"].get<double>() : 0;
  return row["other_rays"].get<double>() + penumbrae;
}

BenchTable picture_table(const Json& view) {
  BenchTable table{
      .title = "Fragments, rays, errors: " + place(view),
      .note = fmt::format(
          "Rays in millions: of refinement tests, of confirmations, of single pixels, of additional samples, all others "
          "(penumbrae), and their sum. Seconds are those of the whole frame, primary rays included: the median of {} round{}. Errors "
          "against {} samples. {} triangles.",
          text(view["rounds"]), view["rounds"] == 1 ? "" : "s", text(view["truth_samples"]), count(view["triangles"])),
      .header = {"picture", "fragments", "single pixels", "test", "confirm", "pixel", "extra", "other", "sum", "s", "speed-up", "l2",
                 "nmse", "FLIP", "PSNR, dB"}};
  const auto millions = [](const Json& rays) { return rays.is_number() ? fixed(rays.get<double>() * 1e-6, 2) : fixed(rays, 2); };
  for (const Json& row : view["rows"])
    table.rows.push_back({text(row["name"]), count(row["fragments"]), percent(row["level0_share"], 1), millions(row["test_rays"]),
                          millions(row["confirmation_rays"]), millions(row["level0_rays"]), millions(row["extra_rays"]),
                          millions(others(row)), millions(row["rays"]), seconds(row["seconds"]), fixed(row.value("speed_up", Json()), 2),
                          scientific(row["l2"]), scientific(row["nmse"]), fixed(row["flip"], 4), fixed(row["psnr"], 1)});
  return table;
}

BenchTable stage_table(const Json& view) {
  BenchTable table{.title = "Stages: " + place(view), .note = "CPU seconds, all threads together.", .header = {"picture"}};
  const std::vector<std::string> stages = stages_of(view["rows"]);
  table.header.insert(table.header.end(), stages.begin(), stages.end());
  for (const Json& row : view["rows"]) {
    if (!row["fragments"].is_number()) continue;
    table.rows.push_back({text(row["name"])});
    for (const std::string& name : stages) table.rows.back().push_back(cell::seconds(row["stages"].value(name, Json())));
  }
  return table;
}

BenchTable sweep_table(const Json& view) {
  BenchTable table{.title = "Threshold of the predecessor: " + place(view),
                   .note =
                       "Rays of 64 by which neighbours may differ. The least product of l2 and time takes part above; times here are "
                       "of one round.",
                   .header = {"threshold", "rays, millions", "s", "l2"}};
  for (const Json& row : view["nichols_sweep"])
    table.rows.push_back(
        {text(row["threshold"]), fixed(row["rays"].get<double>() * 1e-6, 2), seconds(row["seconds"]), scientific(row["l2"])});
  return table;
}

std::vector<BenchTable> table_tables(const Json& views) {
  std::vector<BenchTable> tables;
  for (const Json& view : views) {
    tables.push_back(picture_table(view));
    tables.push_back(stage_table(view));
    if (!view["nichols_sweep"].empty()) tables.push_back(sweep_table(view));
  }
  return tables;
}

std::vector<BenchTable> curve_tables(const Json& views) {
  BenchTable bars{.title = "What it is worth on Monte Carlo's scale",
                  .note =
                      "Equal error: the smallest measured number of samples whose l2 is no worse, its time over ours, and the same "
                      "interpolated between the measured numbers. Equal time: PSNR over Monte Carlo's, interpolated over the "
                      "logarithm of time.",
                  .header = {"view", "s", "l2", "FLIP", "equal error: samples", "time ratio", "interpolated samples", "time ratio",
                             "time of 64 samples, ratio", "equal time, dB"}};
  std::vector<BenchTable> tables;
  for (const Json& view : views) {
    const Json &ours = view["ours"], &equal = view["equal_error"];
    const bool beyond = equal["samples"] == 0;
    bars.rows.push_back({place(view), seconds(ours["seconds"]), scientific(ours["l2"]), fixed(ours["flip"], 4),
                         beyond ? "more than measured" : text(equal["samples"]), (beyond ? "> " : "") + fixed(equal["ratio"], 2),
                         fixed(equal["interpolated_samples"], 1), fixed(equal["interpolated_ratio"], 2), fixed(view["against_64"], 2),
                         fixed(view["equal_time_db"], 1)});
    BenchTable table{.title = "Monte Carlo: " + place(view),
                     .note = fmt::format("By turns with ours, rounds: {}; errors against {} samples.", text(view["rounds"]),
                                         text(view["truth_samples"])),
                     .header = {"samples", "rays, millions", "s", "l2", "nmse", "FLIP", "PSNR, dB"}};
    const auto add = [&](const std::string& name, const Json& row) {
      table.rows.push_back({name, fixed(row["rays"].get<double>() * 1e-6, 2), seconds(row["seconds"]), scientific(row["l2"]),
                            scientific(row["nmse"]), fixed(row["flip"], 4), fixed(row["psnr"], 1)});
    };
    for (const Json& row : view["rows"]) add(text(row["samples"]), row);
    add("fragments", ours);
    tables.push_back(std::move(table));
  }
  tables.insert(tables.begin(), std::move(bars));
  return tables;
}

std::vector<BenchTable> size_tables(const Json& views) {
  std::vector<BenchTable> tables;
  for (const Json& view : views) {
    BenchTable table{.title = "Sizes of the light: " + place(view),
                     .note = fmt::format("Square lights of constant power. Largest deviation of l2 from its mean: {}.",
                                         percent(view["largest_deviation"], 1)),
                     .header = {"side", "fragments", "single pixels", "rays, millions", "s", "l2", "nmse", "FLIP", "PSNR, dB"}};
    for (const Json& row : view["rows"])
      table.rows.push_back({fixed(row["side"], 1), count(row["fragments"]), percent(row["level0_share"], 1),
                            fixed(row["rays"].get<double>() * 1e-6, 2), seconds(row["seconds"]), scientific(row["l2"]),
                            scientific(row["nmse"]), fixed(row["flip"], 4), fixed(row["psnr"], 1)});
    tables.push_back(std::move(table));
  }
  return tables;
}

std::vector<BenchTable> interactive_tables(const Json& views) {
  BenchTable table{.title = "Camera and light moving",
                   .note = "Frames over their seconds, with the edit of the scene that moves the light.",
                   .header = {"view", "path", "frames", "frames a second", "median frame, s", "slowest, s", "of it the edit, s"},
                   .text_columns = 2};
  for (const Json& view : views)
    table.rows.push_back({place(view), text(view["path"]), text(view["frames"]), fixed(view["frames_per_second"], 1),
                          seconds(view["median_frame_seconds"]), seconds(view["slowest_frame_seconds"]),
                          fixed(view["median_edit_seconds"], 4)});
  return {table};
}

std::vector<BenchTable> temporal_tables(const Json& views) {
  std::vector<BenchTable> tables;
  for (const Json& view : views) {
    BenchTable table{.title = "What the last picture knows: " + place(view),
                     .note = fmt::format("{}, {} frames: shadow rays a frame, median seconds; errors are means of {} of them.",
                                         text(view["path"]), text(view["frames"]), view["judged_frames"].size()),
                     .header = {"setting", "rays, millions", "s", "frames a second", "l2", "nmse", "FLIP", "PSNR, dB"}};
    for (const Json& row : view["rows"])
      table.rows.push_back({text(row["name"]), fixed(row["rays"].get<double>() * 1e-6, 3), seconds(row["median_frame_seconds"]),
                            fixed(row["frames_per_second"], 1), scientific(row["l2"]), scientific(row["nmse"]), fixed(row["flip"], 4),
                            fixed(row["psnr"], 1)});
    tables.push_back(std::move(table));
  }
  return tables;
}

}  // namespace

std::vector<BenchTable> fragment_bench_tables(const Json& results, const std::string& part) {
  if (!results.contains(part) || results[part].empty()) return {};
  const Json& views = results[part];
  if (part == "aims") return {aims_table(views)};
  if (part == "table") return table_tables(views);
  if (part == "curve") return curve_tables(views);
  if (part == "sizes") return size_tables(views);
  if (part == "temporal") return temporal_tables(views);
  return interactive_tables(views);
}

std::string fragment_bench_markdown(const Json& results) {
  std::string text;
  for (const char* part : {"aims", "table", "curve", "sizes", "interactive", "temporal"}) {
    for (const BenchTable& table : fragment_bench_tables(results, part)) text += markdown_table(table);
  }
  return text;
}

}  // namespace sightline
