// A hit with all that scattering needs, and scattering there of light that comes from either end of a path.
#pragma once

#include <cstdint>
#include <optional>

#include "base/math/frame.h"
#include "base/math/vec.h"
#include "scene/ids.h"
#include "shade/bsdf.h"
#include "world/world.h"

namespace sightline::vpl {

struct SurfacePoint {
  Vec3 position{0};
  Vec3 geometric_normal{0, 0, 1};  ///< unit, by winding
  float error = 0;                 ///< of the position, per component
  Frame3 frame;                    ///< shading frame, its normal on the side of the geometric one
  bool plain = false;              ///< Lambert without maps
  MediumId interior;               ///< behind the surface
  Bsdf bsdf;
};

/// Whether light passes through to the other side and is spread there.
bool is_translucent(const Bsdf& bsdf);

/// The frame in which light from or to unit direction `w` is scattered: shading normals give way where they do not see `w` on the side on
/// which the geometric normal does.
Frame3 frame_towards(const Frame3& frame, const Vec3& geometric_normal, const Vec3& w, bool plain);

/// f(wo, wi) |cos wi| by the shading normal, wo towards the eye, wi towards the light: what the reference integrates. Without deltas.
Color scattered(const Bsdf& bsdf, const Frame3& frame, const Vec3& geometric_normal, bool plain, const Vec3& wo, const Vec3& wi);
inline Color scattered(const SurfacePoint& s, const Vec3& wo, const Vec3& wi) {
  return scattered(s.bsdf, s.frame, s.geometric_normal, s.plain, wo, wi);
}

/// The next direction of a path.
struct Turn {
  Vec3 direction{0, 0, 1};
  /// Factor of the throughput. On light paths it takes flux over the geometric cosine of arrival to flux, so that shading normals do to
  /// light what they do to eye paths [Veach1997, §5.3].
  Color weight{0};
  float pdf = 0;  ///< by solid angle; 0 where delta
  bool is_delta = false, crosses = false;
};
/// Light that arrives from unit `wi` goes on.
std::optional<Turn> turn_light(const SurfacePoint& surface, const Vec3& wi, float u_lobe, const Vec2& u);
/// Density with which it goes on along `wo`, apart from deltas.
float light_turn_pdf(const SurfacePoint& surface, const Vec3& wi, const Vec3& wo);
/// An eye path that arrived from unit `wo` goes on at a delta surface.
std::optional<Turn> turn_eye(const SurfacePoint& surface, const Vec3& wo, float u_lobe, const Vec2& u);

/// Makes surface points of hits.
class SurfaceReader {
 public:
  explicit SurfaceReader(const World& world);
  SurfacePoint read(const RayBatch& rays, const HitBatch& hits, const SurfaceBatch& surfaces, std::size_t i, float cone_width,
                    float u_mix) const;

 private:
  const World& world_;
  bool has_media_;
};

}  // namespace sightline::vpl
