#include "bench/bare_loop.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>

#include "base/parallel/parallel.h"
#include "base/sample/sobol.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/bare_loop.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

// Plain loops over 16 lanes, which the compiler turns into vectors of the target.
inline constexpr int kBlock = 16;

struct alignas(64) Lanes {
  float v[kBlock];
  float& operator[](int i) { return v[i]; }
  float operator[](int i) const { return v[i]; }
};

struct RayLanes {
  Lanes ox, oy, oz, dx, dy, dz, t_far;
  alignas(64) int valid[kBlock];
};

struct HitLanes {
  Lanes t, nx, ny, nz;
  alignas(64) std::uint32_t geometry[kBlock];
};

HWY_INLINE float random_unit(std::uint32_t x) {
  // Two rounds of a multiplicative hash: enough for a benchmark's rays.
  x ^= x >> 16, x *= 0x7feb352du, x ^= x >> 15, x *= 0x846ca68bu, x ^= x >> 16;
  return static_cast<float>(x >> 8) * 0x1p-24f;
}

template <class Packet>
void fill(Packet& p, const RayLanes& r, int first, int n) {
  for (int i = 0; i < n; ++i) {
    p.org_x[i] = r.ox[first + i], p.org_y[i] = r.oy[first + i], p.org_z[i] = r.oz[first + i];
    p.dir_x[i] = r.dx[first + i], p.dir_y[i] = r.dy[first + i], p.dir_z[i] = r.dz[first + i];
    p.tnear[i] = 0, p.tfar[i] = r.t_far[first + i], p.time[i] = 0, p.mask[i] = ~0u, p.id[i] = 0, p.flags[i] = 0;
  }
}

void fill_single(RTCRay& p, const RayLanes& r, int i) {
  p = {r.ox[i], r.oy[i], r.oz[i], 0.f, r.dx[i], r.dy[i], r.dz[i], 0.f, r.t_far[i], ~0u, 0u, 0u};
}

template <class PacketHit>
void read(const PacketHit& p, HitLanes& h, int first, int n) {
  for (int i = 0; i < n; ++i) {
    h.t[first + i] = p.ray.tfar[i], h.geometry[first + i] = p.hit.geomID[i];
    h.nx[first + i] = p.hit.Ng_x[i], h.ny[first + i] = p.hit.Ng_y[i], h.nz[first + i] = p.hit.Ng_z[i];
  }
}

template <class PacketHit, int N>
void intersect_n(RTCScene scene, EmbreeQuery& query, const RayLanes& r, HitLanes& h) {
  PacketHit p;
  for (int first = 0; first < kBlock; first += N) {
    fill(p.ray, r, first, N);
    for (int i = 0; i < N; ++i) p.hit.geomID[i] = p.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    embree_intersect(r.valid + first, scene, query, p);
    read(p, h, first, N);
  }
}

std::uint64_t intersect(RTCScene scene, const RayLanes& r, HitLanes& h, CallStyle style) {
  EmbreeQuery query(style.coherent, nullptr, nullptr);
  std::uint64_t active = 0;
  for (int i = 0; i < kBlock; ++i) active += r.valid[i] != 0;
  if (active == 0) return 0;
  if (style.width == 16) {
    intersect_n<RTCRayHit16, 16>(scene, query, r, h);
  } else if (style.width == 8) {
    intersect_n<RTCRayHit8, 8>(scene, query, r, h);
  } else {
    for (int i = 0; i < kBlock; ++i) {
      if (!r.valid[i]) continue;
      RTCRayHit p;
      fill_single(p.ray, r, i);
      p.hit.geomID = p.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      embree_intersect(scene, query, p);
      h.t[i] = p.ray.tfar, h.geometry[i] = p.hit.geomID, h.nx[i] = p.hit.Ng_x, h.ny[i] = p.hit.Ng_y, h.nz[i] = p.hit.Ng_z;
    }
  }
  return active;
}

template <class Packet, int N>
void occluded_n(RTCScene scene, EmbreeQuery& query, const RayLanes& r, Lanes& visible) {
  Packet p;
  for (int first = 0; first < kBlock; first += N) {
    fill(p, r, first, N);
    embree_occluded(r.valid + first, scene, query, p);
    for (int i = 0; i < N; ++i) visible[first + i] = p.tfar[i] < 0 ? 0.f : 1.f;
  }
}

std::uint64_t occluded(RTCScene scene, const RayLanes& r, Lanes& visible, CallStyle style) {
  EmbreeQuery query(style.coherent, nullptr, nullptr);
  std::uint64_t active = 0;
  for (int i = 0; i < kBlock; ++i) active += r.valid[i] != 0;
  if (active == 0) return 0;
  if (style.width == 16) {
    occluded_n<RTCRay16, 16>(scene, query, r, visible);
  } else if (style.width == 8) {
    occluded_n<RTCRay8, 8>(scene, query, r, visible);
  } else {
    for (int i = 0; i < kBlock; ++i) {
      if (!r.valid[i]) continue;
      RTCRay p;
      fill_single(p, r, i);
      embree_occluded(scene, query, p);
      visible[i] = p.tfar < 0 ? 0.f : 1.f;
    }
  }
  return active;
}

struct Light {
  Vec3 corner, u, v, normal, radiance;
  float area;
};

Light light_of(const RectangleLight& l) {
  const Vec3 n = glm::cross(l.half_u, l.half_v);
  return {l.center - l.half_u - l.half_v, 2.f * l.half_u, 2.f * l.half_v, glm::normalize(n), l.radiance, 4 * glm::length(n)};
}

/// Points, with normals turned to the viewer, of the lanes that hit.
struct PointLanes {
  Lanes x, y, z, nx, ny, nz;
};

HWY_INLINE void points_of(const RayLanes& r, const HitLanes& h, PointLanes& p) {
  for (int i = 0; i < kBlock; ++i) {
    const float length = std::sqrt(h.nx[i] * h.nx[i] + h.ny[i] * h.ny[i] + h.nz[i] * h.nz[i]);
    const float facing = h.nx[i] * r.dx[i] + h.ny[i] * r.dy[i] + h.nz[i] * r.dz[i];
    const float s = (facing > 0 ? -1.f : 1.f) / length;
    p.nx[i] = h.nx[i] * s, p.ny[i] = h.ny[i] * s, p.nz[i] = h.nz[i] * s;
    p.x[i] = r.ox[i] + h.t[i] * r.dx[i], p.y[i] = r.oy[i] + h.t[i] * r.dy[i], p.z[i] = r.oz[i] + h.t[i] * r.dz[i];
  }
}

// Shadow rays from 16 points to 16 points of the light and what they would carry, with the pdf of the light sample.
HWY_INLINE void shadow_lanes(const Light& l, float epsilon, const PointLanes& p, const Lanes& u, const Lanes& v, RayLanes& r,
                             Lanes& carried, Lanes& pdf) {
  for (int i = 0; i < kBlock; ++i) {
    const float ox = p.x[i] + epsilon * p.nx[i], oy = p.y[i] + epsilon * p.ny[i], oz = p.z[i] + epsilon * p.nz[i];
    const float dx = l.corner.x + u[i] * l.u.x + v[i] * l.v.x - ox, dy = l.corner.y + u[i] * l.u.y + v[i] * l.v.y - oy,
                dz = l.corner.z + u[i] * l.u.z + v[i] * l.v.z - oz;
    const float d2 = dx * dx + dy * dy + dz * dz, inverse = 1 / std::sqrt(d2);
    const float cos_x = (p.nx[i] * dx + p.ny[i] * dy + p.nz[i] * dz) * inverse;
    const float cos_l = -(l.normal.x * dx + l.normal.y * dy + l.normal.z * dz) * inverse;
    pdf[i] = d2 / (cos_l * l.area);
    carried[i] = cos_x > 0 && cos_l > 0 ? cos_x * cos_l / d2 * l.area : 0.f;
    r.ox[i] = ox, r.oy[i] = oy, r.oz[i] = oz, r.dx[i] = dx, r.dy[i] = dy, r.dz[i] = dz, r.t_far[i] = 0.9999f;
  }
}

// 16 pixels of a 4x4 block with offsets in the pixel.
HWY_INLINE void primary_lanes(const PinholeRays& plane, int bx, int by, int height, const Lanes& jx, const Lanes& jy, RayLanes& r) {
  for (int i = 0; i < kBlock; ++i) {
    const int px = bx + (i & 3), py = by + (i >> 2);
    const float x = static_cast<float>(px) + jx[i], y = static_cast<float>(py) + jy[i];
    const float dx = plane.origin.x + x * plane.step_x.x + y * plane.step_y.x,
                dy = plane.origin.y + x * plane.step_x.y + y * plane.step_y.y,
                dz = plane.origin.z + x * plane.step_x.z + y * plane.step_y.z;
    const float inverse = 1 / std::sqrt(dx * dx + dy * dy + dz * dz);
    r.ox[i] = plane.position.x, r.oy[i] = plane.position.y, r.oz[i] = plane.position.z;
    r.dx[i] = dx * inverse, r.dy[i] = dy * inverse, r.dz[i] = dz * inverse;
    r.t_far[i] = std::numeric_limits<float>::infinity();
    r.valid[i] = px < static_cast<int>(plane.width) && py < height ? -1 : 0;
  }
}

void OneHitBlock(const BareJob& job, const PinholeRays& plane, int bx, int by, int samples, const BareStyle& style, BareResult& result) {
  const Light light = light_of(job.light);
  RayLanes primary, shadow;
  HitLanes hit;
  PointLanes points, one;
  Lanes u, v, carried, visible, pdf;
  for (int i = 0; i < kBlock; ++i) u[i] = v[i] = 0.5f;
  primary_lanes(plane, bx, by, job.view->height(), u, v, primary);
  result.rays += intersect(job.scene, primary, hit, style.primary);
  points_of(primary, hit, points);
  for (int lane = 0; lane < kBlock; ++lane) {
    if (!primary.valid[lane] || hit.geometry[lane] == RTC_INVALID_GEOMETRY_ID) continue;
    for (int i = 0; i < kBlock; ++i) {
      one.x[i] = points.x[lane], one.y[i] = points.y[lane], one.z[i] = points.z[lane];
      one.nx[i] = points.nx[lane], one.ny[i] = points.ny[lane], one.nz[i] = points.nz[lane];
    }
    const std::uint32_t seed = static_cast<std::uint32_t>(by * 65536 + bx * 16 + lane) * 0x9e3779b9u;
    float sum = 0;
    for (int s = 0; s < samples; s += kBlock) {
      for (int i = 0; i < kBlock; ++i) {
        const std::uint32_t index = seed + static_cast<std::uint32_t>(2 * (s + i));
        u[i] = random_unit(index), v[i] = random_unit(index + 1);
      }
      shadow_lanes(light, job.epsilon, one, u, v, shadow, carried, pdf);
      for (int i = 0; i < kBlock; ++i) shadow.valid[i] = carried[i] > 0 && s + i < samples ? -1 : 0, visible[i] = 0;
      result.rays += occluded(job.scene, shadow, visible, style.shadow);
      for (int i = 0; i < kBlock; ++i) sum += shadow.valid[i] ? carried[i] * visible[i] : 0.f;
    }
    result.sum += sum / static_cast<float>(samples) * light.radiance.x * job.albedo * kInvPi;
  }
}

void PathBlock(const BareJob& job, const PinholeRays& plane, int bx, int by, SampleRange samples, int spp, int bounces,
               const BareStyle& style, BareResult& result) {
  const Light light = light_of(job.light);
  RayLanes ray, shadow;
  HitLanes hit;
  PointLanes points;
  Lanes u, v, carried, visible, light_pdf, throughput, total, bsdf_pdf;
  for (std::uint32_t sample = samples.begin; sample < samples.end; ++sample) {
    const std::uint32_t seed = (static_cast<std::uint32_t>(by * 65536 + bx * 16) * 4096u + sample) * 0x9e3779b9u;
    std::uint32_t dimension = 0;
    const auto numbers = [&] {
      for (int i = 0; i < kBlock; ++i) {
        const std::uint32_t index = seed + static_cast<std::uint32_t>(i) * 0x85ebca6bu + dimension;
        u[i] = random_unit(index), v[i] = random_unit(index + 1);
      }
      dimension += 2;
    };
    numbers();
    primary_lanes(plane, bx, by, job.view->height(), u, v, ray);
    for (int i = 0; i < kBlock; ++i) throughput[i] = 1, total[i] = 0, bsdf_pdf[i] = -1;
    const int last = job.light_is_geometry ? bounces + 1 : bounces;
    for (int bounce = 0; bounce <= last; ++bounce) {
      result.rays += intersect(job.scene, ray, hit, bounce == 0 ? style.primary : style.bounce);
      points_of(ray, hit, points);
      for (int i = 0; i < kBlock; ++i) {
        if (ray.valid[i] && hit.geometry[i] == RTC_INVALID_GEOMETRY_ID) ray.valid[i] = 0;
        // The light itself, weighted against light sampling [Veach1997].
        if (!ray.valid[i] || !job.light_is_geometry || hit.geometry[i] != job.light_geometry) continue;
        const float cos_l = -(light.normal.x * ray.dx[i] + light.normal.y * ray.dy[i] + light.normal.z * ray.dz[i]);
        if (cos_l <= 0) continue;
        const float p_light = hit.t[i] * hit.t[i] / (cos_l * light.area), p = bsdf_pdf[i];
        total[i] += throughput[i] * light.radiance.x * (p < 0 ? 1.f : p * p / (p * p + p_light * p_light));
      }
      if (bounce > bounces) break;
      numbers();
      shadow_lanes(light, job.epsilon, points, u, v, shadow, carried, light_pdf);
      for (int i = 0; i < kBlock; ++i) shadow.valid[i] = ray.valid[i] && carried[i] > 0 ? -1 : 0, visible[i] = 0;
      result.rays += occluded(job.scene, shadow, visible, style.shadow);
      for (int i = 0; i < kBlock; ++i) {
        if (!shadow.valid[i]) continue;
        float value = throughput[i] * job.albedo * kInvPi * carried[i] * visible[i] * light.radiance.x;
        if (job.light_is_geometry) {
          const float cos_x = points.nx[i] * shadow.dx[i] + points.ny[i] * shadow.dy[i] + points.nz[i] * shadow.dz[i];
          const float d2 = shadow.dx[i] * shadow.dx[i] + shadow.dy[i] * shadow.dy[i] + shadow.dz[i] * shadow.dz[i];
          const float p_bsdf = cos_x / std::sqrt(d2) * kInvPi, p = light_pdf[i];
          value *= p * p / (p * p + p_bsdf * p_bsdf);
        }
        total[i] += value;
      }
      if (bounce == last) break;
      numbers();
      for (int i = 0; i < kBlock; ++i) {
        // Normal plus a point of the unit sphere: cosine-weighted, with one sine and one cosine.
        const float z = 1 - 2 * u[i], radius = std::sqrt(std::fmax(0.f, 1 - z * z)), angle = 2 * kPi * v[i];
        const float dx = points.nx[i] + radius * std::cos(angle), dy = points.ny[i] + radius * std::sin(angle), dz = points.nz[i] + z;
        const float inverse = 1 / std::sqrt(dx * dx + dy * dy + dz * dz + 1e-20f);
        ray.ox[i] = points.x[i] + job.epsilon * points.nx[i], ray.oy[i] = points.y[i] + job.epsilon * points.ny[i],
        ray.oz[i] = points.z[i] + job.epsilon * points.nz[i];
        ray.dx[i] = dx * inverse, ray.dy[i] = dy * inverse, ray.dz[i] = dz * inverse, ray.t_far[i] = std::numeric_limits<float>::infinity();
        bsdf_pdf[i] = (points.nx[i] * dx + points.ny[i] * dy + points.nz[i] * dz) * inverse * kInvPi;
        throughput[i] *= job.albedo;
      }
    }
    for (int i = 0; i < kBlock; ++i) result.sum += total[i] / static_cast<float>(spp);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(OneHitBlock);
HWY_EXPORT(PathBlock);

namespace {

constexpr int kTileSide = 32;

int tiles_along(int pixels) { return (pixels + kTileSide - 1) / kTileSide; }

template <class Block>
BareResult over_tiles(const BareJob& job, const Context& context, Block block) {
  const PinholeRays plane = job.view->pinhole();
  const int tiles_x = tiles_along(job.view->width());
  const auto step = static_cast<std::size_t>(job.tile_step);
  BareResult total;
  std::mutex mutex;
  const auto start = std::chrono::steady_clock::now();
  const std::size_t tiles = (static_cast<std::size_t>(bare_tile_count(job)) + step - 1) / step;
  parallel_for(context, tiles, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      BareResult local;
      const int tile = static_cast<int>(i * step), x0 = tile % tiles_x * kTileSide, y0 = tile / tiles_x * kTileSide;
      for (int by = y0; by < std::min(y0 + kTileSide, job.view->height()); by += 4) {
        for (int bx = x0; bx < std::min(x0 + kTileSide, job.view->width()); bx += 4) block(plane, bx, by, local);
      }
      const std::lock_guard lock(mutex);
      total.rays += local.rays, total.sum += local.sum;
    }
  });
  total.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return total;
}

}  // namespace

int bare_tile_count(const BareJob& job) { return tiles_along(job.view->width()) * tiles_along(job.view->height()); }

BareResult bare_one_hit(const BareJob& job, int samples, const BareStyle& style, const Context& context) {
  return over_tiles(job, context, [&](const PinholeRays& plane, int bx, int by, BareResult& local) {
    HWY_DYNAMIC_DISPATCH(OneHitBlock)(job, plane, bx, by, samples, style, local);
  });
}

BareResult bare_paths(const BareJob& job, SampleRange samples, int spp, int bounces, const BareStyle& style, const Context& context) {
  return over_tiles(job, context, [&](const PinholeRays& plane, int bx, int by, BareResult& local) {
    HWY_DYNAMIC_DISPATCH(PathBlock)(job, plane, bx, by, samples, spp, bounces, style, local);
  });
}

}  // namespace sightline
#endif
