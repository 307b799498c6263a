// Hit points reconstructed from barycentrics, in batches.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "base/core/aligned.h"
#include "base/math/frame.h"
#include "base/math/vec.h"
#include "scene/ids.h"
#include "texture/texture_set.h"
#include "trace/ray_batch.h"

namespace sightline {

/// What a path needs of every hit: structure of arrays, padded to kLanes. Lanes without a hit have material kNoHit and zero vectors.
struct SurfaceBatch {
  Vec3Batch position;                     ///< from barycentrics on the original vertices
  Vec3Batch geometric_normal;             ///< unit, by winding (not flipped towards the ray)
  Vec3Batch shading_normal;               ///< unit, interpolated, on the geometric normal's side
  AlignedVector<float> error;             ///< bound on the distance of `position` from the true surface point, per component
  AlignedVector<std::uint32_t> material;  ///< index into Scene::materials, kDefaultMaterial, or kNoHit
  AlignedVector<std::uint32_t> light;     ///< entry of the LightTable that emits here, or kNoLight
  AlignedVector<std::uint8_t> plain;      ///< 1: untextured Lambert without normal map: albedo holds all there is to know
  Vec3Batch albedo;                       ///< valid where plain
  /// Only with WorldOptions::shadow_terminator, else empty: to be added to the origin of rays that leave on the side that the ray came
  /// from.
  Vec3Batch shadow_offset;
  std::size_t size = 0;
  void resize(std::size_t n);
};

inline constexpr std::uint32_t kDefaultMaterial = 0xfffffffeu;

/// The rest, for one hit: computed only where a material needs it.
struct SurfaceDetail {
  Vec2 uv{0};
  Vec3 dp_du{1, 0, 0}, dp_dv{0, 1, 0};
  Vec3 dn_du{0}, dn_dv{0};  ///< change of frame.normal that goes with them: 0 on flat triangles
  Frame3 frame;             ///< shading frame before normal maps: normal and tangent
  TexturePoint texture;     ///< uv with footprint
};

/// Origin of a ray that leaves `position` towards the side of unit geometric normal `n` on which `direction` lies, moved by the error
/// bound so that it cannot hit its own surface ([Waechter2019] and pbrt's error-bounds idea).
inline Vec3 offset_origin(const Vec3& position, const Vec3& n, float error, const Vec3& direction) {
  const float distance = error * (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
  return position + (glm::dot(direction, n) >= 0 ? distance : -distance) * n;
}

/// Where shadow rays of a coarse mesh with smooth normals should start, relative to the point with barycentrics `b` [Hanika2021]: on the
/// curved surface that the vertex normals suggest, so that the shadow's edge follows the shading instead of the facets. Zero on concave
/// patches and where the normals agree with the facet. `normals` are unit and on the side of the incoming ray.
inline Vec3 terminator_offset(const std::array<Vec3, 3>& vertices, const std::array<Vec3, 3>& normals, const Vec3& b) {
  const Vec3 point = b.x * vertices[0] + b.y * vertices[1] + b.z * vertices[2];
  Vec3 offset{0};
  // Each vertex' tangent plane lifts the point by its height below the plane; heights are blended as the normals are.
  for (int i = 0; i < 3; ++i) offset -= b[i] * std::fmin(0.f, glm::dot(point - vertices[i], normals[i])) * normals[i];
  return offset;
}

}  // namespace sightline
