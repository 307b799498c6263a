// Lobes too narrow for 32 x 32 cells: Gaussians around the mirror direction, integrated over squares by formula.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/core/context.h"
#include "base/math/frame.h"
#include "methods/square_lights/shade_lanes.h"
#include "shade/bsdf.h"

namespace sightline::square_lights {

/// The sharp part of an isotropic BSDF's f cos, by view angle. In Lambert's azimuthal coordinates (x, y) about the mirror direction, x in
/// the plane of incidence, a spherical Gaussian exp(l (cos g - 1)) is exactly exp(-l (x² + y²) / 2): separable, and its integral over a
/// square is a product of error functions. Four of them, whose widths stand 1 : 2 : 4 : 8, fit lobes with tails like that of GGX. What they
/// miss stays in the table, which is made of the difference (BrdfTable::build), so that nothing is lost or counted twice. Parameters, not
/// lobes, are interpolated between views: highlights move with the view instead of fading from place to place.
class SharpLobe {
 public:
  static constexpr int kTerms = 4;

  SharpLobe() = default;
  /// Finds the lobe by evaluating the BSDF around the mirror direction; empty for anisotropic ones and where it is wider than about 5°.
  static SharpLobe fit(const Bsdf& bsdf);
  bool empty() const { return views_.empty(); }

  /// The lobe for one view direction (local, unit, z > 0).
  struct View {
    Frame3 frame;                            ///< normal: the mirror direction; tangent: in the plane of incidence
    float sharpness_x = 1, sharpness_y = 1;  ///< of the second term; the others' are 4, 1/4 and 1/16 of it
    std::array<Color, kTerms> amplitude{};
  };
  View view(const Vec3& wo) const;
  /// f cos of the lobe for a local direction above the horizon.
  static Color value(const View& view, const Vec3& wi);
  /// Its mean over the square light of half diagonal `r` around local direction `c`.
  static Color mean(const View& view, const Vec3& c, float r);

 private:
  struct Parameters {
    float sharpness_x = 1, sharpness_y = 1;
    std::array<Color, kTerms> amplitude{};
  };
  static Parameters fit_view(const Bsdf& bsdf, const Vec3& wo);

  std::vector<Parameters> views_;  ///< over angles from the normal to the horizon
};

/// Outgoing radiance of the lobe alone: sum over lights of I 2 r² visible x mean, lights and frame in one space. To be added to shade().
Color shade_lobe(const SharpLobe::View& view, const Frame3& frame, const LightSet& lights, std::span<const float> visible);

}  // namespace sightline::square_lights
