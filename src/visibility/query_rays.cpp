#include "visibility/query_rays.h"

#include <algorithm>
#include <limits>

#include "base/math/vec3_batch.h"
#include "visibility/query_ray_lanes.h"

namespace sightline {
namespace {

constexpr std::size_t kBlock = 1024;  // rays and answers stay in the L1 and L2 caches

}  // namespace

Ray query_ray(const QueryBatch& queries, std::size_t i) {
  if (queries.light_of[i] == kNoQuery) return {Vec3(0), 0, Vec3(0, 0, 1), -1};
  return query_ray(queries, queries.eye_of[i], queries.light_of[i]);
}

Ray query_ray(const QueryBatch& queries, std::size_t e, std::size_t l) {
  const Vec3 x = load(queries.eye.position, e), nx = load(queries.eye.normal, e), y = load(queries.light.position, l);
  if (is_infinite(static_cast<QuerySemantic>(queries.semantic[l])))
    return {offset_origin(x, nx, queries.eye.error[e], y), 0, y, std::numeric_limits<float>::infinity()};
  const Vec3 towards = y - x;
  const Vec3 origin = offset_origin(x, nx, queries.eye.error[e], towards);
  const Vec3 target = offset_origin(y, load(queries.light.normal, l), queries.light.error[l], -towards);
  return {origin, 0, target - origin, 1};
}

void QueryTracer::trace_all(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) {
  occluded_.resize(std::max(occluded_.size(), kBlock));
  std::uint64_t asked = 0;
  for (std::size_t begin = 0; begin < queries.size; begin += kBlock) {
    const std::size_t count = std::min(kBlock, queries.size - begin);
    batch_.resize(count);
    query_rays(queries, nullptr, begin, count, batch_);
    world_->tracer().occluded(batch_, occluded_, queries.kind, rays);
    const std::uint32_t* light = queries.light_of.data() + begin;
    const std::uint8_t* occluded = occluded_.data();
    float* weight = weights.data() + begin;
    for (std::size_t k = 0; k < count; ++k) {
      const bool gap = light[k] == kNoQuery;
      asked += !gap;
      weight[k] = static_cast<float>(!gap & !occluded[k]);
    }
  }
  counts.queries += asked;
  counts.traced += asked;
}

std::span<const std::uint8_t> QueryTracer::trace(const QueryBatch& queries, std::span<const std::uint32_t> which, RayCounts& rays,
                                                 VisibilityCounts& counts) {
  batch_.resize(which.size());
  query_rays(queries, which.data(), 0, which.size(), batch_);
  occluded_.resize(std::max(occluded_.size(), padded(which.size())));
  world_->tracer().occluded(batch_, occluded_, BatchKind::shadow_diffuse, rays);
  counts.traced += which.size();
  return std::span(occluded_).first(which.size());
}

}  // namespace sightline
