// Lights without extent: points, spots and directions.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "base/math/vec.h"
#include "scene/light.h"
#include "shade/light_table.h"

namespace sightline {

struct PunctualLight {
  enum Kind : std::uint32_t { kPoint, kDirectional, kSpot };
  Vec3 position{0};    ///< for directional lights unused
  Vec3 direction{0};   ///< unit, the way light travels
  Color intensity{0};  ///< W/sr; irradiance of directional lights
  Kind kind = kPoint;
  float cos_inner = 1, cos_outer = 0;
  SpotLight::Falloff falloff = SpotLight::Falloff::gltf;
};

/// Share of the axial intensity at `cosine` from the axis: 1 inside the inner cone, 0 outside the outer.
inline float spot_falloff(const PunctualLight& light, float cosine) {
  if (cosine >= light.cos_inner) return 1;
  if (cosine <= light.cos_outer) return 0;
  const float ramp = (cosine - light.cos_outer) / (light.cos_inner - light.cos_outer);
  return light.falloff == SpotLight::Falloff::gltf ? ramp * ramp : ramp * ramp * (3 - 2 * ramp);
}

/// Integral of spot_falloff over directions.
inline double spot_solid_angle(const PunctualLight& light) {
  const double inner = light.cos_inner, outer = light.cos_outer;
  const double mean_ramp = light.falloff == SpotLight::Falloff::gltf ? 1.0 / 3 : 0.5;
  return 2 * std::numbers::pi * ((1 - inner) + mean_ramp * (inner - outer));
}

inline LightSample sample_punctual(const PunctualLight& light, std::uint32_t index, float selection, const Vec3& position) {
  LightSample s;
  s.is_delta = true;
  s.light = index;
  if (light.kind == PunctualLight::kDirectional) {
    s.wi = Vec3(0 - light.direction.x, 0 - light.direction.y, 0 - light.direction.z);
    s.distance = std::numeric_limits<float>::infinity();
    s.radiance = light.intensity;
    s.pdf = selection;
    return s;
  }
  // Division by distance² in two steps, so that neither tiny nor huge scenes leave the range of floats early.
  const float dx = light.position.x - position.x, dy = light.position.y - position.y, dz = light.position.z - position.z;
  const float squared = (dx * dx + dy * dy) + dz * dz;
  const float distance = std::sqrt(squared);
  const float inverse = squared > 0 ? 1 / distance : 0.f;
  s.wi = {dx * inverse, dy * inverse, dz * inverse};
  s.distance = distance;
  s.point = light.position;
  s.radiance = {(light.intensity.x * inverse) * inverse, (light.intensity.y * inverse) * inverse, (light.intensity.z * inverse) * inverse};
  s.pdf = squared > 0 ? selection : 0.f;
  if (light.kind == PunctualLight::kSpot) {
    const float falloff = spot_falloff(light, -(s.wi.x * light.direction.x + s.wi.y * light.direction.y + s.wi.z * light.direction.z));
    s.radiance *= falloff;
    if (falloff == 0) s.pdf = 0;
  }
  return s;
}

}  // namespace sightline
