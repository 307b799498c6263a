#include "shade/analytic/lobe_quadrature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "shade/analytic/gauss_rules.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/analytic/lobe_quadrature.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "shade/analytic/polygon_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

// An interval, and where in it an integrand like 1 / (width² + (x - centre)²)² has its nodes: evenly in s, x = centre + width sinh s, which
// moves the integrand's poles away [Johnston2005]. Short intervals are taken as they are: sinh would be all rounding.
class Warp {
 public:
  HWY_INLINE Warp(D d, V low, V high, V centre, V width)
      : centre_(centre), width_(hn::Max(width, hn::Set(d, 1e-6f))), half_(hn::Set(d, 0.5f)), one_(hn::Set(d, 1.f)) {
    const V inverse = hn::Div(one_, width_), s0 = hn::Asinh(d, hn::Mul(hn::Sub(low, centre), inverse));
    const V s1 = hn::Asinh(d, hn::Mul(hn::Sub(high, centre), inverse));
    middle_ = hn::Mul(half_, hn::Add(s0, s1)), reach_ = hn::Mul(half_, hn::Sub(s1, s0));
    plain_ = hn::Lt(reach_, hn::Set(d, 0.2f));
    plain_middle_ = hn::Mul(half_, hn::Add(low, high)), plain_reach_ = hn::Mul(half_, hn::Sub(high, low));
  }
  /// Half the interval's length in s.
  V reach() const { return reach_; }
  /// Where node `x` of [-1, 1] goes, and by how much it is stretched.
  HWY_INLINE V at(D d, V x, V& stretch) const {
    const V grown = hn::Exp(d, hn::MulAdd(reach_, x, middle_)), shrunk = hn::Div(one_, grown);
    const V cosh = hn::Mul(half_, hn::Add(grown, shrunk)), sinh = hn::Mul(half_, hn::Sub(grown, shrunk));
    stretch = hn::IfThenElse(plain_, plain_reach_, hn::Mul(hn::Mul(width_, cosh), reach_));
    return hn::IfThenElse(plain_, hn::MulAdd(plain_reach_, x, plain_middle_), hn::MulAdd(width_, sinh, centre_));
  }

 private:
  V centre_, width_, half_, one_, middle_, reach_, plain_middle_, plain_reach_;
  M plain_;
};

// A disk's rows end in square roots, on which no rule is good: they are taken by the angle whose sine v is.
HWY_INLINE Warp disk_rows(D d, V low, V high, V centre, V width) {
  const V one = hn::Set(d, 1.f), inside = hn::Min(hn::Max(centre, hn::Neg(one)), one);
  const V angle = hn::Add(hn::Asin(d, inside), hn::Sub(centre, inside));
  const V slope = hn::Sqrt(hn::Max(hn::NegMulAdd(inside, inside, one), hn::Set(d, 0.1f)));
  const auto angle_of = [&](V v) { return hn::Asin(d, hn::Min(hn::Max(v, hn::Neg(one)), one)); };
  return {d, angle_of(low), angle_of(high), angle, hn::Div(width, slope)};
}

// Height over a plane as a function of the emitter's parameters: above where at0 + along_u u + along_v v > 0.
struct Height {
  V at0, along_u, along_v;
  // The part of a row that is above.
  HWY_INLINE void cut_row(D d, V v, V& low, V& high) const {
    const V zero = hn::Zero(d), rest = hn::MulAdd(along_v, v, at0), crossing = hn::Div(hn::Neg(rest), along_u);
    low = hn::IfThenElse(hn::Gt(along_u, zero), hn::Max(low, crossing), low);
    high = hn::IfThenElse(hn::Lt(along_u, zero), hn::Min(high, crossing), high);
    high = hn::IfThenElse(hn::And(hn::Eq(along_u, zero), hn::Lt(rest, zero)), low, high);
    high = hn::Max(high, low);
  }
  // The rows of which any part with u in [u0, u1] is above.
  HWY_INLINE void cut_rows(D d, V u0, V u1, V& low, V& high) const {
    const V highest = hn::MulAdd(along_u, hn::IfThenElse(hn::Gt(along_u, hn::Zero(d)), u1, u0), at0);
    Height{highest, along_v, hn::Zero(d)}.cut_row(d, hn::Zero(d), low, high);
  }
};

// The frame in which wo lies in the xz plane.
HWY_INLINE Rows3 frame_of_view(D d, const V3& normal, const V3& wo) {
  const M below = hn::Lt(dot3(normal, wo), hn::Zero(d));
  const V3 n = select3(below, neg3(normal), normal), across = sub3(wo, scale3(n, dot3(n, wo)));
  const V squared = dot3(across, across);
  const V3 t = select3(hn::Gt(squared, hn::Set(d, 1e-12f)), scale3(across, hn::Div(hn::Set(d, 1.f), hn::Sqrt(squared))), frame_of(d, n).x);
  return {t, cross3(n, t), n};
}

// f cos for unit F, as ggx.h has it.
class Lobe {
 public:
  HWY_INLINE Lobe(D d, const Rows3& frame, const V3& wo, V alpha)
      : one_(hn::Set(d, 1.f)), wo_x_(dot3(frame.x, wo)), wo_z_(hn::Min(dot3(frame.z, wo), one_)), alpha2_(hn::Mul(alpha, alpha)) {
    inverse2_ = hn::Div(one_, alpha2_);
    stretch_ = stretch(wo_z_);
    scale_ = hn::Mul(hn::Set(d, 0.5f * kInvPi), inverse2_);
  }
  // Times `weight` / |p|³, added to the three integrals; p.z > 0.
  HWY_INLINE void add(D d, const V3& p, V weight, V3& sum) const {
    const V inverse = hn::Div(one_, hn::Sqrt(dot3(p, p)));
    const V z = hn::Max(hn::Mul(p.z, inverse), hn::Zero(d));
    const V hx = hn::MulAdd(p.x, inverse, wo_x_), hy = hn::Mul(p.y, inverse), hz = hn::Add(wo_z_, z);
    const V flat = hn::MulAdd(hx, hx, hn::Mul(hy, hy)), hz2 = hn::Mul(hz, hz), h2 = hn::Add(flat, hz2);
    const V shape = hn::MulAdd(flat, inverse2_, hz2);
    const V shadow = hn::MulAdd(wo_z_, stretch(z), hn::Mul(z, stretch_));
    const V inverse3 = hn::Mul(hn::Mul(inverse, inverse), inverse);
    const V value = hn::Div(hn::Mul(hn::Mul(hn::Mul(h2, h2), z), hn::Mul(hn::Mul(scale_, weight), inverse3)),
                            hn::Max(hn::Mul(hn::Mul(shape, shape), shadow), hn::Set(d, 1e-30f)));
    const V cosine = hn::Min(hn::Mul(hn::Set(d, 0.5f), hn::Sqrt(h2)), one_), rest = hn::Sub(one_, cosine);
    const V rest2 = hn::Mul(rest, rest), schlick = hn::Mul(value, hn::Mul(hn::Mul(rest2, rest2), rest));
    sum = {hn::Add(sum.x, value), hn::Add(sum.y, schlick), hn::MulAdd(schlick, hn::Mul(cosine, rest), sum.z)};
  }

 private:
  HWY_INLINE V stretch(V z) const {
    const V z2 = hn::Mul(z, z);
    return hn::Sqrt(hn::MulAdd(alpha2_, hn::Sub(one_, z2), z2));
  }
  V one_, wo_x_, wo_z_, alpha2_, inverse2_, stretch_, scale_;
};

HWY_INLINE V largest(D d, V v, M lanes) { return hn::MaxOfLanes(d, hn::IfThenElseZero(lanes, v)); }

void Integrate(const FlatSurface& surface, const LobeReceiverBatch& receivers, std::size_t count, Vec3Batch& integral) {
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.f);
  const bool triangle = surface.flags & FlatEmitter::kTriangle, disk = surface.flags & FlatEmitter::kDisk;
  const bool two_sided = surface.flags & FlatEmitter::kTwoSided;
  const V first = disk ? hn::Neg(one) : zero;
  const float area = glm::length(glm::cross(surface.e1, surface.e2));
  const float least_height = 1e-6f * (glm::length(surface.e1) + glm::length(surface.e2));
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V3 position = load3(d, receivers.position, i), wo = load3(d, receivers.wo, i), ng = load3(d, receivers.geometric_normal, i);
    const Rows3 frame = frame_of_view(d, load3(d, receivers.normal, i), wo);
    const V3 offset = sub3(set3(d, surface.origin), position), e1 = set3(d, surface.e1), e2 = set3(d, surface.e2);
    V facing = hn::Neg(dot3(offset, set3(d, surface.normal)));
    if (two_sided) facing = hn::Abs(facing);
    // What is left out, past the end too, has all its lanes computed and dropped.
    const M lit = hn::And(hn::Gt(facing, hn::Set(d, least_height)), hn::FirstN(d, count - i));
    if (hn::AllFalse(d, lit)) {
      store3(d, {zero, zero, zero}, integral, i);
      continue;
    }
    const V3 o = multiply(frame, offset), a = multiply(frame, e1), b = multiply(frame, e2);
    const V side = hn::CopySign(one, dot3(ng, wo));
    const Height above{o.z, a.z, b.z},
        above_facet{hn::Mul(side, dot3(ng, offset)), hn::Mul(side, dot3(ng, e1)), hn::Mul(side, dot3(ng, e2))};

    // |M p|² of the transformed cosine: a paraboloid over the parameters, here about its lowest point (u0, v0), row by row.
    const V m11 = hn::LoadU(d, receivers.lobes.m11.data() + i), m13 = hn::LoadU(d, receivers.lobes.m13.data() + i);
    const V m31 = hn::LoadU(d, receivers.lobes.m31.data() + i), m33 = hn::LoadU(d, receivers.lobes.m33.data() + i);
    const auto transformed = [&](const V3& p) {
      return V3{hn::MulAdd(m11, p.x, hn::Mul(m13, p.z)), p.y, hn::MulAdd(m31, p.x, hn::Mul(m33, p.z))};
    };
    const V3 mo = transformed(o), ma = transformed(a), mb = transformed(b), across = cross3(ma, mb);
    const V tiny = hn::Set(d, 1e-30f), a2 = hn::Max(dot3(ma, ma), tiny), across2 = hn::Max(dot3(across, across), tiny);
    const V v0 = hn::Neg(hn::Div(dot3(cross3(mo, ma), cross3(mb, ma)), across2));
    const V slope = hn::Neg(hn::Div(dot3(ma, mb), a2)), u0 = hn::Neg(hn::Div(hn::MulAdd(dot3(ma, mb), v0, dot3(mo, ma)), a2));
    const V away = hn::Abs(dot3(mo, across)), width_v = hn::Div(hn::Mul(away, hn::Sqrt(a2)), across2);
    const V least2 = hn::Div(hn::Mul(away, away), hn::Mul(across2, a2)), growth = hn::Div(across2, hn::Mul(a2, a2));

    V low = first, high = one;
    above.cut_rows(d, first, one, low, high), above_facet.cut_rows(d, first, one, low, high);
    const Warp rows = disk ? disk_rows(d, low, high, v0, width_v) : Warp(d, low, high, v0, width_v);
    const auto row_of = [&](V v, V& row_low, V& row_high) {
      row_high = disk ? hn::Sqrt(hn::Max(hn::NegMulAdd(v, v, one), zero)) : triangle ? hn::Max(hn::Sub(one, v), zero) : one;
      row_low = disk ? hn::Neg(row_high) : zero;
      above.cut_row(d, v, row_low, row_high), above_facet.cut_row(d, v, row_low, row_high);
      const V dv = hn::Sub(v, v0);
      return Warp(d, row_low, row_high, hn::MulAdd(slope, dv, u0), hn::Sqrt(hn::MulAdd(growth, hn::Mul(dv, dv), least2)));
    };
    const Lobe lobe(d, frame, wo, hn::LoadU(d, receivers.alpha.data() + i));
    const GaussRule& outer = gauss_rule(hn::GetLane(largest(d, rows.reach(), lit)) * (disk ? 2.f : 1.f) + (disk ? 1.f : 0.f));
    V3 sum = {zero, zero, zero};
    for (std::size_t r = 0; r < outer.count; ++r) {
      V stretch_v, stretch_u, row_low, row_high;
      V v = rows.at(d, hn::Set(d, outer.node[r]), stretch_v);
      if (disk) {
        v = hn::Sin(d, v);
        stretch_v = hn::Mul(stretch_v, hn::Sqrt(hn::Max(hn::NegMulAdd(v, v, one), zero)));
      }
      const Warp row = row_of(v, row_low, row_high);
      const V3 start = {hn::MulAdd(b.x, v, o.x), hn::MulAdd(b.y, v, o.y), hn::MulAdd(b.z, v, o.z)};
      const V row_weight = hn::Mul(stretch_v, hn::Set(d, outer.weight[r]));
      const GaussRule& inner = gauss_rule(hn::GetLane(largest(d, row.reach(), lit)));
      for (std::size_t c = 0; c < inner.count; ++c) {
        const V u = row.at(d, hn::Set(d, inner.node[c]), stretch_u);
        lobe.add(d, {hn::MulAdd(a.x, u, start.x), hn::MulAdd(a.y, u, start.y), hn::MulAdd(a.z, u, start.z)},
                 hn::Mul(row_weight, hn::Mul(stretch_u, hn::Set(d, inner.weight[c]))), sum);
      }
    }
    const V scale = hn::IfThenElseZero(lit, hn::Mul(facing, hn::Set(d, area)));
    // No lobe reflects more than there is.
    const auto bounded = [&](V v) { return hn::IfThenElseZero(hn::And(lit, hn::Ge(v, zero)), hn::Min(hn::Mul(v, scale), one)); };
    store3(d, {bounded(sum.x), bounded(sum.y), bounded(sum.z)}, integral, i);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(Integrate);

void ggx_over_surface(const FlatSurface& surface, const LobeReceiverBatch& receivers, std::size_t count, Vec3Batch& integral) {
  HWY_DYNAMIC_DISPATCH(Integrate)(surface, receivers, count, integral);
}

}  // namespace sightline
#endif
