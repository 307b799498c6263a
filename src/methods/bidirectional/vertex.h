// Vertices of subpaths, and scattering at them: one integrand for paths from both ends.
#pragma once

#include <cstdint>
#include <optional>

#include "base/math/frame.h"
#include "base/math/vec.h"
#include "methods/bidirectional/mis.h"
#include "scene/ids.h"
#include "shade/bsdf.h"
#include "world/world.h"

namespace sightline::bidirectional {

inline constexpr std::uint32_t kNoVertex = 0xffffffffu;

/// A surface as paths see it. The shading frame depends a little on the direction from which one looks (see frame_seen_from).
struct Surface {
  Vec3 position{0};
  Vec3 geometric_normal{0, 0, 1};  ///< unit, by winding
  float error = 0;                 ///< of the position, per component
  Frame3 frame;                    ///< before it is turned towards a viewer
  Vec3 tangent{1, 0, 0};           ///< that turned frames are built on
  bool plain = false;              ///< Lambert without maps: its frame gives way at once
  MediumId interior;               ///< behind the surface
  Bsdf bsdf;
  /// With a lifted shadow terminator: where rays leave from, and the normal by which sides are told apart. Densities keep to the facet.
  bool is_lifted = false;
  Vec3 lifted_position{0}, lifted_normal{0, 0, 1};

  const Vec3& leaving_position() const { return is_lifted ? lifted_position : position; }
  const Vec3& side_normal() const { return is_lifted ? lifted_normal : geometric_normal; }
};

struct PathVertex {
  Surface surface;
  Vec3 to_previous{0, 0, 1};  ///< unit
  /// Eye: throughput of importance that arrives. Light: radiant flux that arrives, over the cosine to the geometric normal; so the product
  /// with f cos of the surface is what leaves, by the eye's own conventions.
  Color beta{0};
  MisVertex mis;
  MediumId medium;  ///< that the last edge ran through
  std::uint32_t path = 0, previous = kNoVertex;
  std::uint32_t depth = 1;  ///< surfaces on the subpath so far, this one included
  bool connectible = true;  ///< has a part that is not a delta
};

/// The frame in which light from or to direction `w` is scattered: that of the reference, whose shading normals give way where they do not
/// see the viewer.
Frame3 frame_seen_from(const Surface& surface, const Vec3& w);

/// f(wo, wi) |cos wi| by the shading normal, with wo towards the eye and wi towards the light: what the reference integrates, wherever the
/// path came from. The densities are those with which either side's sampler continues, 0 where it would reject the direction.
struct ScatterEval {
  Color f_cos{0};
  float pdf_eye = 0;    ///< of wi given wo
  float pdf_light = 0;  ///< of wo given wi
};
ScatterEval evaluate_scatter(const Surface& surface, const Vec3& wo, const Vec3& wi);

/// The next direction of a subpath.
struct ScatterSample {
  Vec3 direction{0, 0, 1};
  /// Factor of the throughput: f cos / pdf on eye paths; on light paths times the geometric cosine of `direction`, still to be divided by
  /// that of the next vertex. So fluxes keep what shading normals do to eye paths [Veach1997, §5.3].
  Color weight{0};
  /// Densities of own and other side. Deltas have the probability of their lobe, times the change of solid angle that makes both
  /// measures of the same path comparable.
  float pdf = 0, pdf_reverse = 0;
  bool is_delta = false, crosses = false;
  float eta = 1;  ///< index of refraction passed into, over that left
};
std::optional<ScatterSample> sample_from_eye(const Surface& surface, const Vec3& wo, float u_lobe, const Vec2& u);
std::optional<ScatterSample> sample_from_light(const Surface& surface, const Vec3& wi, float u_lobe, const Vec2& u);

/// Of the side of the vertex towards `w`.
MediumId medium_towards(const PathVertex& vertex, const Vec3& w);

}  // namespace sightline::bidirectional
