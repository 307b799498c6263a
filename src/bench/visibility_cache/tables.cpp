#include "bench/visibility_cache/tables.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "bench/visibility_cache/cache_bench.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

using cell::fixed, cell::percent, cell::seconds, cell::signed_percent, cell::text;

std::vector<BenchTable> curve_tables(const Json& views) {
  BenchTable table{.title = "Range of C_E",
                   .note =
                       "Against exact visibility with the same samples. Ray reduction is hits / misses; kept are occlusion rays of all "
                       "kinds.",
                   .header = {"view", "spp", "C_E", "traced", "ray reduction", "kept", "exact, s", "cached, s", "speed-up", "L^INF", "bias",
                              "FLIP", "look-ups a query"}};
  for (const Json& view : views) {
    for (const Json& sample : view["samples"]) {
      for (const Json& row : sample["cached"])
        table.rows.push_back({text(view["view"]) + ", " + cell::size(view["size"]), text(sample["spp"]), fixed(row["ce"], 0),
                              percent(row["share_traced"]), fixed(row["ray_reduction"], 1), percent(row["occlusion_rays_kept"]),
                              seconds(sample["exact"]["seconds"]), seconds(row["seconds"]), fixed(row["speed_up"], 2), percent(row["linf"]),
                              signed_percent(row["signed_error"]), fixed(row["flip"], 4), fixed(row["lookups_per_query"], 2)});
    }
  }
  return {table};
}

std::vector<BenchTable> equal_time_tables(const Json& views) {
  std::vector<BenchTable> tables;
  for (const Json& view : views) {
    BenchTable table{
        .title = fmt::format("Equal time: {}, {}", text(view["view"]), cell::size(view["size"])),
        .note = fmt::format("Against exact visibility with {} other samples a pixel; direct light.", text(view["reference_spp"])),
        .header = {"visibility", "spp", "light samples", "s", "traced", "L^INF", "l2", "FLIP"}};
    for (const Json& row : view["rows"])
      table.rows.push_back({text(row["name"]), text(row["spp"]), text(row["light_samples"]), seconds(row["seconds"]),
                            percent(row["share_traced"]), percent(row["linf"]), cell::scientific(row["l2"]), fixed(row["flip"], 4)});
    tables.push_back(std::move(table));
  }
  return tables;
}

std::vector<BenchTable> shadow_map_tables(const Json& views) {
  std::vector<BenchTable> tables;
  for (const Json& view : views) {
    for (const Json& sample : view["samples"]) {
      BenchTable table{
          .title = fmt::format("Shadow maps: {}, {}, {} spp", text(view["view"]), cell::size(view["size"]), text(sample["spp"])),
          .note = "Against exact visibility with the same samples.",
          .header = {"visibility", "s", "of it filling, core-s", "s without filling", "filling rays", "L^INF", "FLIP"}};
      for (const Json& row : sample["rows"])
        table.rows.push_back({text(row["name"]), seconds(row["seconds"]), seconds(row["filling_core_seconds"]),
                              seconds(row["seconds_without_filling"]), text(row["filling_rays"]), percent(row["linf"]),
                              fixed(row["flip"], 4)});
      tables.push_back(std::move(table));
    }
  }
  return tables;
}

BenchTable frame_table(const Json& views) {
  BenchTable table{.title = "Visibility in the frame",
                   .note =
                       "One sample a pixel, all threads: the share of core time that queries take, misses and rays included. The rest is "
                       "eye paths, lights, BSDFs and sums.",
                   .header = {"view", "visibility", "frame, s", "visibility's share", "ns a query", "traced"},
                   .text_columns = 2};
  for (const Json& view : views) {
    for (const Json& row : view["frames"]) {
      const std::string settings = row["settings"].empty() ? "" : ", " + text(row["settings"][0]);
      table.rows.push_back({text(view["view"]), text(row["visibility"]) + settings, seconds(row["frame_seconds"]),
                            percent(row["visibility_share"], 1), fixed(row["ns_per_query"], 1), percent(row["share_traced"])});
    }
  }
  return table;
}

std::vector<BenchTable> lookup_tables(const Json& views) {
  BenchTable costs{.title = "Look-ups and misses",
                   .note =
                       "On one thread, on batches of the view's own picture. A query: keys, hashes, look-ups, everything a hit; a miss: "
                       "what a cold table costs more than a warm one, its ray included. The ray's share is that of as many rays of the "
                       "same batch.",
                   .header = {"view", "look-up", "ns a query", "look-ups a query", "ns a miss", "of it the ray", "misses"},
                   .text_columns = 2};
  BenchTable exact{.title = "Exact visibility beside bare Embree",
                   .note =
                       "Shadow rays of the view's picture on one thread: made from queries and traced; made beforehand and traced through "
                       "the Tracer; the same in bare calls of the fastest style. Kept is the first of the last.",
                   .header = {"view", "exact, Mray/s", "Tracer, Mray/s", "bare, Mray/s", "fastest bare calls", "kept"}};
  for (const Json& view : views) {
    for (const Json& row : view["rows"])
      costs.rows.push_back({text(view["view"]), text(row["name"]), fixed(row["ns_per_query"], 2), fixed(row["lookups_per_query"], 2),
                            fixed(row["ns_per_miss"], 0), fixed(row["ns_per_miss_ray"], 0), text(row["misses"])});
    const Json& e = view["exact"];
    if (!e.contains("exact_mray_per_s")) continue;
    const bool bare = e.contains("bare_mray_per_s");
    exact.rows.push_back({text(view["view"]), fixed(e["exact_mray_per_s"], 1), fixed(e["tracer_mray_per_s"], 1),
                          bare ? fixed(e["bare_mray_per_s"], 1) : "–", bare ? text(e["bare_style"]) : "–",
                          bare ? percent(e["throughput_kept"], 1) : "–"});
  }
  return {costs, exact, frame_table(views)};
}

std::vector<BenchTable> flicker_tables(const Json& views) {
  BenchTable table{
      .title = "Camera move",
      .note = "One sample a pixel. Flicker: with d = cached - exact, the sum of |d_t - d_(t-1)| over that of the exact picture.",
      .header = {"view", "frames", "C_E", "flicker", "mean L^INF", "traced", "exact, frames/s", "cached, frames/s"}};
  for (const Json& view : views)
    table.rows.push_back({text(view["view"]) + ", " + cell::size(view["size"]), text(view["frames"]), fixed(view["ce"], 0),
                          percent(view["flicker"]), percent(view["linf"]), percent(view["share_traced"]),
                          fixed(view["exact_frames_per_second"], 1), fixed(view["cached_frames_per_second"], 1)});
  return {table};
}

std::vector<BenchTable> ablation_tables(const Json& views) {
  BenchTable table{.title = "Ablations",
                   .note = "One sample a pixel, against exact visibility with the same samples.",
                   .header = {"view", "variant", "traced", "L^INF", "bias", "FLIP", "s", "speed-up", "look-ups a query", "other key met"},
                   .text_columns = 2};
  for (const Json& view : views) {
    for (const Json& row : view["rows"])
      table.rows.push_back({fmt::format("{}, C_E = {}", text(view["view"]), fixed(view["ce"], 0)), text(row["name"]),
                            percent(row["share_traced"]), percent(row["linf"]), signed_percent(row["signed_error"]), fixed(row["flip"], 4),
                            seconds(row["seconds"]), fixed(row["speed_up"], 2), fixed(row["lookups_per_query"], 2),
                            percent(row["rejected_share"])});
  }
  return {table};
}

}  // namespace

std::vector<BenchTable> cache_bench_tables(const Json& results, const std::string& part) {
  if (!results.contains(part) || results[part].empty()) return {};
  const Json& views = results[part];
  if (part == "aims") return {aims_table(views)};
  if (part == "curves") return curve_tables(views);
  if (part == "equal_time") return equal_time_tables(views);
  if (part == "shadow_maps") return shadow_map_tables(views);
  if (part == "lookup") return lookup_tables(views);
  if (part == "flicker") return flicker_tables(views);
  return ablation_tables(views);
}

std::string cache_bench_markdown(const Json& results) {
  std::string text;
  for (const char* part : {"aims", "curves", "equal_time", "shadow_maps", "lookup", "flicker", "ablations"}) {
    for (const BenchTable& table : cache_bench_tables(results, part)) text += markdown_table(table);
  }
  return text;
}

}  // namespace sightline
