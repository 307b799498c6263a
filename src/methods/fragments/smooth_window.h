// The filter of smooth.h at single pixels and at rows of them.
#pragma once

#include <cstdint>
#include <span>

#include "methods/fragments/g_buffer.h"

namespace sightline {

struct SmoothInput {
  const GBuffer& g;
  std::span<const float> signal;
  std::span<const std::uint8_t> level;
};

namespace smoothing {

inline constexpr int kRadius = 2;
inline constexpr float kWhole = 25;  ///< pixels of a whole window
/// Pixels from one of the window to the next, by level. Probes of a fragment share their light points, so their errors are alike: the
/// window has to span some fragments.
constexpr int step_of(int level) { return level < 2 ? 1 : level == 2 ? 2 : 4; }
/// The level of a pixel's window is the coarsest around it, so far away, up to this one.
inline constexpr int kFar = 3, kMixedLevel = 2;
/// Large fragments may be stable by chance: where the widest window sees more than noise, one half as wide is tried.
constexpr int narrowest_step(int widest) { return widest == 4 ? 2 : widest; }
/// Variance of 64 and of 16 stratified rays. A straight border crosses 8 of 8 x 8 strata and 4 of 4 x 4, a quarter each at most; twice
/// that, since borders are not always straight, nor occluders only one.
inline constexpr float kFineVariance = 2 * 8 * 0.25f / (64 * 64);
inline constexpr float kProbeVariance = 2 * 4 * 0.25f / (16 * 16);
/// Near 0 and 1 a border crosses fewer strata.
inline constexpr float kTaper = 8;
/// Steps of a 64th are noise too.
inline constexpr float kLeastVariance = 0.03f / (64 * 64);
/// Square of what curvature adds at the centre, in variances: up to the first it is noise, from the second on it is not.
inline constexpr float kFlat = 0.1f, kCurved = 0.3f;
/// Mean squared distance from the fit, in variances, up to which noise explains it; beyond twice that the pixel keeps its value.
inline constexpr float kAllowed = 1.5f;
/// Squared slope from one pixel of the window to the next at which nothing is allowed any more: a steep penumbra is narrow, so that its
/// ends are in the window, and the error of missing them grows with the slope. (Penumbrae of 4 pixels must not get worse.)
inline constexpr float kSteep = 0.016f;
/// With fewer pixels a plane says nothing.
inline constexpr float kLeastCount = 10;
/// What is one surface, as for upsampling.
inline constexpr float kMinCosine = 0.985f, kMaxPlaneDistance = 0.02f, kMaxSlope = 0.35f;
/// Keeps the fit regular where all pixels lie on one line.
inline constexpr float kRidge = 1e-3f;

}  // namespace smoothing

/// The level that decides how far apart the window's pixels lie: where small fragments are mixed, the noise that the larger ones have in
/// common surrounds the smaller ones, too.
std::uint8_t window_level(const SmoothInput& input, int x, int y);
/// Value of pixel (x, y). The definition.
float smooth_pixel(const SmoothInput& input, int x, int y);
/// The same within 2e-5 for `count` pixels from (x, y) on.
void smooth_row(const SmoothInput& input, int x, int y, int count, float* out);

}  // namespace sightline
