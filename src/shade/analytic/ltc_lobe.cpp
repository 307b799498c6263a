#include "shade/analytic/ltc_lobe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "shade/analytic/ltc_table.h"

namespace sightline {

namespace {

using namespace ltc_table;

/// Where `position` in [0, 1] lies between the nodes of an axis.
struct AxisPlace {
  std::size_t low;
  float fraction;
  AxisPlace(float position, int count) {
    const float scaled = (position > 0 ? std::min(position, 1.f) : 0.f) * static_cast<float>(count - 1);
    low = static_cast<std::size_t>(std::min(static_cast<int>(scaled), count - 2));
    fraction = scaled - static_cast<float>(low);
  }
};

}  // namespace

LtcLobe ltc_lobe(float cos_o, float alpha) {
  const float cosine = std::clamp(cos_o, 0.f, 1.f);
  const AxisPlace c(std::sqrt(cosine), kCosCount), a(std::sqrt(alpha), kAlphaCount);
  const auto row = [&](std::size_t i, std::size_t k) {
    const float first = kLobe[i][c.low][k], second = kLobe[i][c.low + 1][k];
    return first + c.fraction * (second - first);
  };
  std::array<float, kLobeColumns> value;
  for (std::size_t k = 0; k < kEnergy; ++k) {
    const float low = row(a.low, k);
    value[k] = low + a.fraction * (row(a.low + 1, k) - low);
  }
  // Energies of smooth surfaces near grazing bend with the fourth power of the roughness: a cubic through four nodes [Catmull1974].
  const float t = a.fraction;
  for (std::size_t k = kEnergy; k < kLobeColumns; ++k) {
    const float p1 = row(a.low, k), p2 = row(a.low + 1, k);
    const float p0 = a.low > 0 ? row(a.low - 1, k) : p1, p3 = a.low + 2 < kAlphaCount ? row(a.low + 2, k) : 2 * p2 - p1;
    value[k] = p1 + 0.5f * t * (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * (p1 - p2) + p3 - p0)));
  }
  const float sine = std::sqrt(std::max(0.f, (1 - cosine) * (1 + cosine)));
  LtcLobe lobe;
  lobe.m11 = value[kM11] + cosine * cosine;
  lobe.m13 = (value[kM13OverSine] + cosine) * sine;
  lobe.m31 = (value[kM31OverSineAlpha] - 2 * cosine) * sine * alpha;
  lobe.m33 = (value[kM33OverAlpha] + 2 * cosine * cosine) * alpha;
  // The upper hemisphere becomes one whose pole has the z component m11 / |(m11, m31)|: its share of the cosine lobe.
  lobe.scale = std::sqrt(lobe.m11 * lobe.m11 + lobe.m31 * lobe.m31) / lobe.m11;
  lobe.energy = value[kEnergy], lobe.schlick = value[kSchlick], lobe.metal = value[kMetal];
  return lobe;
}

CoatAlbedoFit coat_albedo_fit(const Ggx& ggx) {
  const AxisPlace a(ggx.is_smooth() ? 0.f : std::sqrt(std::sqrt(ggx.alpha().x * ggx.alpha().y)), kAlphaCount);
  const auto value = [&](std::size_t k) { return kDiffuse[a.low][k] + a.fraction * (kDiffuse[a.low + 1][k] - kDiffuse[a.low][k]); };
  return {value(kStretch), {value(kMeanFull), value(kMeanSchlick)}, {value(kAmountFull), value(kAmountSchlick)}};
}

}  // namespace sightline
