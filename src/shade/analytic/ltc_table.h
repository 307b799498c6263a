// Layout of the tables of linearly transformed cosines, which tools/fit_ltc writes.
#pragma once

#include <algorithm>
#include <cmath>

namespace sightline::ltc_table {

inline constexpr int kCosCount = 64;    // cos = t², t in equal steps over [0, 1]: closer at grazing angles
inline constexpr int kAlphaCount = 32;  // alpha = r², r in equal steps over [0, 1]

constexpr double cos_at(int i) { return static_cast<double>(i * i) / ((kCosCount - 1) * (kCosCount - 1)); }
constexpr double alpha_at(int i) { return static_cast<double>(i * i) / ((kAlphaCount - 1) * (kAlphaCount - 1)); }

/// What a node holds of the specular lobe (see LtcLobe): first the elements of the matrix, less those to which they tend for alpha -> 0,
/// that is [[cos², 0, sin cos], [0, 1, 0], [-2 alpha sin cos, 0, 2 alpha cos²]], so that narrow lobes stay where they belong between nodes.
enum LobeColumn { kM11, kM13OverSine, kM31OverSineAlpha, kM33OverAlpha, kEnergy, kSchlick, kMetal, kLobeColumns };
extern const float kLobe[kAlphaCount][kCosCount][kLobeColumns];

/// What a node holds of the specular albedo E as the diffuse part below feels it, for F = 1 (first) and F = (1 - cos)^5 (second):
/// E(cos) = mean + amount (g(cos) - 1), g = the ratio of the cosine lobe stretched by `stretch` to the plain one.
enum DiffuseColumn { kStretch, kMeanFull, kMeanSchlick, kAmountFull, kAmountSchlick, kDiffuseColumns };
extern const float kDiffuse[kAlphaCount][kDiffuseColumns];

/// Ratio of the stretched cosine lobe to the plain one.
inline double stretched_ratio(double cosine, double stretch) {
  const double squared = cosine * cosine + (1 - cosine * cosine) / (stretch * stretch);
  return 1 / (stretch * stretch * squared * squared);
}

}  // namespace sightline::ltc_table
