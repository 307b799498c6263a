// Virtual point lights [Keller1997], resampled by what they send to the eye [Segovia2006].
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "base/math/frame.h"
#include "film/view.h"
#include "shade/bsdf.h"
#include "trace/ray_batch.h"
#include "world/world.h"

namespace sightline {

struct VirtualPointLightOptions {
  int count = 256;               ///< M: lights kept (fewer after duplicates are merged)
  int candidates = 8;            ///< M_c / M
  int eye_samples = 64;          ///< that judge the candidates
  float backward_share = 0.5f;   ///< of the candidates: made by paths from the eye samples, connected to lights
  float clamp_distance = 0.02f;  ///< the geometry term is clamped at 1 / (clamp_distance B_R)²; 0 = not clamped
  int max_bounces = 8;           ///< of light paths before the eye's surface, mirrors and glass included: 1 = light, VPL, eye
  std::uint64_t seed = 0;
  std::uint32_t pass = 0;  ///< absolute index of the pass: each has lights of its own
};

/// Points of surfaces that reflect light; structure of arrays, padded to kLanes (padding has flux 0).
struct VirtualPointLights {
  Vec3Batch position, normal;           ///< normal: unit geometric, on the side that the light arrived from
  Vec3Batch flux;                       ///< Φ: power carried, with all divisions by counts and probabilities done
  Vec3Batch radiosity;                  ///< where lambert: radiance_towards() every direction on the side of `normal`
  AlignedVector<float> error;           ///< of position
  AlignedVector<float> cell_area;       ///< 1 / (M P(p_l)) by k nearest neighbours: surface that one light stands for, world units²
  AlignedVector<std::uint8_t> lambert;  ///< 1: bsdf is Lambert and nothing else
  std::vector<Vec3> wi;                 ///< unit, towards where the light came from
  std::vector<Frame3> frame;            ///< shading frame, its normal on the side of the winding (Bsdf's outside), not of `normal`
  std::vector<Bsdf> bsdf;
  std::vector<std::optional<SurfaceLobes>> lobes;  ///< of bsdf seen from wi in `frame`, where it has that shape
  std::size_t size = 0;
  float max_geometry_term = 0;  ///< clamp for cos cos / r² of connections, world units⁻²; infinity without
};

/// What light `i` sends towards unit `w`: a surface at distance r receives irradiance of that times cos / r² times its own cosine. For
/// Lambert Φ reflectance / π, times shading over geometric cosine of the light's arrival, as paths from the eye have it [Veach1997, §5.3].
Color radiance_towards(const VirtualPointLights& lights, std::size_t i, const Vec3& w);

/// Lights of one pass; their expected contribution is light that was reflected once to max_bounces times before it reaches the surface
/// that the eye sees. With backward_share = 1 without mirrors, glass and what lies behind translucent surfaces, and only from surfaces that
/// one of the eye samples sees. The result depends on options and scene alone, not on the threads of `context`.
VirtualPointLights make_virtual_point_lights(const World& world, const View& view, const VirtualPointLightOptions& options,
                                             const Context& context, RayCounts& rays);

}  // namespace sightline
