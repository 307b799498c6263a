// The reference beside bare loops that make the same pictures.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/core/stopwatch.h"
#include "bench/median.h"
#include "bench/trace_bench_parts.h"
#include "session/render.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

struct Picture {
  std::string name;
  int spp, light_samples, bounces;
  bool one_hit;
};

/// Call styles are ranked on about so many tiles, spread over the picture, with an eighth of the samples.
constexpr int kRankingTiles = 72;
/// A round that takes longer is not repeated; its samples are then rendered in slices, the two sides by turns.
constexpr double kWholeRoundSeconds = 10;
constexpr int kSlices = 4;

BareResult bare_picture(const Picture& picture, const BareJob& job, SampleRange samples, const BareStyle& style, const Context& context) {
  if (picture.one_hit) return bare_one_hit(job, picture.light_samples, style, context);
  return bare_paths(job, samples, picture.spp, picture.bounces, style, context);
}

struct RankedStyle {
  BareStyle style;
  double seconds = 0;  ///< of all of the picture, estimated
};

/// The fastest calls, found kind by kind.
RankedStyle fastest_style(const Picture& picture, const BareJob& job, bool quick, const Context& context) {
  const int tiles = bare_tile_count(job);
  BareJob part = job;
  // Odd, so that tiles are not taken column by column.
  part.tile_step = std::max(1, tiles / kRankingTiles) | 1;
  Picture fewer = picture;
  fewer.spp = std::max(1, picture.spp / 8), fewer.light_samples = std::min(picture.light_samples, 16);
  RankedStyle best;
  for (CallStyle BareStyle::* kind : {&BareStyle::primary, &BareStyle::shadow, &BareStyle::bounce}) {
    if (picture.one_hit && kind == &BareStyle::bounce) continue;
    const StyleRanking ranking = rank_styles(
        [&](CallStyle style) {
          BareStyle candidate = best.style;
          candidate.*kind = style;
          return bare_picture(fewer, part, {0, static_cast<std::uint32_t>(fewer.spp)}, candidate, context).seconds;
        },
        quick, context);
    best.style.*kind = kCallStyles[ranking.order.front()];
    best.seconds = ranking.seconds[ranking.order.front()];
  }
  best.seconds *= part.tile_step * static_cast<double>(picture.spp * picture.light_samples) / (fewer.spp * fewer.light_samples);
  return best;
}

/// One side of a comparison, summed over slices of the samples.
struct Side {
  double seconds = 0, mean = 0;
  std::uint64_t rays = 0;
};

Side product_slice(const Picture& picture, const TraceStage& stage, SampleRange samples, const Context& context) {
  RenderRequest request;
  request.spp = picture.spp, request.max_bounces = picture.bounces, request.light_samples = picture.light_samples;
  request.sample_range = samples;
  request.settings = {"roulette_start=1000000", picture.one_hit ? "mode=one-hit" : "mode=path"};
  request.wants_identity = false;
  const RenderResult result =
      render(stage.world, stage.camera, stage.size_px, PixelFilter(PixelFilter::Kind::box), request, context, Stopwatch());
  if (result.stop == StopReason::interrupted) context.check_cancelled();
  const double share = static_cast<double>(samples.count()) / picture.spp;
  return {result.seconds.render, share * result.frame.mean_luminance(), result.statistics.rays.closest + result.statistics.rays.occlusion};
}

Side bare_slice(const Picture& picture, const TraceStage& stage, SampleRange samples, const BareStyle& style, const Context& context) {
  context.check_cancelled();
  const BareResult result = bare_picture(picture, stage.job, samples, style, context);
  return {result.seconds, result.sum / (static_cast<double>(stage.size_px.x) * stage.size_px.y), result.rays};
}

void add(Side& side, const Side& slice) { side.seconds += slice.seconds, side.mean += slice.mean, side.rays += slice.rays; }

Json compare_picture(const Picture& picture, const TraceStage& stage, const TraceBenchOptions& options, const Context& context) {
  context.info(fmt::format("bench trace: {}, {}: bare call styles", stage.name, picture.name));
  const RankedStyle best = fastest_style(picture, stage.job, options.quick, context);
  const bool cheap = 2.2 * best.seconds <= kWholeRoundSeconds;
  const int rounds = options.rounds > 0 ? options.rounds : options.quick || !cheap ? 1 : 3;
  const auto slices = static_cast<std::uint32_t>(cheap ? 1 : std::min(kSlices, picture.spp));
  context.info(fmt::format("bench trace: {}, {}: {} round{}, about {:.0f} s", stage.name, picture.name, rounds, rounds == 1 ? "" : "s",
                           2.2 * rounds * best.seconds));
  std::vector<double> product_seconds, bare_seconds;
  Side product, bare;
  std::uint32_t turn = 0;
  for (int round = 0; round < rounds; ++round) {
    product = bare = {};
    for (std::uint32_t slice = 0; slice < slices; ++slice) {
      const auto spp = static_cast<std::uint32_t>(picture.spp);
      const SampleRange samples{spp * slice / slices, spp * (slice + 1) / slices};
      const bool bare_first = turn++ % 2 == 1;
      if (bare_first) add(bare, bare_slice(picture, stage, samples, best.style, context));
      add(product, product_slice(picture, stage, samples, context));
      if (!bare_first) add(bare, bare_slice(picture, stage, samples, best.style, context));
    }
    product_seconds.push_back(product.seconds), bare_seconds.push_back(bare.seconds);
  }
  const double ours = median(product_seconds), theirs = median(bare_seconds), cores = context.thread_count();
  return {
      {"picture", picture.name},
      {"product_seconds", ours},
      {"bare_seconds", theirs},
      {"time_ratio", ours / theirs},
      {"product_mray_per_core_s", static_cast<double>(product.rays) * 1e-6 / ours / cores},
      {"bare_mray_per_core_s", static_cast<double>(bare.rays) * 1e-6 / theirs / cores},
      {"product_rays", product.rays},
      {"bare_rays", bare.rays},
      {"product_mean", product.mean},
      {"bare_mean", bare.mean},
      {"rounds", rounds},
      {"slices", slices},
      {"bare_styles", {{"primary", text(best.style.primary)}, {"shadow", text(best.style.shadow)}, {"bounce", text(best.style.bounce)}}}};
}

}  // namespace

void trace_pictures(const TraceStage& stage, const TraceBenchOptions& options, Json& rows, const Context& context) {
  for (const Picture& picture : {Picture{"1 hit + 64 light samples", 1, 64, 0, true},
                                 Picture{"64 samples, 1 light sample, MIS", options.quick ? 8 : 64, 1, 0, false},
                                 Picture{"16 samples, 4 bounces", options.quick ? 2 : 16, 1, 4, false}})
    rows.push_back(compare_picture(picture, stage, options, context));
}

}  // namespace sightline
