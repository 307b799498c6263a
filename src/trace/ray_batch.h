// Rays and hits as structures of arrays: the currency between methods and tracers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "base/core/aligned.h"
#include "base/math/vec.h"

namespace sightline {

/// What a batch of rays is for. A tracer picks packet width and coherence flag from a fixed table by kind (found by benchmark), never by
/// run-time timing, so that results are repeatable.
enum class BatchKind {
  primary,         ///< camera rays of neighbouring pixels
  shadow,          ///< occlusion rays from neighbouring points to near targets (one light, one origin)
  shadow_diffuse,  ///< occlusion rays without common origin or target
  bounce,          ///< scattered rays
};

/// A ray with direction of any length; t counts in units of it.
struct Ray {
  Vec3 origin{0};
  float t_near = 0;
  Vec3 direction{0, 0, 1};
  float t_far = std::numeric_limits<float>::infinity();
};

/// Rays as a structure of arrays; capacity is a multiple of kLanes, arrays are 64-byte aligned. A ray with t_far < t_near is inactive: it
/// hits nothing and is not occluded. Lanes in [size, padded(size)) may hold anything; tracers mask them.
struct RayBatch {
  Vec3Batch origin, direction;
  AlignedVector<float> t_near, t_far;
  std::size_t size = 0;

  void resize(std::size_t n) {
    size = n;
    origin.resize(n);
    direction.resize(n);
    t_near.resize(padded(n));
    t_far.resize(padded(n));
  }
  void set(std::size_t i, const Ray& r) {
    origin.x[i] = r.origin.x, origin.y[i] = r.origin.y, origin.z[i] = r.origin.z;
    direction.x[i] = r.direction.x, direction.y[i] = r.direction.y, direction.z[i] = r.direction.z;
    t_near[i] = r.t_near, t_far[i] = r.t_far;
  }
  /// Rays that are not inactive.
  std::size_t active_count() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < size; ++i) count += t_near[i] <= t_far[i];
    return count;
  }
  Ray get(std::size_t i) const {
    return {{origin.x[i], origin.y[i], origin.z[i]}, t_near[i], {direction.x[i], direction.y[i], direction.z[i]}, t_far[i]};
  }
};

inline constexpr std::uint32_t kNoHit = 0xffffffffu;
/// Set in HitBatch::instance for analytic spheres; the low bits index Scene::spheres.
inline constexpr std::uint32_t kSphereBit = 0x80000000u;

/// Closest hits. `instance` indexes Scene::instances, or Scene::spheres with kSphereBit, or is kNoHit. (u, v) are the barycentrics of the
/// second and third vertex of triangle `primitive`; unused for spheres.
struct HitBatch {
  AlignedVector<float> t, u, v;
  AlignedVector<std::uint32_t> instance, primitive;
  std::size_t size = 0;

  void resize(std::size_t n) {
    size = n;
    t.resize(padded(n));
    u.resize(padded(n));
    v.resize(padded(n));
    instance.resize(padded(n));
    primitive.resize(padded(n));
  }
  bool hit(std::size_t i) const { return instance[i] != kNoHit; }
};

/// Rays traced; a caller keeps one a thread and a tracer adds to it once a batch.
struct RayCounts {
  std::uint64_t closest = 0, occlusion = 0;
  RayCounts& operator+=(const RayCounts& o) {
    closest += o.closest;
    occlusion += o.occlusion;
    return *this;
  }
};

}  // namespace sightline
