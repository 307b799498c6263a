// The other way of sampling lights: rays that leave them, for paths that begin there.
#pragma once

#include <cmath>

#include "base/math/bounds.h"
#include "shade/light_table.h"
#include "shade/lights/flat_light.h"
#include "shade/lights/punctual_light.h"
#include "shade/lights/sphere_sampling.h"

namespace sightline {

/// The disk through which light from infinity enters: as wide as the scene's bounding sphere, and behind the scene.
struct LightBeam {
  explicit LightBeam(const Bounds& bounds)
      : center(bounds.is_empty() ? Vec3(0) : bounds.center()),
        radius(bounds.half_diagonal() > 0 && std::isfinite(bounds.half_diagonal()) ? bounds.half_diagonal() : 1.f) {}

  /// Density by area across the beam.
  float pdf() const { return 1 / (kPi * radius * radius); }
  /// Where a ray that travels along unit `direction` enters.
  Vec3 origin(const Vec3& direction, const Vec2& u) const;

  Vec3 center;
  float radius;
};

/// Samples without texture; `selection` is the probability with which the light was chosen. Their densities: emission_pdf of each kind.
EmissionSample sample_flat_emission(const FlatLight& light, const FlatEmitter& emitter, float selection, const Vec2& u_point,
                                    const Vec2& u_direction);
EmissionPdf flat_emission_pdf(const FlatLight& light, const FlatEmitter& emitter, float selection, const Vec3& direction);

EmissionSample sample_sphere_emission(const SphereEmitter& sphere, float selection, const Vec2& u_point, const Vec2& u_direction);
EmissionPdf sphere_emission_pdf(const SphereEmitter& sphere, float selection, const Vec3& point, const Vec3& direction);

EmissionSample sample_punctual_emission(const PunctualLight& light, float selection, const LightBeam& beam, const Vec2& u_point,
                                        const Vec2& u_direction);
EmissionPdf punctual_emission_pdf(const PunctualLight& light, float selection, const LightBeam& beam, const Vec3& direction);

}  // namespace sightline
