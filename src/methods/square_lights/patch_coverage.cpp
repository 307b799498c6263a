#include "methods/square_lights/patch_coverage.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/parallel/parallel.h"
#include "world/surface.h"

namespace sightline::square_lights {
namespace {

constexpr int kEdge = 4;
static_assert(kEdge * kEdge == kPatchRays);
// Rays end just before the light, whose own surface would stop them.
constexpr float kBefore = 1e-3f;

/// Where ray `k` of a patch goes, from `origin`: a point of a parallelogram, or of the disk that a sphere shows.
Vec3 target(const LocalLight& light, std::size_t patch, const PatchLight& seen, const Vec3& origin, int k) {
  const int row = k / kEdge;
  const float a = (2 * static_cast<float>(k % kEdge) + 1) / kEdge - 1, b = (2 * static_cast<float>(row) + 1) / kEdge - 1;
  if (!light.is_sphere()) {
    const AreaPatch& p = light.patches()[patch];
    return p.center + a * p.half_u + b * p.half_v;
  }
  const Frame3 frame = frame_from_normal(seen.light.center);
  const float half = 0.70710678f * seen.light.radius;
  const Vec3 d = glm::normalize(seen.light.center + half * (a * frame.tangent + b * frame.bitangent));
  return origin + std::max(0.f, glm::length(light.center() - origin) - light.radius()) * d;
}

}  // namespace

std::size_t patch_count(std::span<const LocalLight> lights) {
  std::size_t count = 0;
  for (const LocalLight& light : lights) count += light.count();
  return count;
}

AlignedVector<std::uint8_t> trace_patches(const Tracer& tracer, const VertexSpans& vertices, std::span<const LocalLight> lights,
                                          RayCounts& rays, const Context& context) {
  const std::size_t patches = patch_count(lights);
  AlignedVector<std::uint8_t> coverage(vertices.position.size() * patches);
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(context, vertices.position.size(), 64, [&](std::size_t begin, std::size_t end) {
    RayBatch batch;
    batch.resize(patches * kPatchRays);
    AlignedVector<std::uint8_t> occluded(padded(patches * kPatchRays));
    std::vector<PatchLight> seen;
    RayCounts counts;
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 up = vertices.geometric_normal[v];
      const Vec3 origin = offset_origin(vertices.position[v], up, vertices.error[v], up);
      std::size_t at = 0;
      for (const LocalLight& light : lights) {
        seen.resize(light.count());
        light.lights_at(vertices.position[v], seen);
        for (std::size_t p = 0; p < seen.size(); ++p) {
          for (int k = 0; k < kPatchRays; ++k, ++at) {
            const Vec3 d = target(light, p, seen[p], origin, k) - origin;
            const bool wanted = seen[p].light.radius > 0 && glm::dot(d, up) > 0;
            batch.set(at, {origin, wanted ? 0.f : 1.f, d, wanted ? 1 - kBefore : 0.f});
          }
        }
      }
      tracer.occluded(batch, occluded, BatchKind::shadow, counts);
      for (std::size_t p = 0; p < patches; ++p) {
        int visible = 0;
        for (std::size_t k = p * kPatchRays; k < (p + 1) * kPatchRays; ++k) visible += batch.t_near[k] <= batch.t_far[k] && !occluded[k];
        coverage[v * patches + p] = static_cast<std::uint8_t>(std::lround(255.f / kPatchRays * static_cast<float>(visible)));
      }
    }
    const std::scoped_lock lock(mutex);
    rays += counts;
    done += end - begin;
    context.report("patches of local lights", static_cast<double>(done), static_cast<double>(vertices.position.size()));
  });
  return coverage;
}

}  // namespace sightline::square_lights
