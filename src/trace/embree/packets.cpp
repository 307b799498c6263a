#include "trace/embree/packets.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace sightline {
namespace {

// By BatchKind: primary, shadow, shadow_diffuse, bounce; the fastest of single, 8- and 16-wide calls with either flag in `sightline bench
// trace`. Coherent packets of shadow rays pay where triangles are large beside the packet (Sponza: 1.5 times the rays), and cost up to half
// the speed where they are fine (hairball, where 8 rays a call are 7 % faster than 16), so those have a table for each class of geometry.
// All give the same answers.
constexpr std::array<CallStyle, 4> kIntersectStyles{{{16, true}, {16, false}, {16, false}, {8, false}}};
// By GeometryDetail.
constexpr std::array<std::array<CallStyle, 4>, 3> kOccludedStyles{{
    {{{16, true}, {16, true}, {16, false}, {16, false}}},
    {{{16, false}, {16, false}, {16, false}, {16, false}}},
    {{{8, false}, {8, false}, {8, false}, {8, false}}},
}};
/// Scenes with at most this many triangles count as coarse and as medium.
constexpr std::uint64_t kCoarseTriangles = std::uint64_t{1} << 18, kMediumTriangles = std::uint64_t{1} << 20;

CallStyle fit(CallStyle style, int native_width) {
  while (style.width > native_width) style.width = style.width == 16 ? 8 : 1;
  return style;
}

template <int N>
struct Packet;
template <>
struct Packet<8> {
  using Ray = RTCRay8;
  using RayHit = RTCRayHit8;
};
template <>
struct Packet<16> {
  using Ray = RTCRay16;
  using RayHit = RTCRayHit16;
};

template <class Ray>
void set_constants(Ray& ray) {
  std::memset(&ray, 0, sizeof ray);
  std::memset(ray.mask, 0xff, sizeof ray.mask);
}

template <class Ray>
void load(Ray& ray, const RayBatch& rays, std::size_t base) {
  std::memcpy(ray.org_x, rays.origin.x.data() + base, sizeof ray.org_x);
  std::memcpy(ray.org_y, rays.origin.y.data() + base, sizeof ray.org_y);
  std::memcpy(ray.org_z, rays.origin.z.data() + base, sizeof ray.org_z);
  std::memcpy(ray.tnear, rays.t_near.data() + base, sizeof ray.tnear);
  std::memcpy(ray.dir_x, rays.direction.x.data() + base, sizeof ray.dir_x);
  std::memcpy(ray.dir_y, rays.direction.y.data() + base, sizeof ray.dir_y);
  std::memcpy(ray.dir_z, rays.direction.z.data() + base, sizeof ray.dir_z);
  std::memcpy(ray.tfar, rays.t_far.data() + base, sizeof ray.tfar);
}

void load(RTCRay& ray, const RayBatch& rays, std::size_t i) {
  ray.org_x = rays.origin.x[i], ray.org_y = rays.origin.y[i], ray.org_z = rays.origin.z[i], ray.tnear = rays.t_near[i];
  ray.dir_x = rays.direction.x[i], ray.dir_y = rays.direction.y[i], ray.dir_z = rays.direction.z[i], ray.time = 0;
  ray.tfar = rays.t_far[i], ray.mask = ~0u, ray.id = 0, ray.flags = 0;
}

// -1 for lanes below `count` whose interval is not empty; false if there is none.
template <int N>
bool set_valid(std::array<int, N>& valid, const float* t_near, const float* t_far, std::size_t count) {
  int any = 0;
  for (int i = 0; i < N; ++i) {
    valid[i] = -static_cast<int>((t_near[i] <= t_far[i]) & (static_cast<std::size_t>(i) < count));
    any |= valid[i];
  }
  return any != 0;
}

// The static scene first, then the top-level scene on what is left of each ray: as Embree itself treats geometries of different types in
// one scene, but the static part needs no instance and survives edits.
template <int N>
void intersect_packets(const EmbreeScenes& scenes, const RayBatch& rays, HitBatch& hits, EmbreeQuery& query) {
  typename Packet<N>::RayHit packet;
  alignas(64) std::array<int, N> valid;
  set_constants(packet.ray);
  for (std::size_t base = 0; base < rays.size; base += N) {
    load(packet.ray, rays, base);
    std::memset(packet.hit.geomID, 0xff, sizeof packet.hit.geomID);
    if (!set_valid<N>(valid, packet.ray.tnear, packet.ray.tfar, rays.size - base)) {
      std::memcpy(hits.t.data() + base, packet.ray.tfar, sizeof packet.ray.tfar);
      std::memset(hits.instance.data() + base, 0xff, sizeof packet.hit.geomID);
      continue;
    }
    if (scenes.static_scene) {
      query.in_static_scene = true;
      embree_intersect(valid.data(), scenes.static_scene, query, packet);
    }
    if (!scenes.top_scene) {
      if (scenes.static_is_identity) {
        std::memcpy(hits.instance.data() + base, packet.hit.geomID, sizeof packet.hit.geomID);
      } else {
        for (int i = 0; i < N; ++i) {
          const unsigned id = packet.hit.geomID[i];
          hits.instance[base + i] = id == RTC_INVALID_GEOMETRY_ID ? kNoHit : scenes.tables.static_instances[id];
        }
      }
    } else {
      // Ids are reset in between, so that the second call shows which lanes it changed.
      alignas(64) std::array<std::uint32_t, N> instance;
      for (int i = 0; i < N; ++i) {
        const unsigned id = packet.hit.geomID[i];
        instance[i] = id == RTC_INVALID_GEOMETRY_ID ? kNoHit : scenes.tables.static_instances[id];
      }
      std::memset(packet.hit.geomID, 0xff, sizeof packet.hit.geomID);
      std::memset(packet.hit.instID[0], 0xff, sizeof packet.hit.instID[0]);
      query.in_static_scene = false;
      embree_intersect(valid.data(), scenes.top_scene, query, packet);
      for (int i = 0; i < N; ++i) {
        if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
        const unsigned id = packet.hit.instID[0][i];
        instance[i] = id == RTC_INVALID_GEOMETRY_ID ? packet.hit.primID[i] | kSphereBit : scenes.tables.top_instances[id];
      }
      std::memcpy(hits.instance.data() + base, instance.data(), sizeof instance);
    }
    std::memcpy(hits.t.data() + base, packet.ray.tfar, sizeof packet.ray.tfar);
    std::memcpy(hits.u.data() + base, packet.hit.u, sizeof packet.hit.u);
    std::memcpy(hits.v.data() + base, packet.hit.v, sizeof packet.hit.v);
    std::memcpy(hits.primitive.data() + base, packet.hit.primID, sizeof packet.hit.primID);
  }
}

void intersect_singles(const EmbreeScenes& scenes, const RayBatch& rays, HitBatch& hits, EmbreeQuery& query) {
  RTCRayHit ray;
  for (std::size_t i = 0; i < rays.size; ++i) {
    hits.instance[i] = kNoHit;
    hits.t[i] = rays.t_far[i];
    if (!(rays.t_near[i] <= rays.t_far[i])) continue;
    load(ray.ray, rays, i);
    ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    if (scenes.static_scene) {
      query.in_static_scene = true;
      embree_intersect(scenes.static_scene, query, ray);
      if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID) hits.instance[i] = scenes.tables.static_instances[ray.hit.geomID];
    }
    if (scenes.top_scene) {
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.in_static_scene = false;
      embree_intersect(scenes.top_scene, query, ray);
      if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
        hits.instance[i] =
            ray.hit.instID[0] == RTC_INVALID_GEOMETRY_ID ? ray.hit.primID | kSphereBit : scenes.tables.top_instances[ray.hit.instID[0]];
      }
    }
    hits.t[i] = ray.ray.tfar, hits.u[i] = ray.hit.u, hits.v[i] = ray.hit.v;
    hits.primitive[i] = ray.hit.primID;
  }
}

// Embree sets tfar of occluded rays to minus infinity.
template <int N>
void occluded_packets(const EmbreeScenes& scenes, const RayBatch& rays, std::uint8_t* occluded, EmbreeQuery& query) {
  typename Packet<N>::Ray packet;
  alignas(64) std::array<int, N> valid;
  set_constants(packet);
  for (std::size_t base = 0; base < rays.size; base += N) {
    load(packet, rays, base);
    const bool any = set_valid<N>(valid, packet.tnear, packet.tfar, rays.size - base);
    // An inactive ray may itself end at minus infinity, so only valid lanes count.
    alignas(64) const std::array<int, N> active = valid;
    if (any && scenes.static_scene) {
      query.in_static_scene = true;
      embree_occluded(valid.data(), scenes.static_scene, query, packet);
    }
    if (any && scenes.top_scene && (!scenes.static_scene || set_valid<N>(valid, packet.tnear, packet.tfar, rays.size - base))) {
      query.in_static_scene = false;
      embree_occluded(valid.data(), scenes.top_scene, query, packet);
    }
    for (int i = 0; i < N; ++i) occluded[base + i] = static_cast<std::uint8_t>((packet.tfar[i] == -kInfinity) & active[i]);
  }
}

void occluded_singles(const EmbreeScenes& scenes, const RayBatch& rays, std::uint8_t* occluded, EmbreeQuery& query) {
  RTCRay ray;
  for (std::size_t i = 0; i < rays.size; ++i) {
    occluded[i] = 0;
    if (!(rays.t_near[i] <= rays.t_far[i])) continue;
    load(ray, rays, i);
    if (scenes.static_scene) {
      query.in_static_scene = true;
      embree_occluded(scenes.static_scene, query, ray);
    }
    if (scenes.top_scene && ray.tfar != -kInfinity) {
      query.in_static_scene = false;
      embree_occluded(scenes.top_scene, query, ray);
    }
    occluded[i] = ray.tfar == -kInfinity;
  }
}

}  // namespace

GeometryDetail geometry_detail(std::uint64_t static_triangles) {
  if (static_triangles <= kCoarseTriangles) return GeometryDetail::coarse;
  return static_triangles <= kMediumTriangles ? GeometryDetail::medium : GeometryDetail::fine;
}

CallStyle intersect_style(BatchKind kind, const EmbreeScenes& scenes, int native_width) {
  CallStyle style = kIntersectStyles[static_cast<std::size_t>(kind)];
  style.coherent = style.coherent && !scenes.top_scene;
  return fit(style, native_width);
}

CallStyle occluded_style(BatchKind kind, const EmbreeScenes& scenes, int native_width) {
  CallStyle style = kOccludedStyles[static_cast<std::size_t>(scenes.detail)][static_cast<std::size_t>(kind)];
  style.coherent = style.coherent && !scenes.top_scene;
  return fit(style, native_width);
}

void intersect_batch(const EmbreeScenes& scenes, const RayBatch& rays, HitBatch& hits, CallStyle style) {
  EmbreeQuery query(style.coherent, scenes.masks, &scenes.tables);
  switch (style.width) {
    case 16:
      return intersect_packets<16>(scenes, rays, hits, query);
    case 8:
      return intersect_packets<8>(scenes, rays, hits, query);
    default:
      return intersect_singles(scenes, rays, hits, query);
  }
}

void occluded_batch(const EmbreeScenes& scenes, const RayBatch& rays, std::span<std::uint8_t> occluded, CallStyle style) {
  EmbreeQuery query(style.coherent, scenes.masks, &scenes.tables);
  switch (style.width) {
    case 16:
      return occluded_packets<16>(scenes, rays, occluded.data(), query);
    case 8:
      return occluded_packets<8>(scenes, rays, occluded.data(), query);
    default:
      return occluded_singles(scenes, rays, occluded.data(), query);
  }
}

}  // namespace sightline
