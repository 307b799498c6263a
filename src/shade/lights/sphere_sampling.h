// Spheres as lights: the visible cone from outside, the area from inside.
#pragma once

#include <cstdint>

#include "base/math/vec.h"
#include "scene/ids.h"
#include "shade/light_table.h"

namespace sightline {

struct SphereEmitter {
  Vec3 center{0};
  float radius = 0;
  Color radiance{0};
  bool emits_outside = true, emits_inside = false;
  bool is_mesh = false;                ///< a Sphere of the scene, which rays can hit
  TextureId texture;                   ///< multiplies `radiance`
  std::uint32_t source = 0xffffffffu;  ///< for textures: index of the scene's Sphere
};

/// Sample without texture. From outside uniform in the solid angle of the cone that the sphere fills; from inside uniform by area.
LightSample sample_sphere(const SphereEmitter& sphere, std::uint32_t index, float selection, const Vec3& position, const Vec2& u);
/// Absolute bound on the rounding error of a computed point of the sphere, per component.
float sphere_point_error(const SphereEmitter& sphere);
/// Density of sample_sphere for the point `hit` of the sphere.
float pdf_sphere(const SphereEmitter& sphere, float selection, const Vec3& position, const Vec3& hit);

}  // namespace sightline
