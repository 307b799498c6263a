#include "methods/fragments/smooth_window.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/fragments/smooth_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;
using namespace smoothing;

using I = hn::Vec<DI>;
using DB = hn::Rebind<std::uint8_t, DI>;

/// Reads pixels (x + lane, y), wherever they are. Lanes beyond the picture read something.
class Reader {
 public:
  Reader(const GBuffer& g, int x, int y) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(y) * g.stride + x, n = static_cast<std::ptrdiff_t>(g.stride) * g.rows;
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(D()));
    whole_ = first >= 0 && first + lanes <= n;
    first_ = static_cast<std::size_t>(whole_ ? first : 0);
    if (whole_) return;
    for (std::ptrdiff_t k = 0; k < lanes; ++k) {
      const std::ptrdiff_t at = first + k;
      index_[k] = static_cast<std::int32_t>(at < 0 ? 0 : at < n ? at : n - 1);
    }
  }
  HWY_INLINE V floats(const float* values) const {
    if (HWY_LIKELY(whole_)) return hn::LoadU(D(), values + first_);
    return hn::GatherIndex(D(), values, hn::Load(DI(), index_));
  }
  HWY_INLINE V3 vectors(const Vec3Batch& b) const { return {floats(b.x.data()), floats(b.y.data()), floats(b.z.data())}; }
  HWY_INLINE I bytes(const std::uint8_t* values) const {
    if (HWY_LIKELY(whole_)) return hn::PromoteTo(DI(), hn::LoadU(DB(), values + first_));
    alignas(kCacheLine) std::int32_t wide[kLanes];
    for (std::size_t k = 0; k < hn::Lanes(DI()); ++k) wide[k] = values[index_[k]];
    return hn::Load(DI(), wide);
  }

 private:
  bool whole_;
  std::size_t first_;
  alignas(kCacheLine) std::int32_t index_[kLanes];
};

HWY_INLINE M receives(D d, const Reader& reader, const GBuffer& g) {
  const DI di;
  const I kind = reader.bytes(reinterpret_cast<const std::uint8_t*>(g.kind.data()));
  return hn::RebindMask(d, hn::Or(hn::Eq(kind, hn::Set(di, static_cast<std::int32_t>(PixelKind::diffuse))),
                                  hn::Eq(kind, hn::Set(di, static_cast<std::int32_t>(PixelKind::analytic)))));
}

// smooth_pixel() for lanes of one step.
HWY_INLINE V smooth_lanes(D d, const SmoothInput& input, int x, int y, int step, V own, const V3& position, const V3& normal,
                          const V3& shading_normal, V limit) {
  const DI di;
  const GBuffer& g = input.g;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.f);
  const I column = hn::Add(hn::Iota(di, 0), hn::Set(di, x));
  V count = zero, s = zero, sx = zero, sy = zero, sxx = hn::Set(d, kRidge), sxy = zero, syy = sxx;
  V t = zero, tx = zero, ty = zero, tt = zero;
  for (int j = -kRadius; j <= kRadius; ++j) {
    const int py = y + j * step;
    if (py < 0 || py >= g.height) continue;
    for (int i = -kRadius; i <= kRadius; ++i) {
      const Reader reader(g, x + i * step, py);
      const I px = hn::Add(column, hn::Set(di, i * step));
      const V3 delta = sub3(reader.vectors(g.position), position);
      const V distance = dot3(delta, normal), squared = hn::Mul(distance, distance);
      M counts = hn::And(hn::Le(squared, limit), hn::Le(squared, hn::Mul(hn::Set(d, kMaxSlope * kMaxSlope), dot3(delta, delta))));
      counts = hn::And(counts, hn::Ge(dot3(shading_normal, reader.vectors(g.shading_normal)), hn::Set(d, kMinCosine)));
      counts = hn::And(counts, receives(d, reader, g));
      counts = hn::And(counts, hn::RebindMask(d, hn::And(hn::Gt(px, hn::Set(di, -1)), hn::Lt(px, hn::Set(di, g.width)))));
      const M fine = hn::RebindMask(d, hn::Eq(reader.bytes(input.level.data()), hn::Zero(di)));
      const V w = hn::IfThenElseZero(counts, hn::IfThenElse(fine, one, hn::Set(d, kWeightOfProbes)));
      const V v = hn::IfThenElseZero(counts, hn::Sub(reader.floats(input.signal.data()), own)), wv = hn::Mul(w, v);
      const V fx = hn::Set(d, static_cast<float>(i)), fy = hn::Set(d, static_cast<float>(j)), wx = hn::Mul(w, fx), wy = hn::Mul(w, fy);
      count = hn::Add(count, hn::IfThenElseZero(counts, one));
      s = hn::Add(s, w), sx = hn::Add(sx, wx), sy = hn::Add(sy, wy);
      sxx = hn::MulAdd(wx, fx, sxx), sxy = hn::MulAdd(wx, fy, sxy), syy = hn::MulAdd(wy, fy, syy);
      t = hn::Add(t, wv), tx = hn::MulAdd(wv, fx, tx), ty = hn::MulAdd(wv, fy, ty), tt = hn::MulAdd(wv, v, tt);
    }
  }
  const M enough = hn::Ge(count, hn::Set(d, kLeastCount));
  if (hn::AllFalse(d, enough)) return own;

  const V per_s = hn::Div(one, hn::IfThenElse(enough, s, one)), mx = hn::Mul(sx, per_s), my = hn::Mul(sy, per_s), mean = hn::Mul(t, per_s);
  const V vxx = hn::NegMulAdd(sx, mx, sxx), vxy = hn::NegMulAdd(sx, my, sxy), vyy = hn::NegMulAdd(sy, my, syy);
  const V ux = hn::NegMulAdd(t, mx, tx), uy = hn::NegMulAdd(t, my, ty);
  const V determinant = hn::NegMulAdd(vxy, vxy, hn::Mul(vxx, vyy));
  const V per_determinant = hn::Div(one, hn::Max(determinant, hn::Set(d, 1e-12f)));
  const V b = hn::Mul(hn::NegMulAdd(vxy, uy, hn::Mul(vyy, ux)), per_determinant);
  const V c = hn::Mul(hn::NegMulAdd(vxy, ux, hn::Mul(vxx, uy)), per_determinant);
  const V offset = hn::NegMulAdd(c, my, hn::NegMulAdd(b, mx, mean));
  const V fit = hn::Min(hn::Max(hn::Add(own, offset), zero), one);
  const V squares = hn::NegMulAdd(c, uy, hn::NegMulAdd(b, ux, hn::NegMulAdd(t, mean, tt)));
  const V freedom = hn::IfThenElse(enough, hn::Sub(count, hn::Set(d, 3.f)), one);
  const V residual = hn::Div(hn::Max(squares, zero), freedom);

  const V taper = hn::Min(hn::Mul(hn::Set(d, kTaper), hn::Min(fit, hn::Sub(one, fit))), one);
  const V variance = hn::MulAdd(hn::Set(d, kVariance), taper, hn::Set(d, kLeastVariance));
  const V ratio =
      hn::Div(hn::NegMulAdd(hn::Set(d, kPlausible), variance, residual), hn::Mul(variance, hn::Set(d, kImplausible - kPlausible)));
  const V keep = hn::Min(hn::Max(ratio, zero), one);
  return hn::IfThenElse(enough, hn::MulAdd(keep, hn::Sub(own, fit), fit), own);
}

void SmoothRow(const SmoothInput& input, int x, int y, int count, float* out) {
  const D d;
  const DI di;
  const GBuffer& g = input.g;
  const int n = static_cast<int>(hn::Lanes(d));
  for (int k = 0; k < count; k += n) {
    const Reader reader(g, x + k, y);
    const V own = reader.floats(input.signal.data());
    const V3 position = reader.vectors(g.position), normal = reader.vectors(g.geometric_normal);
    const V3 shading_normal = reader.vectors(g.shading_normal);
    const V reach = hn::Mul(hn::Set(d, kMaxPlaneDistance), reader.floats(g.depth.data())), limit = hn::Mul(reach, reach);
    const M active = receives(d, reader, g);
    const I level = hn::Min(reader.bytes(input.level.data()), hn::Set(di, 3));
    V result = own;
    for (int m = 0; m <= 3; ++m) {
      const M lanes = hn::And(active, hn::RebindMask(d, hn::Eq(level, hn::Set(di, m))));
      if (hn::AllFalse(d, lanes)) continue;
      result = hn::IfThenElse(lanes, smooth_lanes(d, input, x + k, y, step_of(m), own, position, normal, shading_normal, limit), result);
    }
    if (k + n <= count) {
      hn::StoreU(result, d, out + k);
    } else {
      alignas(kCacheLine) float last[kLanes];
      hn::Store(result, d, last);
      for (int i = 0; k + i < count; ++i) out[k + i] = last[i];
    }
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(SmoothRow);

void smooth_row(const SmoothInput& input, int x, int y, int count, float* out) { HWY_DYNAMIC_DISPATCH(SmoothRow)(input, x, y, count, out); }

}  // namespace sightline
#endif
