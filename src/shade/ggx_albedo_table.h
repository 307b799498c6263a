// Layout of the albedo tables; used by ggx_albedo.cpp and by the test that writes and checks them.
#pragma once

#include "base/math/vec.h"

namespace sightline::ggx_table {

inline constexpr int kCosCount = 16;    // cos = t², t in equal steps over [0, 1]: closer at grazing angles
inline constexpr int kAlphaCount = 16;  // alpha = r², r in equal steps over [0, 1]
inline constexpr int kEtaCount = 9;     // (eta - 1) / (eta + 1) = e² / 2, e in equal steps over [0, 1]

constexpr float cos_at(int i) { return static_cast<float>(i * i) / ((kCosCount - 1) * (kCosCount - 1)); }
constexpr float alpha_at(int i) { return static_cast<float>(i * i) / ((kAlphaCount - 1) * (kAlphaCount - 1)); }
constexpr float eta_at(int i) {
  const float contrast = 0.5f * static_cast<float>(i * i) / ((kEtaCount - 1) * (kEtaCount - 1));
  return (1 + contrast) / (1 - contrast);
}

/// Rough over smooth reflectance, which varies far less than either. Entries are raised where interpolation would fall below the truth. The
/// entries of eta = 1 are those of kLeastEta.
inline constexpr float kLeastEta = 1.01f;
extern const float kDielectric[kEtaCount][kAlphaCount][kCosCount];
/// Mean albedo over (eta - 1) / (eta + 1).
extern const float kDielectricMean[kEtaCount][kAlphaCount];
/// First the part that f0 multiplies, second the part that 1 - f0 multiplies.
extern const float kSchlick[kAlphaCount][kCosCount][2];
extern const float kSchlickMean[kAlphaCount][2];

}  // namespace sightline::ggx_table
