#include <array>

#include "methods/fragments/upsample_rbf.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/fragments/upsample_rbf_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

// The steps and constants of upsample_rbf.cpp, a texel a lane. A sample that a lane lacks has weight 0 and is far from all others, which
// leaves its row of the matrix empty.
constexpr std::size_t kSamples = 4;
constexpr float kRidge = 1e-6f, kMinPivot = 1e-5f, kOvershoot = 0.1f;

struct LaneSet {
  std::array<M, kSamples> present;
  std::array<V, kSamples> x, y, d2;  // relative to the texel, in widths
  std::array<V, kSamples> width, level;
  std::array<hn::Vec<DI>, kSamples> index;
};

HWY_INLINE V nearest(D d, const RbfCandidates& list, V tx, V ty, V limit, hn::Vec<DI>& index) {
  const DI di;
  V best = limit;
  index = hn::Zero(di);
  for (std::size_t i = 0; i < list.count; ++i) {
    const V dx = hn::Sub(hn::Set(d, list.x[i]), tx), dy = hn::Sub(hn::Set(d, list.y[i]), ty);
    const V distance = hn::MulAdd(dx, dx, hn::Mul(dy, dy));
    const M nearer = hn::Lt(distance, best);
    best = hn::IfThenElse(nearer, distance, best);
    index = hn::IfThenElse(hn::RebindMask(di, nearer), hn::Set(di, static_cast<std::int32_t>(i)), index);
  }
  return best;
}

HWY_INLINE V exp_of(D d, V x) { return hn::Exp(d, x); }

HWY_INLINE void choose(D d, const RbfRegion& region, V tx, V ty, LaneSet& set) {
  const V per_width = hn::Set(d, 1 / region.cell_width), limit = hn::Set(d, 4 * region.cell_width * region.cell_width);
  std::array<V, kSamples> sx, sy;
  set.present[0] = hn::Eq(per_width, per_width);
  sx[0] = hn::Set(d, region.own.x), sy[0] = hn::Set(d, region.own.y);
  set.width[0] = hn::Set(d, static_cast<float>(region.own.width)), set.level[0] = hn::Set(d, static_cast<float>(region.own.level));
  for (std::size_t k = 1; k < kSamples; ++k) {
    const RbfCandidates* list = region.candidates[k - 1];
    if (!list || list->count == 0) {
      set.present[k] = hn::Ne(per_width, per_width);
      sx[k] = sx[0], sy[k] = sy[0], set.width[k] = set.width[0], set.level[k] = set.level[0];
      set.index[k] = hn::Zero(DI());
      continue;
    }
    M present = hn::Lt(nearest(d, *list, tx, ty, limit, set.index[k]), limit);
    sx[k] = hn::GatherIndex(d, list->x.data(), set.index[k]), sy[k] = hn::GatherIndex(d, list->y.data(), set.index[k]);
    for (std::size_t j = 0; j < k; ++j) {
      const M same = hn::And(hn::Eq(sx[k], sx[j]), hn::Eq(sy[k], sy[j]));
      present = hn::AndNot(hn::And(same, set.present[j]), present);
    }
    set.present[k] = present;
    set.width[k] = hn::GatherIndex(d, list->width.data(), set.index[k]);
    set.level[k] = hn::GatherIndex(d, list->level.data(), set.index[k]);
  }
  for (std::size_t k = 0; k < kSamples; ++k) {
    set.x[k] = hn::Mul(hn::Sub(sx[k], tx), per_width), set.y[k] = hn::Mul(hn::Sub(sy[k], ty), per_width);
    set.d2[k] = hn::MulAdd(set.x[k], set.x[k], hn::Mul(set.y[k], set.y[k]));
  }
}

struct LaneWeights {
  std::array<V, kSamples> alpha, weight;
};

HWY_INLINE LaneWeights weigh(D d, const RbfRegion& region, const LaneSet& set) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.f);
  V t_min = set.width[0];
  for (std::size_t k = 1; k < kSamples; ++k) t_min = hn::IfThenElse(set.present[k], hn::Min(t_min, set.width[k]), t_min);
  LaneWeights result;
  const V minus_half_per_t = hn::Div(hn::Set(d, -0.5f), t_min);
  V sum = zero, level = zero, count = zero;
  for (std::size_t k = 0; k < kSamples; ++k) {
    result.alpha[k] = hn::IfThenElseZero(set.present[k], exp_of(d, hn::Mul(set.d2[k], minus_half_per_t)));
    sum = hn::Add(sum, result.alpha[k]);
    level = hn::MulAdd(result.alpha[k], set.level[k], level);
    count = hn::Add(count, hn::IfThenElseZero(set.present[k], one));
  }
  const V per_sum = hn::Div(one, sum);
  for (std::size_t k = 0; k < kSamples; ++k) result.alpha[k] = hn::Mul(result.alpha[k], per_sum);
  const V minus_per_c = region.adaptive ? hn::Div(hn::Set(d, -0.5f), hn::MulAdd(level, per_sum, one)) : hn::Set(d, -1.f);
  std::array<V, kSamples> phi;
  V phi_sum = zero;
  for (std::size_t k = 0; k < kSamples; ++k) {
    phi[k] = hn::IfThenElseZero(set.present[k], exp_of(d, hn::Mul(set.d2[k], minus_per_c)));
    phi_sum = hn::Add(phi_sum, phi[k]);
  }

  std::array<std::array<V, kSamples>, kSamples> l;
  std::array<V, kSamples> pivot, z;
  V least = one;
  for (std::size_t i = 0; i < kSamples; ++i) {
    V diagonal = hn::Set(d, 1 + kRidge);
    z[i] = phi[i];
    for (std::size_t j = 0; j < i; ++j) {
      const V dx = hn::Sub(set.x[i], set.x[j]), dy = hn::Sub(set.y[i], set.y[j]);
      const V kernel = exp_of(d, hn::Mul(hn::MulAdd(dx, dx, hn::Mul(dy, dy)), minus_per_c));
      V sum_ij = hn::IfThenElseZero(hn::And(set.present[i], set.present[j]), kernel);
      for (std::size_t k = 0; k < j; ++k) sum_ij = hn::NegMulAdd(hn::Mul(l[i][k], l[j][k]), pivot[k], sum_ij);
      l[i][j] = hn::Div(sum_ij, pivot[j]);
      diagonal = hn::NegMulAdd(l[i][j], sum_ij, diagonal);
      z[i] = hn::NegMulAdd(l[i][j], z[j], z[i]);
    }
    pivot[i] = hn::Max(diagonal, hn::Set(d, 1e-20f)), least = hn::Min(least, diagonal);
  }
  const M solved = hn::And(hn::Ge(count, hn::Set(d, 3.f)), hn::Ge(least, hn::Set(d, kMinPivot)));
  const V per_phi_sum = hn::Div(one, phi_sum);
  for (std::size_t i = kSamples; i-- > 0;) {
    result.weight[i] = hn::Div(z[i], pivot[i]);
    for (std::size_t j = i + 1; j < kSamples; ++j) result.weight[i] = hn::NegMulAdd(l[j][i], result.weight[j], result.weight[i]);
  }
  for (std::size_t i = 0; i < kSamples; ++i) result.weight[i] = hn::IfThenElse(solved, result.weight[i], hn::Mul(phi[i], per_phi_sum));
  return result;
}

HWY_INLINE V combine(D d, const RbfRegion& region, std::size_t c, const LaneSet& set, const LaneWeights& weights) {
  const V own = hn::Set(d, region.own.value[c]), zero = hn::Zero(d);
  std::array<V, kSamples> value;
  V low = own, high = own, mean = zero;
  value[0] = own;
  for (std::size_t k = 1; k < kSamples; ++k) {
    const RbfCandidates* list = region.candidates[k - 1];
    value[k] = list && list->count > 0 ? hn::GatherIndex(d, list->value[c].data(), set.index[k]) : own;
    value[k] = hn::IfThenElse(set.present[k], value[k], own);
    low = hn::Min(low, value[k]), high = hn::Max(high, value[k]);
    mean = hn::MulAdd(weights.alpha[k], hn::Sub(value[k], own), mean);
  }
  mean = hn::Add(mean, own);
  V result = mean;
  for (std::size_t k = 0; k < kSamples; ++k) result = hn::MulAdd(weights.weight[k], hn::Sub(value[k], mean), result);
  const V margin = hn::Mul(hn::Set(d, kOvershoot), hn::Sub(high, low));
  result = hn::Min(hn::Max(result, hn::Max(hn::Sub(low, margin), zero)), hn::Max(hn::Add(high, margin), zero));
  return region.channels == 1 ? hn::Min(result, hn::Set(d, 1.f)) : result;
}

// Lanes go through the region's square row by row; what lies beyond `columns` and `rows` is computed and thrown away.
void RegionLanes(const RbfRegion& region, int columns, int rows, const std::array<float*, 3>& out, std::size_t out_stride) {
  const D d;
  const DI di;
  const int n = static_cast<int>(hn::Lanes(d)), size = region.size, across = size < n ? size : n, down = n / across;
  alignas(kCacheLine) std::int32_t column[kLanes], row[kLanes];
  for (int k = 0; k < n; ++k) column[k] = k % across, row[k] = k / across;
  const V lane_x = hn::Add(hn::ConvertTo(d, hn::Load(di, column)), hn::Set(d, static_cast<float>(region.x0) + 0.5f));
  const V lane_y = hn::Add(hn::ConvertTo(d, hn::Load(di, row)), hn::Set(d, static_cast<float>(region.y0) + 0.5f));
  for (int j = 0; j < rows; j += down) {
    for (int i = 0; i < columns; i += across) {
      const V tx = hn::Add(lane_x, hn::Set(d, static_cast<float>(i))), ty = hn::Add(lane_y, hn::Set(d, static_cast<float>(j)));
      LaneSet set;
      choose(d, region, tx, ty, set);
      const LaneWeights weights = weigh(d, region, set);
      for (std::size_t c = 0; c < static_cast<std::size_t>(region.channels); ++c) {
        alignas(kCacheLine) float value[kLanes];
        hn::Store(combine(d, region, c, set, weights), d, value);
        const int width = across < columns - i ? across : columns - i;
        for (int r = 0; r < down && j + r < rows; ++r) {
          float* to = out[c] + static_cast<std::size_t>(j + r) * out_stride + static_cast<std::size_t>(i);
          for (int k = 0; k < width; ++k) to[k] = value[r * across + k];
        }
      }
    }
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(RegionLanes);

void rbf_region_lanes(const RbfRegion& region, int columns, int rows, const std::array<float*, 3>& out, std::size_t out_stride) {
  HWY_DYNAMIC_DISPATCH(RegionLanes)(region, columns, rows, out, out_stride);
}

}  // namespace sightline
#endif
