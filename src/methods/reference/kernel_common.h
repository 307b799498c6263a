// What the files of the path kernel share.
#pragma once

namespace sightline {

/// Power heuristic with exponent 2 [Veach1997, §9.2.4]; n light samples against one BSDF sample.
inline float power_heuristic(float n_pdf, float other) {
  const float a = n_pdf * n_pdf, b = other * other;
  return a + b > 0 ? a / (a + b) : 0.f;
}

}  // namespace sightline
