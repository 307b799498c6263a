// Light of a flat emitter of uniform radiance in a GGX lobe, without shadows, by quadrature.
//
// Linearly transformed cosines are not GGX far from the mirror direction at grazing angles. Here the true lobe is summed over the emitter,
// at nodes that lie where the transformed cosine of the same direction has its peak and its tails: smooth in every argument, without noise.
#pragma once

#include "shade/analytic/reflection.h"
#include "shade/lights/flat_light.h"

namespace sightline {

/// An emitter as light_table.h has it: rectangle, triangle or disk.
struct FlatSurface {
  Vec3 origin{0}, e1{0}, e2{0}, normal{0};
  std::uint32_t flags = 0;  ///< FlatEmitter::Flags
  FlatSurface() = default;
  FlatSurface(const FlatLight& light, const FlatEmitter& emitter)
      : origin(light.origin), e1(light.e1), e2(light.e2), normal(light.normal), flags(emitter.flags) {}
};

/// Points, their surfaces' lobes (the matrix of LtcLobe and alpha) and what else is below their horizon.
struct LobeReceiverBatch {
  const Vec3Batch& position;
  const Vec3Batch& normal;
  const Vec3Batch& geometric_normal;
  const Vec3Batch& wo;
  const AnalyticLobesBatch& lobes;
  const AlignedVector<float>& alpha;
};

/// integral[i] = integrals of f cos over what emitter `surface` covers: x for F = 1, y for F = (1 - cos)^5, z for F = cos (1 - cos)^6, with
/// cos between wo and the half vector. Points [0, count); writes padded(count). Within 0.5 % for alpha >= 0.02
/// (disks: 5 % below 0.03, else 1 %), 3 % where the horizon cuts the emitter.
void ggx_over_surface(const FlatSurface& surface, const LobeReceiverBatch& receivers, std::size_t count, Vec3Batch& integral);

/// The reflected radiance, per unit of the emitter's.
inline Color specular_of(const AnalyticBsdf& bsdf, const Vec3& integral) {
  return bsdf.scale * (bsdf.f0 * integral.x + (1.f - bsdf.f0) * integral.y + bsdf.metal * integral.z);
}

}  // namespace sightline
