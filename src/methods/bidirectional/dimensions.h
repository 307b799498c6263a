// Which pair of random numbers serves what. Eye paths use the table that all methods share; light paths have a range of their own.
#pragma once

#include "base/sample/sobol.h"

namespace sightline::bidirectional {

inline constexpr std::uint32_t kLightPath = 0x20000000u;
inline constexpr std::uint32_t kEmissionPick = kLightPath;       ///< x: which light
inline constexpr std::uint32_t kEmissionPoint = kLightPath + 1;  ///< point on it, or place across the beam
inline constexpr std::uint32_t kEmissionDirection = kLightPath + 2;

enum LightPathUse : std::uint32_t {
  kMix = 0,        ///< x: mix material
  kLightLobe = 1,  ///< x: BSDF lobe; y: Russian roulette
  kLightTurn = 2,  ///< BSDF direction
  kLensPoint = 3,  ///< of the light image
};
/// Bounce 0 is the first surface that the light reaches; the light itself has the lens point of bounce -1.
constexpr std::uint32_t light_pair(std::uint32_t bounce, LightPathUse use) { return kLightPath + 7 + 4 * bounce + use; }
inline constexpr std::uint32_t kLightLens = kLightPath + 6;

}  // namespace sightline::bidirectional
