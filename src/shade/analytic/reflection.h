// Light of a uniform polygon reflected towards a viewer, without shadows, for the materials of analytic_bsdf.h.
//
// Results are for unit radiance: times the emitter's radiance they are radiances. Surfaces reflect on the side on which wo is. Polygons and
// sides are as in polygon.h.
#pragma once

#include <span>

#include "shade/analytic/analytic_bsdf.h"
#include "shade/analytic/polygon.h"

namespace sightline {

/// The parts of the reflected radiance.
struct PolygonReflection {
  Color diffuse{0}, specular{0};
};

/// The definition, in double precision inside. `lobes` are those of `wo` (unit, world space, away from the surface).
PolygonReflection reflect_polygon(std::span<const Vec3> polygon, const Vec3& position, const Vec3& normal, const Vec3& wo,
                                  const AnalyticLobes& lobes, EmitterSides sides = EmitterSides::one);

/// AnalyticLobes of many points.
struct AnalyticLobesBatch {
  Vec3Batch diffuse, wide, specular;
  AlignedVector<float> stretch, m11, m13, m31, m33;
  void resize(std::size_t n);
  void set(std::size_t i, const AnalyticLobes& lobes);
};

/// Points seen from `wo`.
struct ReceiverBatch {
  const Vec3Batch& position;
  const Vec3Batch& normal;
  const Vec3Batch& wo;
  const AnalyticLobesBatch& lobes;
};

/// The same for points [0, count), in vectors; writes padded(count). Accurate as polygon_irradiance, narrow lobes less so: the form
/// factor of a lobe is good to 1e-4 for alpha >= 0.01. Parts that are black for all points cost nothing.
void reflect_polygon(std::span<const Vec3> polygon, const ReceiverBatch& receivers, std::size_t count, Vec3Batch& diffuse,
                     Vec3Batch& specular, EmitterSides sides = EmitterSides::one);
/// The specular part alone.
void ltc_specular(std::span<const Vec3> polygon, const ReceiverBatch& receivers, std::size_t count, Vec3Batch& specular,
                  EmitterSides sides = EmitterSides::one);

}  // namespace sightline
