#include "bench/bench_shot.h"

#include <fmt/format.h>

#include <utility>

#include "bench/median.h"

namespace sightline {
namespace {

constexpr double kCheapRoundSeconds = 10;

RenderResult render_view(const BuiltView& view, const RenderRequest& request, const Context& context) {
  RenderResult result =
      render(view.world, view.camera, view.size_px, PixelFilter(PixelFilter::Kind::gaussian), request, context, Stopwatch());
  if (result.stop == StopReason::interrupted) context.check_cancelled();
  return result;
}

}  // namespace

std::optional<BuiltView> load_built_view(const std::string& name, const std::filesystem::path& data, std::optional<IVec2> size_px,
                                         bool quick, const Context& context) {
  std::optional<BenchView> loaded = load_bench_view(name, data, context);
  if (!loaded) {
    context.warn(fmt::format("{}: its files are not below the data folder (--data or SIGHTLINE_DATA); left out", name));
    return std::nullopt;
  }
  const IVec2 size = size_px.value_or(quick ? loaded->size_px / 8 : loaded->size_px);
  return BuiltView{name, World::build(std::move(loaded->scene), {}, context), loaded->camera, size};
}

Shot shoot(const BuiltView& view, const RenderRequest& request, const Context& context) {
  RenderRequest wanted = request;
  wanted.wants_identity = false;
  RenderResult result = render_view(view, wanted, context);
  return {std::move(result.frame).color_image(), result.seconds.render, result.statistics, result.seconds.prepare};
}

std::vector<Shot> shoot_by_turns(std::size_t count, int rounds, const std::function<Shot(std::size_t)>& picture) {
  std::vector<Shot> shots;
  std::vector<std::vector<double>> seconds(count);
  double first_round = 0;
  for (std::size_t i = 0; i < count; ++i) {
    shots.push_back(picture(i));
    seconds[i].push_back(shots.back().seconds);
    first_round += shots.back().seconds;
  }
  const int all = rounds > 0 ? rounds : first_round < kCheapRoundSeconds ? 3 : 1;
  for (int round = 1; round < all; ++round) {
    for (std::size_t i = 0; i < count; ++i) seconds[i].push_back(picture(i).seconds);
  }
  for (std::size_t i = 0; i < count; ++i) shots[i].seconds = median(seconds[i]);
  return shots;
}

std::vector<std::uint8_t> surface_mask(const BuiltView& view, RenderRequest request, const Context& context) {
  request.aovs.add(Aov::surface);
  const RenderResult result = render_view(view, request, context);
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(view.size_px.x) * static_cast<std::size_t>(view.size_px.y));
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = result.frame.value(Aov::surface, static_cast<std::uint32_t>(i)).x > 0.999f;
  return mask;
}

}  // namespace sightline
