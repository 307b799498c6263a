#include "methods/fragments/probe_test.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/fragments/blue_noise.h"

namespace sightline {
namespace {

constexpr std::size_t kFragments = 32;  // asked at a time: what they need stays in the L2 cache

}  // namespace

IVec2 probe_pixel(const GBuffer& g, const Fragment& f, int q, int sub) {
  const int half = f.width() / 2;
  int x = f.x + (q & 1 ? half : 0), y = f.y + (q & 2 ? half : 0);
  if (sub < 0) {
    x += half / 2, y += half / 2;
  } else {
    const int quarter = half / 2;
    x += (sub & 1 ? quarter : 0) + quarter / 2, y += (sub & 2 ? quarter : 0) + quarter / 2;
  }
  return {std::min(x, g.width - 1), std::min(y, g.height - 1)};
}

ProbeTest::ProbeTest(const World&, const View& view, Visibility& visibility, std::uint64_t seed)
    : footprint_(view, 1.f),
      camera_(view.pinhole().position),
      orthographic_(view.pinhole().orthographic),
      exact_(visibility.exact()),
      seed_(seed),
      worker_(visibility.worker()) {}

std::uint32_t ProbeTest::set_of(const Fragment& f) const {
  if (points_ && points_->jitter == PointJitter::blue) {
    // The mask twice, far enough apart to have nothing to do with itself.
    constexpr std::uint32_t kShifts = LightPoints::kShifts, kAcross = 23, kDown = 37;
    const std::uint32_t place = pixel_key(seed_ ^ salt_, f.level);
    const std::uint32_t x = (static_cast<std::uint32_t>(f.x) >> f.level) + (place & 0xff);
    const std::uint32_t y = (static_cast<std::uint32_t>(f.y) >> f.level) + (place >> 8 & 0xff);
    const BlueNoise& noise = BlueNoise::shared();
    const auto shift = [&](std::uint32_t rank) { return rank * kShifts / BlueNoise::kCount; };
    return shift(noise.rank(x, y)) + kShifts * shift(noise.rank(x + kAcross, y + kDown));
  }
  const std::uint32_t place = static_cast<std::uint32_t>(f.x) | static_cast<std::uint32_t>(f.y) << 16;
  return hash_combine(pixel_key(seed_ ^ salt_, place), f.level) % LightPoints::kSets;
}

void ProbeTest::set_light(const AreaLight& light, const LightPoints& points) {
  light_ = &light, points_ = &points;
  const std::size_t total = static_cast<std::size_t>(LightPoints::kSets) * points.count;
  queries_.resize_lights(total);
  std::copy_n(points.point.x.data(), total, queries_.light.position.x.data());
  std::copy_n(points.point.y.data(), total, queries_.light.position.y.data());
  std::copy_n(points.point.z.data(), total, queries_.light.position.z.data());
  std::copy_n(points.normal.x.data(), total, queries_.light.normal.x.data());
  std::copy_n(points.normal.y.data(), total, queries_.light.normal.y.data());
  std::copy_n(points.normal.z.data(), total, queries_.light.normal.z.data());
  std::copy_n(points.error.data(), total, queries_.light.error.data());
  std::copy_n(points.area.data(), total, queries_.light.cell_area.data());
  for (std::size_t i = 0; i < total; ++i) queries_.light.id[i] = hash32(static_cast<std::uint32_t>(i) ^ light.members[0].entry << 16);
  std::fill_n(queries_.semantic.data(), total, static_cast<std::uint8_t>(QuerySemantic::surface));
  queries_.kind = BatchKind::shadow;
  queries_.surface_ends = SurfaceEnds::area_light;
}

void ProbeTest::add_eye(const GBuffer& g, IVec2 pixel) {
  const std::size_t at = g.at(pixel.x, pixel.y), to = queries_.eye.size++;
  const Vec3 position = load(g.position, at), normal = load(g.geometric_normal, at);
  float area = 0;
  if (!exact_) area = footprint_.area(orthographic_ ? camera_ : normalize_or(position - camera_, -normal), g.depth[at], normal);
  above_.resize(std::max(above_.size(), queries_.eye.size));
  above_[to] = light_->above(position, normal);
  queries_.eye.set(to, position, normal, g.error[at], area, static_cast<std::uint32_t>(at));
}

// Points of the light below the surface itself are not seen, whatever lies there.
void ProbeTest::add_query(std::size_t query, std::uint32_t eye, std::uint32_t light) {
  const bool seen =
      above_[eye] || glm::dot(load(queries_.light.position, light) - load(queries_.eye.position, eye), load(queries_.eye.normal, eye)) > 0;
  queries_.eye_of[query] = eye, queries_.light_of[query] = seen ? light : kNoQuery;
}

void ProbeTest::ask(PassStatistics& statistics) {
  weights_.resize(std::max(weights_.size(), padded(queries_.size) + kLanes));
  worker_->visible(queries_, weights_, statistics.rays, statistics.visibility);
}

void ProbeTest::count_questions(std::size_t fragment, std::size_t first, std::size_t count) {
  const std::uint32_t* light = queries_.light_of.data() + first;
  asked_[fragment] += static_cast<std::uint32_t>(count) - static_cast<std::uint32_t>(std::count(light, light + count, kNoQuery));
}

void ProbeTest::test(const GBuffer& g, std::span<const Fragment> fragments, std::vector<ProbeMasks>& masks, PassStatistics& statistics) {
  masks.assign(fragments.size(), {});
  asked_.assign(fragments.size(), 0);
  open_.resize(fragments.size());
  std::iota(open_.begin(), open_.end(), 0u);
  const std::uint64_t all = points_->count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << points_->count) - 1;
  if (!sparse_) return ask_some(g, fragments, open_, {all, all, all, all}, masks, statistics);

  // Small fragments ask each point once first, a quarter of them in each quadrant: most see all or nothing of the light.
  ProbeMasks some{}, rest;
  for (std::uint32_t k = 0; k < points_->count; ++k)
    some[static_cast<std::size_t>(sub_probe_of(k, points_->count))] |= std::uint64_t{1} << k;
  for (std::size_t q = 0; q < 4; ++q) rest[q] = all & ~some[q];
  const auto small = [&](std::uint32_t i) { return fragments[i].level <= kSparseLevel; };
  const auto first_small = std::stable_partition(open_.begin(), open_.end(), [&](std::uint32_t i) { return !small(i); });
  small_.assign(first_small, open_.end());
  open_.erase(first_small, open_.end());
  ask_some(g, fragments, open_, {all, all, all, all}, masks, statistics);
  ask_some(g, fragments, small_, some, masks, statistics);
  std::erase_if(small_, [&](std::uint32_t i) {
    ProbeMasks& m = masks[i];
    const bool lit = m == some;
    if (lit) m = {all, all, all, all};
    return lit || (m[0] | m[1] | m[2] | m[3]) == 0;
  });
  ask_some(g, fragments, small_, rest, masks, statistics);
}

// Asks in quadrant q of each listed fragment the points of some[q], and adds what is seen to its masks.
void ProbeTest::ask_some(const GBuffer& g, std::span<const Fragment> fragments, std::span<const std::uint32_t> which,
                         const ProbeMasks& some, std::vector<ProbeMasks>& masks, PassStatistics& statistics) {
  const std::uint32_t rays = points_->count;
  const std::size_t most = 4 * static_cast<std::size_t>(rays);
  for (std::size_t first = 0; first < which.size(); first += kFragments) {
    const std::span chunk = which.subspan(first, std::min(kFragments, which.size() - first));
    queries_.eye.resize(16 * chunk.size());
    queries_.eye.size = 0;
    queries_.resize_queries(most * chunk.size());
    std::size_t query = 0;
    for (const std::uint32_t i : chunk) {
      const Fragment& f = fragments[i];
      const std::uint32_t light = set_of(f) * rays;
      const std::size_t before = query;
      for (int q = 0; q < 4; ++q) {
        const auto eye = static_cast<std::uint32_t>(queries_.eye.size);
        const bool many = f.level >= kManyProbesLevel;
        if (many) {
          for (int sub = 0; sub < 4; ++sub) add_eye(g, probe_pixel(g, f, q, sub));
        } else {
          add_eye(g, probe_pixel(g, f, q));
        }
        for (std::uint64_t left = some[static_cast<std::size_t>(q)]; left != 0; left &= left - 1, ++query) {
          const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
          add_query(query, eye + (many ? static_cast<std::uint32_t>(sub_probe_of(k, rays)) : 0u), light + k);
        }
      }
      if (counts_questions_) count_questions(i, before, query - before);
    }
    queries_.size = query;
    ask(statistics);
    const float* weight = weights_.data();
    for (const std::uint32_t i : chunk) {
      for (std::size_t q = 0; q < 4; ++q) {
        for (std::uint64_t left = some[q]; left != 0; left &= left - 1, ++weight) masks[i][q] |= *weight > 0.5f ? left & (~left + 1) : 0;
      }
    }
  }
}

void ProbeTest::confirm(const GBuffer& g, std::span<const Fragment> fragments, std::uint32_t round, std::vector<std::uint64_t>& masks,
                        PassStatistics& statistics) {
  const std::uint32_t rays = points_->count;
  masks.resize(fragments.size());
  asked_.assign(fragments.size(), 0);
  for (std::size_t first = 0; first < fragments.size(); first += 4 * kFragments) {
    const std::span some = fragments.subspan(first, std::min(4 * kFragments, fragments.size() - first));
    queries_.eye.resize(some.size());
    queries_.eye.size = 0;
    queries_.resize_queries(static_cast<std::size_t>(rays) * some.size());
    std::size_t query = 0;
    for (const Fragment& f : some) {
      const std::uint32_t random = hash_combine(set_of(f) ^ round << 10, static_cast<std::uint32_t>(g.at(f.x, f.y)));
      const std::uint32_t w = static_cast<std::uint32_t>(f.width());
      const IVec2 pixel{std::min(f.x + static_cast<int>(random % w), g.width - 1),
                        std::min(f.y + static_cast<int>((random >> 16) % w), g.height - 1)};
      const auto eye = static_cast<std::uint32_t>(queries_.eye.size);
      add_eye(g, pixel);
      const std::uint32_t light = set_of(f) * rays;
      for (std::uint32_t k = 0; k < rays; ++k, ++query) add_query(query, eye, light + k);
    }
    ask(statistics);
    for (std::size_t i = 0; counts_questions_ && i < some.size(); ++i) count_questions(first + i, i * rays, rays);
    const float* weight = weights_.data();
    for (std::size_t i = 0; i < some.size(); ++i, weight += rays) {
      std::uint64_t mask = 0;
      for (std::uint32_t k = 0; k < rays; ++k) mask |= static_cast<std::uint64_t>(weight[k] > 0.5f) << k;
      masks[first + i] = mask;
    }
  }
}

}  // namespace sightline
