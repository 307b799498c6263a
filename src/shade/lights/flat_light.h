// Flat emitters: rectangles, triangles and disks, uniform by area.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/math/vec.h"
#include "base/sample/warp.h"
#include "scene/ids.h"
#include "shade/light_table.h"

namespace sightline {

/// One flat emitter: points origin + a e1 + b e2, where (a, b) fill the unit square (rectangle), its lower half (triangle) or the unit
/// disk. One cache line, read by vector code as 16 words.
struct alignas(64) FlatLight {
  Vec3 origin{0}, e1{0}, e2{0};
  Vec3 normal{0};  ///< unit, of the emitting side
  float area = 0;
  float point_error = 0;        ///< of computed points, per component
  std::uint32_t emitter = 0;    ///< index of its FlatEmitter
  std::uint32_t primitive = 0;  ///< triangle of the mesh
};
static_assert(sizeof(FlatLight) == 64);

/// What the flat lights of one surface share. One vector-friendly record of 8 words.
struct FlatEmitter {
  enum Flags : std::uint32_t { kTriangle = 1, kDisk = 2, kTwoSided = 4, kMesh = 8, kTextured = 16 };
  Color radiance{0};
  std::uint32_t flags = 0;
  TextureId texture;                   ///< multiplies `radiance` if kTextured
  std::uint32_t source = 0xffffffffu;  ///< for textures: index of the mesh instance
  std::uint32_t reserved0 = 0, reserved1 = 0;

  bool is(Flags flag) const { return (flags & flag) != 0; }
};
static_assert(sizeof(FlatEmitter) == 32);

/// The random numbers as parameters (a, b).
inline Vec2 flat_parameters(std::uint32_t flags, const Vec2& u) {
  if (flags & FlatEmitter::kTriangle) return sample_uniform_triangle(u);
  if (flags & FlatEmitter::kDisk) return sample_concentric_disk(u);
  return u;
}

/// How `point` on the light is seen from `position`. The order of operations is part of the definition: vector code repeats it exactly.
struct FlatView {
  Vec3 wi;  ///< unit; 0 where the two points coincide
  float distance;
  float pdf;  ///< solid angle, `selection` included; 0 from behind a one-sided light or on its plane
};
inline FlatView view_flat(const FlatLight& light, bool two_sided, const Vec3& position, const Vec3& point, float selection) {
  const float dx = point.x - position.x, dy = point.y - position.y, dz = point.z - position.z;
  const float squared = (dx * dx + dy * dy) + dz * dz;
  const float distance = std::sqrt(squared);
  const float inverse = squared > 0 ? 1 / distance : 0.f;
  const float away = (dx * light.normal.x + dy * light.normal.y) + dz * light.normal.z;
  const float facing = two_sided ? std::fabs(away) : 0 - away;
  const float pdf = (selection * (squared * distance)) / (light.area * facing);
  const bool seen = facing > 0 && pdf < std::numeric_limits<float>::infinity();
  return {{dx * inverse, dy * inverse, dz * inverse}, distance, seen ? pdf : 0.f};
}

/// Point of the light, and the sample without its texture.
inline LightSample sample_flat(const FlatLight& light, const FlatEmitter& emitter, std::uint32_t index, float selection,
                               const Vec3& position, const Vec2& u) {
  const Vec2 ab = flat_parameters(emitter.flags, u);
  const Vec3 point{(light.origin.x + light.e1.x * ab.x) + light.e2.x * ab.y, (light.origin.y + light.e1.y * ab.x) + light.e2.y * ab.y,
                   (light.origin.z + light.e1.z * ab.x) + light.e2.z * ab.y};
  const FlatView view = view_flat(light, emitter.is(FlatEmitter::kTwoSided), position, point, selection);
  LightSample s;
  s.wi = view.wi;
  s.distance = view.distance;
  s.point = point;
  s.normal = light.normal;
  s.point_error = light.point_error;
  s.radiance = view.pdf > 0 ? emitter.radiance : Color(0);
  s.pdf = view.pdf;
  s.is_mesh = emitter.is(FlatEmitter::kMesh);
  s.light = index;
  return s;
}

}  // namespace sightline
