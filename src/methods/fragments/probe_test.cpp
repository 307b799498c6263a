#include "methods/fragments/probe_test.h"

#include <algorithm>

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

void ProbeTest::count_questions(std::size_t fragments, std::size_t questions_each) {
  for (std::size_t i = 0; i < fragments; ++i) {
    const std::uint32_t* first = queries_.light_of.data() + i * questions_each;
    const auto left_out = std::count(first, first + questions_each, kNoQuery);
    asked_.push_back(static_cast<std::uint32_t>(questions_each) - static_cast<std::uint32_t>(left_out));
  }
}

void ProbeTest::test(const GBuffer& g, std::span<const Fragment> fragments, std::vector<ProbeMasks>& masks, PassStatistics& statistics) {
  const std::uint32_t rays = points_->count;
  masks.resize(fragments.size());
  asked_.clear();
  for (std::size_t first = 0; first < fragments.size(); first += kFragments) {
    const std::span some = fragments.subspan(first, std::min(kFragments, fragments.size() - first));
    queries_.eye.resize(16 * some.size());
    queries_.eye.size = 0;
    queries_.resize_queries(4 * static_cast<std::size_t>(rays) * some.size());
    std::size_t query = 0;
    for (const Fragment& f : some) {
      const std::uint32_t light = set_of(f) * rays;
      for (int q = 0; q < 4; ++q) {
        const auto eye = static_cast<std::uint32_t>(queries_.eye.size);
        if (f.level < kManyProbesLevel) {
          add_eye(g, probe_pixel(g, f, q));
          for (std::uint32_t k = 0; k < rays; ++k, ++query) add_query(query, eye, light + k);
        } else {
          for (int sub = 0; sub < 4; ++sub) add_eye(g, probe_pixel(g, f, q, sub));
          for (std::uint32_t k = 0; k < rays; ++k, ++query)
            add_query(query, eye + static_cast<std::uint32_t>(sub_probe_of(k, rays)), light + k);
        }
      }
    }
    ask(statistics);
    if (counts_questions_) count_questions(some.size(), 4 * static_cast<std::size_t>(rays));
    const float* weight = weights_.data();
    for (std::size_t i = 0; i < some.size(); ++i) {
      for (std::uint64_t& mask : masks[first + i]) {
        mask = 0;
        for (std::uint32_t k = 0; k < rays; ++k) mask |= static_cast<std::uint64_t>(weight[k] > 0.5f) << k;
        weight += rays;
      }
    }
  }
}

void ProbeTest::confirm(const GBuffer& g, std::span<const Fragment> fragments, std::uint32_t round, std::vector<std::uint64_t>& masks,
                        PassStatistics& statistics) {
  const std::uint32_t rays = points_->count;
  masks.resize(fragments.size());
  asked_.clear();
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
    if (counts_questions_) count_questions(some.size(), rays);
    const float* weight = weights_.data();
    for (std::size_t i = 0; i < some.size(); ++i, weight += rays) {
      std::uint64_t mask = 0;
      for (std::uint32_t k = 0; k < rays; ++k) mask |= static_cast<std::uint64_t>(weight[k] > 0.5f) << k;
      masks[first + i] = mask;
    }
  }
}

}  // namespace sightline
