#include "methods/fragments/centre_test.h"

#include <algorithm>

#include "base/math/vec3_batch.h"

namespace sightline {
namespace {

constexpr std::size_t kAtOnce = 32;

}  // namespace

CentreTest::CentreTest(const View& view, Visibility& visibility)
    : footprint_(view, 1.f),
      camera_(view.pinhole().position),
      orthographic_(view.pinhole().orthographic),
      exact_(visibility.exact()),
      worker_(visibility.worker()) {}

void CentreTest::set_light(const AreaLight& light, const LightPoints& points) {
  light_ = &light;
  queries_.resize_lights(points.count);
  for (std::uint32_t k = 0; k < points.count; ++k)
    queries_.light.set(k, load(points.point, k), load(points.normal, k), points.error[k], points.area[k], k);
  std::fill_n(queries_.semantic.data(), points.count, static_cast<std::uint8_t>(QuerySemantic::surface));
  queries_.kind = BatchKind::shadow;
  queries_.surface_ends = SurfaceEnds::area_light;
}

void CentreTest::test(const GBuffer& g, std::span<const Fragment> fragments, std::vector<std::uint64_t>& masks,
                      PassStatistics& statistics) {
  const auto rays = static_cast<std::uint32_t>(queries_.light.size);
  masks.resize(fragments.size());
  asked_.clear();
  for (std::size_t first = 0; first < fragments.size(); first += kAtOnce) {
    const std::span some = fragments.subspan(first, std::min(kAtOnce, fragments.size() - first));
    queries_.eye.resize(some.size());
    queries_.resize_queries(rays * some.size());
    std::size_t query = 0;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const IVec2 pixel = centre_pixel(g, some[i]);
      const std::size_t at = g.at(pixel.x, pixel.y);
      const Vec3 position = load(g.position, at), normal = load(g.geometric_normal, at);
      float area = 0;
      if (!exact_) area = footprint_.area(orthographic_ ? camera_ : normalize_or(position - camera_, -normal), g.depth[at], normal);
      queries_.eye.set(i, position, normal, g.error[at], area, static_cast<std::uint32_t>(at));
      // Points below the surface itself are not seen, whatever lies there.
      const bool above = light_->above(position, normal);
      for (std::uint32_t k = 0; k < rays; ++k, ++query) {
        const bool seen = above || glm::dot(load(queries_.light.position, k) - position, normal) > 0;
        queries_.eye_of[query] = static_cast<std::uint32_t>(i), queries_.light_of[query] = seen ? k : kNoQuery;
      }
    }
    weights_.resize(std::max(weights_.size(), padded(queries_.size) + kLanes));
    worker_->visible(queries_, weights_, statistics.rays, statistics.visibility);
    for (std::size_t i = 0; i < some.size(); ++i) {
      std::uint64_t mask = 0;
      for (std::uint32_t k = 0; k < rays; ++k) mask |= static_cast<std::uint64_t>(weights_[i * rays + k] > 0.5f) << k;
      masks[first + i] = mask;
      if (!counts_questions_) continue;
      const std::uint32_t* own = queries_.light_of.data() + i * rays;
      asked_.push_back(rays - static_cast<std::uint32_t>(std::count(own, own + rays, kNoQuery)));
    }
  }
}

}  // namespace sightline
