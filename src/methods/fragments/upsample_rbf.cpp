#include "methods/fragments/upsample_rbf.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sightline {
namespace {

constexpr std::size_t kMax = 4;
// Keeps the matrix regular where samples nearly coincide. Below the least pivot the weighted mean [Koa2017, Eq. 9] is used instead.
constexpr float kRidge = 1e-6f, kMinPivot = 1e-5f;
// How far interpolation may leave the range of its samples.
constexpr float kOvershoot = 0.1f;

struct Chosen {
  std::size_t count = 0;
  std::array<float, kMax> x, y, width, level;
  std::array<std::array<float, kMax>, 3> value;

  void add(float sx, float sy, float w, float l) { x[count] = sx, y[count] = sy, width[count] = w, level[count] = l; }
};

Chosen choose(const RbfRegion& region, float tx, float ty) {
  Chosen set;
  set.add(region.own.x, region.own.y, static_cast<float>(region.own.width), static_cast<float>(region.own.level));
  for (std::size_t c = 0; c < static_cast<std::size_t>(region.channels); ++c) set.value[c][0] = region.own.value[c];
  set.count = 1;
  for (const RbfCandidates* list : region.candidates) {
    if (!list) continue;
    float best = 4 * region.cell_width * region.cell_width;
    std::size_t nearest = list->count;
    for (std::size_t i = 0; i < list->count; ++i) {
      const float dx = list->x[i] - tx, dy = list->y[i] - ty, d = dx * dx + dy * dy;
      if (d < best) best = d, nearest = i;
    }
    if (nearest == list->count) continue;
    const float x = list->x[nearest], y = list->y[nearest];
    bool again = false;
    for (std::size_t i = 0; i < set.count; ++i) again = again || (set.x[i] == x && set.y[i] == y);
    if (again) continue;
    set.add(x, y, list->width[nearest], list->level[nearest]);
    for (std::size_t c = 0; c < static_cast<std::size_t>(region.channels); ++c) set.value[c][set.count] = list->value[c][nearest];
    ++set.count;
  }
  return set;
}

struct Weights {
  // The value is mean + sum of weight * (value - mean), mean = sum of alpha * value.
  std::array<float, kMax> alpha, weight;
};

// What samples weigh does not depend on their values: one solution serves all channels. The system is symmetric, so solving it for the
// texel's kernel values gives these weights.
Weights weigh(const Chosen& set, const RbfRegion& region, float tx, float ty) {
  const float per_width = 1 / region.cell_width;
  const std::size_t n = set.count;
  std::array<float, kMax> x, y, d2;
  float t_min = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = (set.x[i] - tx) * per_width, y[i] = (set.y[i] - ty) * per_width;
    d2[i] = x[i] * x[i] + y[i] * y[i];
    t_min = std::min(t_min, set.width[i]);
  }
  Weights result{};
  float sum = 0, level = 0;
  for (std::size_t i = 0; i < n; ++i) {  // [Koa2017, Eqs. 7-8]
    result.alpha[i] = std::exp(-d2[i] / (2 * t_min));
    sum += result.alpha[i], level += result.alpha[i] * set.level[i];
  }
  const float minus_per_c = region.adaptive ? -0.5f / (level / sum + 1) : -1.f;  // [Koa2017, Eq. 6]
  for (std::size_t i = 0; i < n; ++i) result.alpha[i] /= sum;
  std::array<float, kMax> phi;
  float phi_sum = 0;
  for (std::size_t i = 0; i < n; ++i) phi[i] = std::exp(d2[i] * minus_per_c), phi_sum += phi[i];

  if (n >= 3) {  // [Koa2017, Eqs. 4-5]: L D L' = Phi, without square roots
    std::array<std::array<float, kMax>, kMax> l;
    std::array<float, kMax> pivot, z;
    float least = 1;
    for (std::size_t i = 0; i < n; ++i) {
      float diagonal = 1 + kRidge;
      z[i] = phi[i];
      for (std::size_t j = 0; j < i; ++j) {
        const float dx = x[i] - x[j], dy = y[i] - y[j];
        float sum_ij = std::exp((dx * dx + dy * dy) * minus_per_c);
        for (std::size_t k = 0; k < j; ++k) sum_ij -= l[i][k] * l[j][k] * pivot[k];
        l[i][j] = sum_ij / pivot[j];
        diagonal -= l[i][j] * sum_ij;
        z[i] -= l[i][j] * z[j];
      }
      pivot[i] = std::max(diagonal, 1e-20f), least = std::min(least, diagonal);
    }
    if (least >= kMinPivot) {
      for (std::size_t i = n; i-- > 0;) {
        result.weight[i] = z[i] / pivot[i];
        for (std::size_t j = i + 1; j < n; ++j) result.weight[i] -= l[j][i] * result.weight[j];
      }
      return result;
    }
  }
  for (std::size_t i = 0; i < n; ++i) result.weight[i] = phi[i] / phi_sum;  // [Koa2017, Eq. 9], for any number of samples
  return result;
}

float combine(const std::array<float, kMax>& value, std::size_t n, const Weights& weights, bool share) {
  float low = value[0], high = value[0], mean = 0;
  for (std::size_t i = 1; i < n; ++i) {
    low = std::min(low, value[i]), high = std::max(high, value[i]);
    mean += weights.alpha[i] * (value[i] - value[0]);
  }
  // Deviation: the samples' weighted mean is taken out first, without which a constant field is not reproduced.
  mean += value[0];
  float result = mean;
  for (std::size_t i = 0; i < n; ++i) result += weights.weight[i] * (value[i] - mean);
  const float margin = kOvershoot * (high - low);
  result = std::clamp(result, std::max(low - margin, 0.f), std::max(high + margin, 0.f));
  return share ? std::min(result, 1.f) : result;
}

}  // namespace

void rbf_region(const RbfRegion& region, int columns, int rows, const std::array<float*, 3>& out, std::size_t out_stride) {
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const float tx = static_cast<float>(region.x0 + i) + 0.5f, ty = static_cast<float>(region.y0 + j) + 0.5f;
      const Chosen set = choose(region, tx, ty);
      const Weights weights = weigh(set, region, tx, ty);
      for (std::size_t c = 0; c < static_cast<std::size_t>(region.channels); ++c)
        out[c][static_cast<std::size_t>(j) * out_stride + static_cast<std::size_t>(i)] =
            combine(set.value[c], set.count, weights, region.channels == 1);
    }
  }
}

}  // namespace sightline
