// Linearly transformed cosines [Heitz2016] for the GGX lobe of ggx.h.
//
// Deviation: the transform keeps the x, y and z of the surface's frame and has four free elements, fitted together. In [Heitz2016] the lobe
// may reach below the surface, whose light then counts, and is cut off at a plane of its own; here polygons are cut at the horizon of the
// surface and the cosine keeps its sign. So nothing shines through a floor, and one cut serves the diffuse and the specular part.
#pragma once

#include "base/math/vec.h"
#include "shade/ggx.h"

namespace sightline {

/// The lobe f cos of one direction wo, in coordinates where z is the normal and wo lies in the xz plane with x >= 0: about
/// energy * scale * (cosine lobe through the inverse of [[m11, 0, m13], [0, 1, 0], [m31, 0, m33]]).
struct LtcLobe {
  float m11 = 1, m13 = 0, m31 = 0, m33 = 1;
  float scale = 1;    ///< makes the signed cosine integrate to 1 over the upper hemisphere
  float energy = 1;   ///< integral of f cos for F = 1,
  float schlick = 0;  ///< for F = (1 - cos)^5,
  float metal = 0;    ///< and for F = cos (1 - cos)^6 [Lazanyi2005]

  glm::dmat3 matrix() const { return {m11, 0, m31, 0, 1, 0, m13, 0, m33}; }
};

/// cos_o >= 0; isotropic, not smooth. Bilinear in a table.
LtcLobe ltc_lobe(float cos_o, float alpha);

/// The specular albedo that a diffuse layer feels above it [Kulla2017], as cosines: E(cos) = mean + amount (g(cos) - 1), where g is the
/// ratio of a cosine lobe stretched by `stretch` to the plain one. First the part that F0 multiplies, second the part that 1 - F0
/// multiplies.
struct CoatAlbedoFit {
  float stretch = 1;
  Vec2 mean{0}, amount{0};
};
CoatAlbedoFit coat_albedo_fit(const Ggx& ggx);

}  // namespace sightline
