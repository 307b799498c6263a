#include "methods/fragments/smooth_window.h"

#include <cstring>

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

/// What lanes know of their own pixel.
struct Centre {
  V own;
  V3 position, normal, shading_normal;
  V limit;  // squared distance from the tangent plane
};

/// Moments of the window, as in smooth_pixel().
struct Moments {
  V count, fine, sx, sy, sxx, sxy, syy, t, tx, ty, txx, txy, tyy, tt;
};

HWY_NOINLINE Moments gather(D d, const SmoothInput& input, int x, int y, int step, const Centre& centre) {
  const DI di;
  const GBuffer& g = input.g;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.f), ridge = hn::Set(d, kRidge);
  Moments m = {zero, zero, zero, zero, ridge, zero, ridge, zero, zero, zero, zero, zero, zero, zero};
  const I column = hn::Add(hn::Iota(di, 0), hn::Set(di, x));
  for (int j = -kRadius; j <= kRadius; ++j) {
    const int py = y + j * step;
    if (py < 0 || py >= g.height) continue;
    const V fy = hn::Set(d, static_cast<float>(j));
    for (int i = -kRadius; i <= kRadius; ++i) {
      const Reader reader(g, x + i * step, py);
      const I px = hn::Add(column, hn::Set(di, i * step));
      const V3 delta = sub3(reader.vectors(g.position), centre.position);
      const V distance = dot3(delta, centre.normal), squared = hn::Mul(distance, distance);
      M counts = hn::And(hn::Le(squared, centre.limit), hn::Le(squared, hn::Mul(hn::Set(d, kMaxSlope * kMaxSlope), dot3(delta, delta))));
      counts = hn::And(counts, hn::Ge(dot3(centre.shading_normal, reader.vectors(g.shading_normal)), hn::Set(d, kMinCosine)));
      counts = hn::And(counts, receives(d, reader, g));
      counts = hn::And(counts, hn::RebindMask(d, hn::And(hn::Gt(px, hn::Set(di, -1)), hn::Lt(px, hn::Set(di, g.width)))));
      const M fine = hn::And(counts, hn::RebindMask(d, hn::Eq(reader.bytes(input.level.data()), hn::Zero(di))));
      const V w = hn::IfThenElseZero(counts, one), fx = hn::Set(d, static_cast<float>(i)), wx = hn::Mul(w, fx), wy = hn::Mul(w, fy);
      const V v = hn::IfThenElseZero(counts, hn::Sub(reader.floats(input.signal.data()), centre.own));
      const V vx = hn::Mul(v, fx), vy = hn::Mul(v, fy);
      m.count = hn::Add(m.count, w), m.fine = hn::Add(m.fine, hn::IfThenElseZero(fine, one));
      m.sx = hn::Add(m.sx, wx), m.sy = hn::Add(m.sy, wy);
      m.sxx = hn::MulAdd(wx, fx, m.sxx), m.sxy = hn::MulAdd(wx, fy, m.sxy), m.syy = hn::MulAdd(wy, fy, m.syy);
      m.t = hn::Add(m.t, v), m.tx = hn::Add(m.tx, vx), m.ty = hn::Add(m.ty, vy);
      m.txx = hn::MulAdd(vx, fx, m.txx), m.txy = hn::MulAdd(vx, fy, m.txy), m.tyy = hn::MulAdd(vy, fy, m.tyy);
      m.tt = hn::MulAdd(v, v, m.tt);
    }
  }
  return m;
}

// The same where all pixels of the window are known to lie in the picture and on one surface.
HWY_NOINLINE Moments gather_flat(D d, const SmoothInput& input, int x, int y, int step, V own) {
  const DI di;
  const GBuffer& g = input.g;
  const V zero = hn::Zero(d), squares = hn::Set(d, 50 + kRidge);
  Moments m = {hn::Set(d, kWhole), zero, zero, zero, squares, zero, squares, zero, zero, zero, zero, zero, zero, zero};
  I fine = hn::Zero(di);
  for (int j = -kRadius; j <= kRadius; ++j) {
    const V fy = hn::Set(d, static_cast<float>(j));
    for (int i = -kRadius; i <= kRadius; ++i) {
      const Reader reader(g, x + i * step, y + j * step);
      const V v = hn::Sub(reader.floats(input.signal.data()), own), fx = hn::Set(d, static_cast<float>(i));
      const V vx = hn::Mul(v, fx), vy = hn::Mul(v, fy);
      // A true lane is -1.
      fine = hn::Sub(fine, hn::VecFromMask(di, hn::Eq(reader.bytes(input.level.data()), hn::Zero(di))));
      m.t = hn::Add(m.t, v), m.tx = hn::Add(m.tx, vx), m.ty = hn::Add(m.ty, vy);
      m.txx = hn::MulAdd(vx, fx, m.txx), m.txy = hn::MulAdd(vx, fy, m.txy), m.tyy = hn::MulAdd(vy, fy, m.tyy);
      m.tt = hn::MulAdd(v, v, m.tt);
    }
  }
  m.fine = hn::ConvertTo(d, fine);
  return m;
}

// Whether all pixels up to `reach` around `count` pixels are flat, and in the picture.
HWY_INLINE bool all_flat(const GBuffer& g, int x, int y, int count, int reach) {
  const int x0 = x - reach, length = count + 2 * reach;
  if (g.flat.empty() || x0 < 0 || x + count + reach > g.width || y - reach < 0 || y + reach >= g.height) return false;
  std::uint64_t flat = ~std::uint64_t{0};
  for (int row = y - reach; row <= y + reach; ++row) {
    const std::uint8_t* bytes = g.flat.data() + g.at(x0, row);
    for (int i = 0; i < length; i += 8) {
      std::uint64_t some;
      std::memcpy(&some, bytes + HWY_MIN(i, length - 8), sizeof some);
      flat &= some;
    }
  }
  return flat == 0x0101010101010101u;
}

HWY_INLINE V clamp01(D d, V v) { return hn::Min(hn::Max(v, hn::Zero(d)), hn::Set(d, 1.f)); }

// What lanes get from their moments, step by step as in smooth.cpp, where `value` is what narrower windows gave.
HWY_INLINE V fitted(D d, const Moments& m, V own, V value) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.f), two = hn::Set(d, 2.f);
  const M enough = hn::Ge(m.count, hn::Set(d, kLeastCount));
  if (hn::AllFalse(d, enough)) return value;
  const V n = hn::IfThenElse(enough, m.count, hn::Set(d, kLeastCount)), per_n = hn::Div(one, n);
  const V mx = hn::Mul(m.sx, per_n), my = hn::Mul(m.sy, per_n), mean = hn::Mul(m.t, per_n);
  const V vxx = hn::NegMulAdd(m.sx, mx, m.sxx), vxy = hn::NegMulAdd(m.sx, my, m.sxy), vyy = hn::NegMulAdd(m.sy, my, m.syy);
  const V ux = hn::NegMulAdd(m.t, mx, m.tx), uy = hn::NegMulAdd(m.t, my, m.ty);
  const V determinant = hn::NegMulAdd(vxy, vxy, hn::Mul(vxx, vyy));
  const V per_determinant = hn::Div(one, hn::Max(determinant, hn::Set(d, 1e-12f)));
  const V b = hn::Mul(hn::NegMulAdd(vxy, uy, hn::Mul(vyy, ux)), per_determinant);
  const V c = hn::Mul(hn::NegMulAdd(vxy, ux, hn::Mul(vxx, uy)), per_determinant);
  const V plane = hn::NegMulAdd(c, my, hn::NegMulAdd(b, mx, mean));
  V squares = hn::NegMulAdd(c, uy, hn::NegMulAdd(b, ux, hn::NegMulAdd(m.t, mean, m.tt)));

  const M whole = hn::Eq(m.count, hn::Set(d, kWhole));
  const V qxx = hn::NegMulAdd(two, m.t, m.txx), qyy = hn::NegMulAdd(two, m.t, m.tyy);
  const V curvature = hn::IfThenElseZero(whole, hn::Mul(hn::Set(d, -2.f / 70), hn::Add(qxx, qyy)));
  const V bent =
      hn::MulAdd(hn::MulAdd(qxx, qxx, hn::Mul(qyy, qyy)), hn::Set(d, 1.f / 70), hn::Mul(hn::Mul(m.txy, m.txy), hn::Set(d, 1.f / 100)));
  squares = hn::Sub(squares, hn::IfThenElseZero(whole, bent));
  const V freedom = hn::Sub(n, hn::IfThenElse(whole, hn::Set(d, 6.f), hn::Set(d, 3.f)));

  const V mid = clamp01(d, hn::Add(own, plane));
  const V rays = hn::Mul(hn::MulAdd(m.fine, hn::Set(d, kFineVariance), hn::Mul(hn::Sub(n, m.fine), hn::Set(d, kProbeVariance))), per_n);
  const V taper = hn::Min(hn::Mul(hn::Set(d, kTaper), hn::Min(mid, hn::Sub(one, mid))), one);
  const V variance = hn::MulAdd(rays, taper, hn::Set(d, kLeastVariance));
  const V excess = hn::Sub(hn::Div(hn::Mul(curvature, curvature), variance), hn::Set(d, kFlat));
  const V curved = clamp01(d, hn::Mul(excess, hn::Set(d, 1 / (kCurved - kFlat))));
  const V fit = clamp01(d, hn::Add(own, hn::MulAdd(curved, curvature, plane)));
  const V residual = hn::Div(hn::Max(squares, zero), freedom);
  const V slope = hn::MulAdd(b, b, hn::Mul(c, c));
  const V gentle = hn::Max(hn::NegMulAdd(slope, hn::Set(d, 1 / kSteep), one), zero);
  const V allowed = hn::Mul(hn::Mul(hn::Mul(hn::Set(d, kAllowed), gentle), gentle), variance);
  const V keep = clamp01(d, hn::Sub(hn::Div(residual, hn::Max(allowed, hn::Set(d, 1e-20f))), one));
  const M plain = hn::AndNot(whole, hn::Or(hn::Eq(own, zero), hn::Eq(own, one)));
  const M taken = hn::AndNot(plain, enough);
  return hn::IfThenElse(taken, hn::MulAdd(keep, hn::Sub(value, fit), fit), value);
}

// window_level() of the pixels from (x, y) on.
HWY_INLINE I window_levels(const SmoothInput& input, int x, int y) {
  const DI di;
  const GBuffer& g = input.g;
  const I column = hn::Add(hn::Iota(di, 0), hn::Set(di, x));
  I level = Reader(g, x, y).bytes(input.level.data());
  const auto mix = [&](int dx, int dy) {
    if (y + dy < 0 || y + dy >= g.height) return;
    const I other = Reader(g, x + dx, y + dy).bytes(input.level.data()), px = hn::Add(column, hn::Set(di, dx));
    const auto inside = hn::And(hn::Gt(px, hn::Set(di, -1)), hn::Lt(px, hn::Set(di, g.width)));
    const auto counts = hn::And(inside, hn::Lt(other, hn::Set(di, kMixedLevel + 1)));
    level = hn::Max(level, hn::IfThenElseZero(counts, other));
  };
  mix(-kFar, 0), mix(kFar, 0), mix(0, -kFar), mix(0, kFar);
  return level;
}

// Whether all that windows of this reach can see from `count` pixels is one value.
HWY_INLINE bool all_equal(const SmoothInput& input, int x, int y, int count, int reach) {
  const D d;
  const GBuffer& g = input.g;
  const int x0 = HWY_MAX(x - reach, 0), x1 = HWY_MIN(x + count + reach, g.width), n = static_cast<int>(hn::Lanes(d));
  const V value = hn::Set(d, input.signal[g.at(x, y)]);
  for (int row = HWY_MAX(y - reach, 0); row < HWY_MIN(y + reach + 1, g.height); ++row) {
    for (int column = x0; column < x1; column += n) {
      const M differs =
          hn::And(hn::Ne(Reader(g, column, row).floats(input.signal.data()), value), hn::FirstN(d, static_cast<std::size_t>(x1 - column)));
      if (!hn::AllFalse(d, differs)) return false;
    }
  }
  return true;
}

void SmoothRow(const SmoothInput& input, int x, int y, int count, float* out) {
  const D d;
  const DI di;
  const GBuffer& g = input.g;
  const int n = static_cast<int>(hn::Lanes(d));
  for (int k = 0; k < count; k += n) {
    const I level = hn::Min(window_levels(input, x + k, y), hn::Set(di, 3));
    const auto inside = hn::Lt(hn::Iota(di, 0), hn::Set(di, count - k));
    const int widest = hn::GetLane(hn::MaxOfLanes(di, hn::IfThenElseZero(inside, level)));
    const Reader reader(g, x + k, y);
    const V own = reader.floats(input.signal.data());
    V result = own;
    if (!all_equal(input, x + k, y, HWY_MIN(n, count - k), kRadius * step_of(widest))) {
      const V reach = hn::Mul(hn::Set(d, kMaxPlaneDistance), reader.floats(g.depth.data()));
      const Centre centre = {own, reader.vectors(g.position), reader.vectors(g.geometric_normal), reader.vectors(g.shading_normal),
                             hn::Mul(reach, reach)};
      const M active = hn::And(receives(d, reader, g), hn::RebindMask(d, inside));
      for (int step = 1; step <= step_of(3); step *= 2) {
        static_assert(step_of(0) == 1 && step_of(1) == 1 && step_of(2) == 2 && step_of(3) == 4 && narrowest_step(4) == 2);
        const M large = hn::RebindMask(d, hn::Gt(level, hn::Set(di, step == 4 ? 2 : 1)));
        const M lanes = step == 1 ? hn::AndNot(large, active) : hn::And(large, active);
        if (hn::AllFalse(d, lanes)) continue;
        const bool flat = n >= 4 && n <= count - k && all_flat(g, x + k, y, n, kRadius * step);
        const Moments moments = flat ? gather_flat(d, input, x + k, y, step, own) : gather(d, input, x + k, y, step, centre);
        result = hn::IfThenElse(lanes, fitted(d, moments, own, result), result);
      }
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
