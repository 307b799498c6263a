#include "methods/fragments/edge_pass.h"

#include <algorithm>
#include <numeric>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"

namespace sightline {
namespace {

constexpr std::uint32_t kKey = 0xed6e5u;  // sequences of their own
constexpr std::size_t kMostSamples = 16;

View with_filter(const View& view) {
  const bool centre = view.filter().kind() == PixelFilter::Kind::centre;
  return View(view.camera(), IVec2(view.width(), view.height()), centre ? PixelFilter(PixelFilter::Kind::box) : view.filter());
}

}  // namespace

EdgePass::EdgePass(const RenderJob& job, const View& view, const FragmentOptions& options, const Context& context,
                   CameraPass::Sampling sampling)
    : job_(job),
      picture_(view),
      view_(with_filter(view)),
      options_(options),
      seed_(context.seed),
      sampling_(sampling),
      samples_(static_cast<std::size_t>(options.edge_samples)),
      workers_(static_cast<std::size_t>(context.thread_count())) {
  for (Worker& worker : workers_) worker.composer.set_glossy_term(options_.glossy);
}

void EdgePass::begin(const GBuffer& g) { found_.resize(g.root_count()); }

void EdgePass::find(const GBuffer& g, std::size_t root) {
  found_[root].clear();
  edge_pixels(g, g.root(root), options_.geometry, found_[root]);
}

void EdgePass::gather() {
  pixels_.clear(), begin_.clear();
  for (const std::vector<std::uint32_t>& found : found_) {
    begin_.push_back(pixels_.size());
    pixels_.insert(pixels_.end(), found.begin(), found.end());
  }
  begin_.push_back(pixels_.size());
  const std::size_t tiles = (point_count() + kPerTile - 1) / kPerTile;
  points_.resize(kRootSize, static_cast<int>(tiles) * kRootSize);
  radiance_.resize(points_.element_count());
  neighbour_.resize(points_.element_count());
  for (AlignedVector<float>& channel : signal_) channel.resize(points_.element_count());
}

// Points fill blocks of 4 x 4 elements, as CameraPass does it.
std::size_t EdgePass::element_of(std::size_t point) const {
  const int lane = static_cast<int>(point % kLanes), block = static_cast<int>(point % kPerTile / kLanes);
  const int row = static_cast<int>(point / kPerTile) * kRootSize;
  return points_.at(CameraPass::block_x(block) + CameraPass::lane_x(lane), row + CameraPass::block_y(block) + CameraPass::lane_y(lane));
}

// Stratified points of each pixel, but for that in whose stratum the pixel's own sample lies.
void EdgePass::place(const GBuffer& g, std::size_t first, std::size_t count, std::uint32_t sample, std::vector<CameraPlace>& places) const {
  alignas(kCacheLine) std::array<std::uint32_t, kMostSamples> key, index;
  alignas(kCacheLine) std::array<float, kMostSamples> u, v;
  const bool centred = picture_.filter().kind() == PixelFilter::Kind::centre;
  const auto stride = static_cast<std::uint32_t>(g.stride);
  places.clear();
  for (std::size_t point = first; point < first + count;) {
    const std::uint32_t at = pixel_of(point);
    const std::uint32_t pixel = at / stride * static_cast<std::uint32_t>(g.width) + at % stride;
    const std::uint32_t own_key = pixel_key(seed_, pixel), edge_key = hash_combine(own_key, kKey);
    const Vec2 own = centred ? Vec2(0.5f) : sobol_2d(own_key, sample, dimension::kPixel);
    key.fill(edge_key);
    std::iota(index.begin(), index.end(), sample * static_cast<std::uint32_t>(samples_));
    sobol_2d(key.data(), index.data(), dimension::kPixel, kMostSamples, u.data(), v.data());
    const auto distance = [&](std::size_t i) { return glm::length(Vec2(u[i], v[i]) - own); };
    std::size_t dropped = 0;
    for (std::size_t i = 1; i < samples_; ++i) dropped = distance(i) < distance(dropped) ? i : dropped;
    // A tile of points may begin or end within a pixel.
    const std::size_t skipped = point % points_per_pixel();
    std::size_t nth = 0;
    for (std::size_t i = 0; i < samples_ && point < first + count; ++i) {
      if (i == dropped || nth++ < skipped) continue;
      places.push_back({pixel, index[i], hash_combine(edge_key, static_cast<std::uint32_t>(i)), u[i], v[i]});
      ++point;
    }
  }
}

void EdgePass::trace(const GBuffer& g, std::size_t tile, std::uint32_t sample, std::size_t thread, PassStatistics& statistics) {
  Worker& worker = workers_[thread];
  if (!worker.camera)
    worker.camera =
        std::make_unique<CameraPass>(*job_.world, view_, seed_, static_cast<int>(options_.finest.rays), sampling_, job_.visibility);
  const std::size_t first = tile * kPerTile, count = std::min(kPerTile, point_count() - first);
  place(g, first, count, sample, worker.places);
  worker.camera->render(worker.places, tile, static_cast<std::uint32_t>(g.root_count() + tile), points_, radiance_, statistics);
  for (std::size_t point = first; point < first + count; ++point) {
    const std::size_t at = element_of(point);
    const bool interpolated = points_.kind[at] == PixelKind::diffuse || points_.kind[at] == PixelKind::analytic;
    neighbour_[at] = interpolated ? same_surface_near(g, pixel_of(point), points_, at) : kNoPixel;
  }
  statistics.method_statistics["edge_points"] += static_cast<double>(count);
}

void EdgePass::light(const GBuffer& g, const Lit& lit, std::size_t tile, std::uint32_t sample, std::size_t thread,
                     PassStatistics& statistics) {
  Worker& worker = workers_[thread];
  const auto channels = static_cast<std::size_t>(lit.signal.channels);
  const std::size_t first = tile * kPerTile, count = std::min(kPerTile, point_count() - first);
  for (std::size_t c = 0; c < channels; ++c) std::fill_n(signal_[c].data() + tile * kPerTile, kPerTile, 0.f);
  worker.unknown.clear();
  for (std::size_t point = first; point < first + count; ++point) {
    const std::size_t at = element_of(point);
    if (points_.kind[at] != PixelKind::diffuse && points_.kind[at] != PixelKind::analytic) continue;
    const std::uint32_t from = neighbour_[at];
    // The visible share of a light that a neighbour faces away from is not known.
    if (from != kNoPixel && !(channels == 1 && (lit.signal.flags[from] & LightSignal::kUnlit))) {
      for (std::size_t c = 0; c < channels; ++c) signal_[c][at] = lit.pixels[c][from];
      continue;
    }
    const Vec3 position = load(points_.position, at);
    if (lit.light.out_of_reach(position, load(points_.geometric_normal, at)) ||
        lit.light.out_of_reach(position, load(points_.shading_normal, at)))
      continue;
    worker.unknown.push_back(static_cast<std::uint32_t>(at));
  }
  if (!worker.unknown.empty()) {
    if (!worker.finest)
      worker.finest = std::make_unique<FinestTest>(*job_.world, view_, *job_.visibility, options_.finest, hash_combine(kKey, 0) ^ seed_);
    worker.finest->begin(static_cast<std::uint32_t>(g.root_count() + tile));
    const std::uint64_t before = statistics.rays.occlusion;
    worker.finest->test(points_, lit.light, worker.unknown, sample, options_.finest.rays, lit.signal.channels, worker.values, statistics);
    statistics.method_statistics["edge_rays"] += static_cast<double>(statistics.rays.occlusion - before);
    statistics.method_statistics["edge_tests"] += static_cast<double>(worker.unknown.size());
    for (std::size_t i = 0; i < worker.unknown.size(); ++i) {
      for (std::size_t c = 0; c < channels; ++c) signal_[c][worker.unknown[i]] = worker.values[c][i];
    }
  }
  const std::array<const float*, 3> signal = {signal_[0].data(), signal_[1].data(), signal_[2].data()};
  worker.composer.add(points_, points_.root(tile), lit.light, std::span<const float* const>(signal.data(), channels), radiance_);
}

void EdgePass::average(std::size_t root, Vec3Batch& radiance) const {
  for (std::size_t i = begin_[root]; i < begin_[root + 1]; ++i) {
    Color sum = load(radiance, pixels_[i]);
    for (std::size_t k = 0; k < points_per_pixel(); ++k) sum += load(radiance_, element_of(i * points_per_pixel() + k));
    store(radiance, pixels_[i], sum / static_cast<float>(samples_));
  }
}

}  // namespace sightline
