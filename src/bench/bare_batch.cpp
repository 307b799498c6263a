// Embree over a structure-of-arrays batch, as short as it can be written.
#include <cstring>

#include "bench/bare_loop.h"

namespace sightline {
namespace {

template <int N, class Packet>
void load(Packet& p, const RayBatch& rays, std::size_t at) {
  std::memcpy(p.org_x, rays.origin.x.data() + at, N * sizeof(float));
  std::memcpy(p.org_y, rays.origin.y.data() + at, N * sizeof(float));
  std::memcpy(p.org_z, rays.origin.z.data() + at, N * sizeof(float));
  std::memcpy(p.dir_x, rays.direction.x.data() + at, N * sizeof(float));
  std::memcpy(p.dir_y, rays.direction.y.data() + at, N * sizeof(float));
  std::memcpy(p.dir_z, rays.direction.z.data() + at, N * sizeof(float));
  std::memcpy(p.tnear, rays.t_near.data() + at, N * sizeof(float));
  std::memcpy(p.tfar, rays.t_far.data() + at, N * sizeof(float));
}

template <class Packet>
void clear(Packet& p) {
  std::memset(&p, 0, sizeof p);
  std::memset(p.mask, 0xff, sizeof p.mask);
}

template <int N, class PacketHit>
void intersect_packets(RTCScene scene, const RayBatch& rays, HitBatch& hits, EmbreeQuery& query) {
  PacketHit p;
  clear(p.ray);
  alignas(64) int valid[N];
  for (std::size_t at = 0; at < rays.size; at += N) {
    load<N>(p.ray, rays, at);
    for (int i = 0; i < N; ++i) {
      valid[i] = at + static_cast<std::size_t>(i) < rays.size ? -1 : 0;
      p.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    embree_intersect(valid, scene, query, p);
    std::memcpy(hits.t.data() + at, p.ray.tfar, N * sizeof(float));
    std::memcpy(hits.u.data() + at, p.hit.u, N * sizeof(float));
    std::memcpy(hits.v.data() + at, p.hit.v, N * sizeof(float));
    std::memcpy(hits.instance.data() + at, p.hit.geomID, N * sizeof(float));
    std::memcpy(hits.primitive.data() + at, p.hit.primID, N * sizeof(float));
  }
}

template <int N, class Packet>
void occluded_packets(RTCScene scene, const RayBatch& rays, std::uint8_t* occluded, EmbreeQuery& query) {
  Packet p;
  clear(p);
  alignas(64) int valid[N];
  for (std::size_t at = 0; at < rays.size; at += N) {
    load<N>(p, rays, at);
    for (int i = 0; i < N; ++i) valid[i] = at + static_cast<std::size_t>(i) < rays.size ? -1 : 0;
    embree_occluded(valid, scene, query, p);
    for (int i = 0; i < N; ++i) occluded[at + static_cast<std::size_t>(i)] = p.tfar[i] == -kInfinity;
  }
}

RTCRay single(const RayBatch& r, std::size_t i) {
  return {r.origin.x[i],
          r.origin.y[i],
          r.origin.z[i],
          r.t_near[i],
          r.direction.x[i],
          r.direction.y[i],
          r.direction.z[i],
          0.f,
          r.t_far[i],
          ~0u,
          0u,
          0u};
}

}  // namespace

void bare_intersect(RTCScene scene, const RayBatch& rays, HitBatch& hits, CallStyle style) {
  hits.resize(rays.size);
  EmbreeQuery query(style.coherent, nullptr, nullptr);
  if (style.width == 16) return intersect_packets<16, RTCRayHit16>(scene, rays, hits, query);
  if (style.width == 8) return intersect_packets<8, RTCRayHit8>(scene, rays, hits, query);
  for (std::size_t i = 0; i < rays.size; ++i) {
    RTCRayHit p;
    p.ray = single(rays, i);
    p.hit.geomID = p.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    embree_intersect(scene, query, p);
    hits.t[i] = p.ray.tfar, hits.u[i] = p.hit.u, hits.v[i] = p.hit.v;
    hits.instance[i] = p.hit.geomID, hits.primitive[i] = p.hit.primID;
  }
}

void bare_occluded(RTCScene scene, const RayBatch& rays, std::uint8_t* occluded, CallStyle style) {
  EmbreeQuery query(style.coherent, nullptr, nullptr);
  if (style.width == 16) return occluded_packets<16, RTCRay16>(scene, rays, occluded, query);
  if (style.width == 8) return occluded_packets<8, RTCRay8>(scene, rays, occluded, query);
  for (std::size_t i = 0; i < rays.size; ++i) {
    RTCRay p = single(rays, i);
    embree_occluded(scene, query, p);
    occluded[i] = p.tfar == -kInfinity;
  }
}

}  // namespace sightline
