// From a scene's material at a texture point to the BSDF there.
#pragma once

#include "base/math/frame.h"
#include "scene/scene.h"
#include "shade/bsdf.h"
#include "texture/texture_set.h"

namespace sightline {

/// The BSDF of `material` (invalid = Lambert 0.7) at a point. `u_mix` in [0,1) resolves mix materials. Interface materials and back faces
/// are the caller's business (is_interface).
Bsdf make_bsdf(const Scene& scene, const TextureSet& textures, MaterialId material, const TexturePoint& point, float u_mix);

/// The material that a mix resolves to, `u_mix` being rescaled on the way; itself for others.
MaterialId resolve_mix(const Scene& scene, const TextureSet& textures, MaterialId material, const TexturePoint& point, float& u_mix);

bool is_interface(const Scene& scene, MaterialId material);

/// Normal and bump mapping: `frame` is the interpolated shading frame (normal, dp/du tangent), `dp_du`, `dp_dv` the surface's parametric
/// derivatives, `dn_du`, `dn_dv` the change of that normal along them. Returns a frame whose normal lies on the side of `geometric_normal`
/// and, given unit `wo`, sees wo on the side on which the geometric normal sees it; this holds also for materials without a map, whose
/// interpolated normals may fail it. wo = 0: not known.
Frame3 perturb_frame(const Scene& scene, const TextureSet& textures, MaterialId material, const TexturePoint& point, const Frame3& frame,
                     const Vec3& dp_du, const Vec3& dp_dv, const Vec3& dn_du, const Vec3& dn_dv, const Vec3& geometric_normal,
                     const Vec3& wo = Vec3(0));

/// The same on a surface whose normal does not turn.
inline Frame3 perturb_frame(const Scene& scene, const TextureSet& textures, MaterialId material, const TexturePoint& point,
                            const Frame3& frame, const Vec3& dp_du, const Vec3& dp_dv, const Vec3& geometric_normal,
                            const Vec3& wo = Vec3(0)) {
  return perturb_frame(scene, textures, material, point, frame, dp_du, dp_dv, Vec3(0), Vec3(0), geometric_normal, wo);
}

/// The last step of it alone: `frame` with the maps applied, turned as little as that takes; a turned frame is built on `tangent`.
Frame3 face_viewer(const Frame3& frame, const Vec3& tangent, const Vec3& geometric_normal, const Vec3& wo);

}  // namespace sightline
