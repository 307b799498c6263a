// Layout of the albedo tables; used by ggx_albedo.cpp and by the test that writes and checks them.
#pragma once

#include "base/math/vec.h"

namespace sightline::ggx_table {

inline constexpr int kCosCount = 16;    // cos = t², t in equal steps over [0, 1]: closer at grazing angles
inline constexpr int kAlphaCount = 16;  // alpha = r², r in equal steps over [0, 1]
inline constexpr int kEtaCount = 9;     // (eta - 1) / (eta + 1) in equal steps over [0, 1/2]

constexpr float cos_at(int i) { return static_cast<float>(i * i) / ((kCosCount - 1) * (kCosCount - 1)); }
constexpr float alpha_at(int i) { return static_cast<float>(i * i) / ((kAlphaCount - 1) * (kAlphaCount - 1)); }
constexpr float eta_at(int i) { return (1 + 0.5f * i / (kEtaCount - 1)) / (1 - 0.5f * i / (kEtaCount - 1)); }

extern const float kDielectric[kEtaCount][kAlphaCount][kCosCount];
extern const float kDielectricMean[kEtaCount][kAlphaCount];
/// First the part that f0 multiplies, second the part that 1 - f0 multiplies.
extern const float kSchlick[kAlphaCount][kCosCount][2];
extern const float kSchlickMean[kAlphaCount][2];

}  // namespace sightline::ggx_table
