#include "methods/fragments/finest_test.h"

#include <algorithm>
#include <numeric>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/fragments/unshadowed.h"

namespace sightline {
namespace {

constexpr std::size_t kLanesAtOnce = 1024;

}  // namespace

FinestTest::FinestTest(const World& world, const View& view, Visibility& visibility, const FinestOptions& options, std::uint64_t seed)
    : world_(world),
      options_(options),
      footprint_(view, 1.f),
      camera_(view.pinhole().position),
      orthographic_(view.pinhole().orthographic),
      exact_(visibility.exact()),
      seed_(seed),
      worker_(visibility.worker()) {}

void FinestTest::test(const GBuffer& g, const AreaLight& light, std::span<const std::uint32_t> pixels, std::uint32_t sample,
                      std::uint32_t rays, int channels, std::array<std::vector<float>, 3>& values, PassStatistics& statistics) {
  const bool ratio = channels == 1;
  for (int c = 0; c < channels; ++c) values[static_cast<std::size_t>(c)].resize(pixels.size());
  sums_.assign(pixels.size(), {});
  open_.resize(pixels.size());
  std::iota(open_.begin(), open_.end(), 0u);
  const std::uint32_t first = options_.early_out ? std::max(rays / 4, 16u) : rays;
  trace(g, light, pixels, open_, sample, rays, 0, std::min(first, rays), ratio, statistics);
  if (first < rays) {
    close_saturated(g, pixels);
    trace(g, light, pixels, open_, sample, rays, first, rays - first, ratio, statistics);
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Sums& s = sums_[i];
    if (ratio) {
      values[0][i] = s.seen == 0 ? 0.f : s.seen == s.asked ? 1.f : s.visible / s.all;
      continue;
    }
    // Those that stopped early have a quarter of the samples.
    const float scale = static_cast<float>(rays) / static_cast<float>(first);
    const bool stopped = first < rays && (s.seen == 0 || s.seen == s.asked) && !std::binary_search(open_.begin(), open_.end(), i);
    for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(c)][i] = s.irradiance[c] * (stopped ? scale : 1.f);
  }
}

// Pixels whose first rays agree are done, but for those beside others in penumbra: there, all or nothing is mostly chance.
void FinestTest::close_saturated(const GBuffer& g, std::span<const std::uint32_t> pixels) {
  const auto saturated = [&](std::uint32_t i) { return sums_[i].seen == 0 || sums_[i].seen == sums_[i].asked; };
  mixed_.resize(g.element_count());
  for (const std::uint32_t i : open_) mixed_[pixels[i]] = !saturated(i);
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
  const std::size_t before = open_.size();
  closed_.clear();
  for (std::size_t k = 0; k < before; ++k) {
    if (saturated(open_[k]) && !beside_mixed(open_[k])) closed_.push_back(open_[k]);
  }
  for (const std::uint32_t i : open_) mixed_[pixels[i]] = 0;
  std::erase_if(open_, [&](std::uint32_t i) { return std::binary_search(closed_.begin(), closed_.end(), i); });
}

void FinestTest::trace(const GBuffer& g, const AreaLight& light, std::span<const std::uint32_t> pixels,
                       std::span<const std::uint32_t> which, std::uint32_t sample, std::uint32_t rays, std::uint32_t first,
                       std::uint32_t count, bool ratio, PassStatistics& statistics) {
  const std::size_t at_once = std::max<std::size_t>(kLanesAtOnce / count, 1), lanes = at_once * count;
  position_.resize(lanes), key_.resize(padded(lanes)), index_.resize(padded(lanes)), entry_.resize(padded(lanes));
  for (auto* numbers : {&u0_, &u1_, &selection_, &term_, &weights_}) numbers->resize(padded(lanes) + kLanes);
  queries_.resize_lights(lanes);
  light_.resize(lanes + kLanes), queries_.light.resize(lanes + kLanes);
  std::fill_n(queries_.semantic.data(), lanes, static_cast<std::uint8_t>(QuerySemantic::surface));
  queries_.kind = BatchKind::shadow;
  queries_.surface_ends = SurfaceEnds::area_light;
  const auto stride = static_cast<std::uint32_t>(g.stride);
  for (std::size_t begin = 0; begin < which.size(); begin += at_once) {
    const std::size_t points = std::min(at_once, which.size() - begin), n = points * count;
    queries_.eye.resize(points);
    for (std::size_t p = 0; p < points; ++p) {
      const std::uint32_t at = pixels[which[begin + p]];
      const std::uint32_t x = at % stride, y = at / stride;
      const Vec3 position = load(g.position, at), normal = load(g.geometric_normal, at);
      float area = 0;
      if (!exact_) area = footprint_.area(orthographic_ ? camera_ : normalize_or(position - camera_, -normal), g.depth[at], normal);
      queries_.eye.set(p, position, normal, g.error[at], area, at);
      std::fill_n(key_.data() + p * count, count, pixel_key(seed_, y * static_cast<std::uint32_t>(g.width) + x));
      std::iota(index_.data() + p * count, index_.data() + (p + 1) * count, sample * rays + first);
      fill(position_, p * count, count, position);
    }
    sobol_2d(key_.data(), index_.data(), dimension::pair_of(0, dimension::kLightPoint), n, u0_.data(), u1_.data());
    for (std::size_t i = 0; i < n; ++i) {
      const AreaLight::Member& member = light.members[light.pick(u0_[i])];
      entry_[i] = member.entry, selection_[i] = member.probability * static_cast<float>(rays);
    }
    world_.lights().sample_entries(entry_, selection_, position_, u0_, u1_, n, light_);

    queries_.resize_queries(n);
    for (std::size_t p = 0; p < points; ++p) {
      const std::uint32_t at = pixels[which[begin + p]];
      const Receiver receiver = receiver_at(g, static_cast<int>(at % stride), static_cast<int>(at / stride));
      const FinestRun run{receiver.shading_normal, receiver.geometric_normal, light_, p * count, count};
      FinestTerms terms = finest_terms(run, ratio, term_.data(), queries_.light_of.data());
      if (receiver.glossy && ratio) terms = weigh_by_lobe(receiver, run);
      Sums& sums = sums_[which[begin + p]];
      sums.all += terms.all, sums.asked += terms.asked;
      std::fill_n(queries_.eye_of.data() + p * count, count, static_cast<std::uint32_t>(p));
    }
    // The ends are the samples themselves: arrays change hands instead of being copied.
    std::swap(queries_.light.position, light_.point), std::swap(queries_.light.normal, light_.normal);
    std::swap(queries_.light.error, light_.point_error);
    queries_.light.size = n;
    if (!exact_) {
      for (std::size_t i = 0; i < n; ++i)
        queries_.light.id[i] = index_[i], queries_.light.cell_area[i] = world_.lights().area(entry_[i]) / selection_[i];
    }
    worker_->visible(queries_, weights_, statistics.rays, statistics.visibility);
    for (std::size_t p = 0; p < points; ++p) {
      const FinestSum sum = finest_sum({Vec3(0), Vec3(0), light_, p * count, count}, !ratio, term_.data(), weights_.data());
      Sums& sums = sums_[which[begin + p]];
      sums.seen += sum.seen, sums.visible += sum.visible, sums.irradiance += sum.irradiance;
    }
  }
}

// Surfaces with a lobe: samples count by what they contribute there.
FinestTerms FinestTest::weigh_by_lobe(const Receiver& receiver, const FinestRun& run) {
  FinestTerms terms;
  for (std::size_t i = run.first; i < run.first + run.count; ++i) {
    if (term_[i] > 0) term_[i] *= lobe_weight(receiver, load(light_.wi, i));
    if (!(term_[i] > 0)) queries_.light_of[i] = kNoQuery;
    terms.all += term_[i], terms.asked += term_[i] > 0;
  }
  return terms;
}

}  // namespace sightline
