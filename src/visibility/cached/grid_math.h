// Polynomials and limits that scalar and vector quantisation share.
#pragma once

#include <cstdint>

namespace sightline {

struct GridMath {
  static constexpr std::int32_t kSqrtHalfBits = 0x3f3504f3;
  /// log2(1 + t) / t for t in [sqrt(1/2) - 1, sqrt(2) - 1], error of the logarithm 4.2e-6.
  static constexpr float kLog2[6] = {1.4427004f, -0.72119575f, 0.47992557f, -0.36692577f, 0.31689819f, -0.20228926f};
  /// 2/pi atan(sqrt(s)) / sqrt(s) for s in [0, 1], error of the angle 1.8e-6.
  static constexpr float kAtan[6] = {0.63661648f, -0.21196708f, 0.1243615f, -0.07667995f, 0.0360263f, -0.00835906f};
  /// Areas whose logarithm is taken; others count as not known.
  static constexpr float kLeastArea = 1e-36f, kMostArea = 1e36f;
  /// Sum of grid coordinates beyond which a point counts as not known: keeps cell numbers in 31 bits.
  static constexpr float kFarthest = 100;
};

}  // namespace sightline
