#include "methods/fragments/finest_test.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/math/vec3_batch.h"
#include "methods/fragments/unshadowed.h"

namespace sightline {
namespace {

constexpr std::size_t kLanesAtOnce = 1024;
// What is known is not used where it changes by more than this from pixel to pixel: each picture would blur it.
constexpr float kSteepPrior = 0.03f;
// Nor if the first rays contradict it: by more than their noise, or at all where nothing but all or nothing is known.
constexpr float kPriorNoise = 0.2f;

}  // namespace

FinestTest::FinestTest(const World& world, const View& view, Visibility& visibility, const FinestOptions& options, std::uint64_t seed)
    : world_(world),
      options_(options),
      footprint_(view, 1.f),
      camera_(view.pinhole().position),
      orthographic_(view.pinhole().orthographic),
      exact_(visibility.exact()),
      worker_(visibility.worker()),
      points_(seed) {
  queries_.kind = BatchKind::shadow;
  queries_.surface_ends = SurfaceEnds::area_light;
}

void FinestTest::test(const GBuffer& g, const AreaLight& light, std::span<const std::uint32_t> pixels, std::uint32_t sample,
                      std::uint32_t rays, int channels, std::array<std::vector<float>, 3>& values, PassStatistics& statistics) {
  const bool ratio = channels == 1;
  for (int c = 0; c < channels; ++c) values[static_cast<std::size_t>(c)].resize(pixels.size());
  sums_.assign(pixels.size(), {});
  if (pixels.empty()) return;
  const std::uint32_t whole = std::max(std::max(options_.rays, options_.smooth_rays), rays);
  points_.make(world_.lights(), light, sample, whole, queries_);
  open_.resize(pixels.size());
  std::iota(open_.begin(), open_.end(), 0u);
  const std::uint32_t first = std::min(options_.early_out || prior_ ? std::max(rays / 4, 16u) : rays, rays);
  known_.assign(pixels.size(), static_cast<std::uint8_t>(std::min(rays, 255u)));
  const bool with_prior = prior_ && ratio;
  kept_ = 0, penumbra_.clear();
  if (with_prior) take_prior(g, pixels, rays, values[0]);
  trace(g, pixels, open_, 0, first, ratio, statistics);
  if (!ratio) {
    // Pixels that stop early have a quarter of the samples.
    const float scale = static_cast<float>(whole) / static_cast<float>(first);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(c)][i] = sums_[i].irradiance[c] * scale;
    }
  }
  if (with_prior) blend_prior(pixels, first, rays, values[0]);
  if (first < rays) {
    if (options_.early_out) close_saturated(g, pixels, first);
    trace(g, pixels, open_, first, rays - first, ratio, statistics);
  }
  if (ratio) {
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (with_prior && prior_values_[i].rays > 0) continue;
      const Sums& s = sums_[i];
      values[0][i] = s.seen == 0 ? 0.f : s.seen == s.asked ? 1.f : s.visible / s.all;
    }
    return;
  }
  const float scale = static_cast<float>(whole) / static_cast<float>(rays);
  for (const std::uint32_t i : open_) {
    for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(c)][i] = sums_[i].irradiance[c] * scale;
  }
}

// Pixels of which enough is known take it, but for those whose turn it is to trace rays.
void FinestTest::take_prior(const GBuffer& g, std::span<const std::uint32_t> pixels, std::uint32_t rays, std::vector<float>& values) {
  prior_values_.resize(pixels.size());
  std::erase_if(open_, [&](std::uint32_t i) {
    PriorShares::Value& prior = prior_values_[i] = prior_->at(g, pixels[i]);
    if (prior.spread > kSteepPrior) prior.rays = 0;
    const float enough = static_cast<float>(prior.saturated() ? std::min(rays, 16u) : rays);
    if (!(prior.rays >= enough) || prior_->is_due(pixels[i])) return false;
    values[i] = prior.share, known_[i] = static_cast<std::uint8_t>(prior.rays);
    if (!prior.saturated()) penumbra_.push_back(pixels[i]);
    ++kept_;
    return true;
  });
}

// Pixels whose first rays agree with what is known are done, with the mean of both.
void FinestTest::blend_prior(std::span<const std::uint32_t> pixels, std::uint32_t first, std::uint32_t rays, std::vector<float>& values) {
  std::erase_if(open_, [&](std::uint32_t i) {
    PriorShares::Value& prior = prior_values_[i];
    if (!(prior.rays > 0)) return false;
    const Sums& s = sums_[i];
    const float own = s.seen == 0 ? 0.f : s.seen == s.asked ? 1.f : s.visible / s.all;
    if (prior.saturated() ? own != prior.share : std::fabs(own - prior.share) > kPriorNoise) {
      prior.rays = 0;
      return false;
    }
    const float known = std::min(prior.rays, static_cast<float>(rays)), added = static_cast<float>(first);
    values[i] = prior.saturated() ? own : (known * prior.share + added * own) / (known + added);
    known_[i] = static_cast<std::uint8_t>(std::min(known + added, 255.f));
    if (!prior.saturated()) penumbra_.push_back(pixels[i]);
    return true;
  });
}

// Pixels whose first rays agree are done, but for those beside others in penumbra: there, all or nothing is mostly chance.
void FinestTest::close_saturated(const GBuffer& g, std::span<const std::uint32_t> pixels, std::uint32_t first) {
  const auto saturated = [&](std::uint32_t i) { return sums_[i].seen == 0 || sums_[i].seen == sums_[i].asked; };
  mixed_.resize(g.element_count());
  for (const std::uint32_t i : open_) mixed_[pixels[i]] = !saturated(i);
  for (const std::uint32_t pixel : penumbra_) mixed_[pixel] = 1;
  const auto stride = static_cast<std::ptrdiff_t>(g.stride), count = static_cast<std::ptrdiff_t>(g.element_count());
  const auto beside_mixed = [&](std::uint32_t i) {
    for (std::ptrdiff_t dy = -1; dy <= 1; ++dy) {
      for (std::ptrdiff_t dx = -1; dx <= 1; ++dx) {
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(pixels[i]) + dy * stride + dx;
        if (at >= 0 && at < count && mixed_[static_cast<std::size_t>(at)]) return true;
      }
    }
    return false;
  };
  std::erase_if(open_, [&](std::uint32_t i) {
    const bool done = saturated(i) && !beside_mixed(i);
    if (done) known_[i] = static_cast<std::uint8_t>(std::min(first, 255u));
    return done;
  });
  for (const std::uint32_t i : open_) mixed_[pixels[i]] = 0;
  for (const std::uint32_t pixel : penumbra_) mixed_[pixel] = 0;
}

// Every packet of rays is of one pixel, which is kind to the tracer.
void FinestTest::trace(const GBuffer& g, std::span<const std::uint32_t> pixels, std::span<const std::uint32_t> which, std::uint32_t first,
                       std::uint32_t count, bool ratio, PassStatistics& statistics) {
  const std::size_t at_once = std::max<std::size_t>(kLanesAtOnce / count, 1);
  for (auto* numbers : {&term_, &weights_}) numbers->resize(padded(at_once * count) + kLanes);
  const auto stride = static_cast<std::uint32_t>(g.stride), width = static_cast<std::uint32_t>(g.width);
  for (std::size_t begin = 0; begin < which.size(); begin += at_once) {
    const std::size_t points = std::min(at_once, which.size() - begin);
    queries_.eye.resize(points);
    queries_.resize_queries(points * count + kLanes);
    queries_.size = points * count;
    runs_.clear();
    for (std::size_t p = 0; p < points; ++p) {
      const std::uint32_t at = pixels[which[begin + p]], x = at % stride, y = at / stride;
      const Vec3 position = load(g.position, at), normal = load(g.geometric_normal, at);
      float area = 0;
      if (!exact_) area = footprint_.area(orthographic_ ? camera_ : normalize_or(position - camera_, -normal), g.depth[at], normal);
      queries_.eye.set(p, position, normal, g.error[at], area, at);
      std::fill_n(queries_.eye_of.data() + p * count, count, static_cast<std::uint32_t>(p));

      const std::size_t from = points_.first(y * width + x) + first;
      runs_.push_back({position, load(g.shading_normal, at), normal, points_, queries_.light, from, count, p * count});
      FinestTerms terms = finest_terms(runs_.back(), ratio, term_.data(), queries_.light_of.data());
      if (ratio && g.kind[at] == PixelKind::analytic)
        terms = weigh_by_lobe(receiver_at(g, static_cast<int>(x), static_cast<int>(y)), runs_.back());
      Sums& sums = sums_[which[begin + p]];
      sums.all += terms.all, sums.asked += terms.asked;
    }
    worker_->visible(queries_, weights_, statistics.rays, statistics.visibility);
    for (std::size_t p = 0; p < points; ++p) {
      const FinestSum sum = finest_sum(runs_[p], !ratio, term_.data(), weights_.data());
      Sums& sums = sums_[which[begin + p]];
      sums.seen += sum.seen, sums.visible += sum.visible, sums.irradiance += sum.irradiance;
    }
  }
}

// Surfaces with a lobe: samples count by what they contribute there.
FinestTerms FinestTest::weigh_by_lobe(const Receiver& receiver, const FinestRun& run) {
  FinestTerms terms;
  for (std::size_t k = 0; k < run.count; ++k) {
    const std::size_t lane = run.lane + k;
    if (term_[lane] > 0)
      term_[lane] *= lobe_weight(receiver, glm::normalize(load(queries_.light.position, run.first + k) - receiver.position));
    if (!(term_[lane] > 0)) queries_.light_of[lane] = kNoQuery;
    terms.all += term_[lane], terms.asked += term_[lane] > 0;
  }
  return terms;
}

}  // namespace sightline
