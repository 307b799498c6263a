// Lambert's polygon formula in vectors: a receiving point a lane, one polygon for all. Included once for each SIMD target, after
// hwy/foreach_target.h.
//
// The formula sums over edges what nearly cancels when the emitter is far away: edges count like size / distance, the result like its
// square. So the sum is taken apart. With corners u = r + o, o measured from the polygon's centre r, and w = angle / (|u| |v| sin angle) of
// the edge from u to v,
//
//   2 pi F = sum w (v x u).n = (sum (v_o x u_o).n + sum (w |r|^2 - 1) (v x u).n) / |r|^2,
//
// as the offsets may stand for the corners where the weights are equal. Both sums are free of cancellation, given w |r|^2 - 1 without it.
#if defined(SIGHTLINE_SHADE_ANALYTIC_POLYGON_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_SHADE_ANALYTIC_POLYGON_LANES_INL_H_
#undef SIGHTLINE_SHADE_ANALYTIC_POLYGON_LANES_INL_H_
#else
#define SIGHTLINE_SHADE_ANALYTIC_POLYGON_LANES_INL_H_
#endif

#include <span>

#include "base/simd/vec3-inl.h"
#include "shade/analytic/polygon_plane.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE::lanes {

/// A polygon as seen by lanes.
struct PolygonView {
  std::span<const Vec3> corners, offsets;  ///< offsets: measured from the centre
  float reach;                             ///< length of the longest offset
  V3 position;                             ///< of the receivers
  V3 centre;                               ///< minus the position
};

/// Rows of a matrix that takes world vectors into coordinates around the receiver.
struct Rows3 {
  V3 x, y, z;
};

HWY_INLINE V3 multiply(const Rows3& m, const V3& v) { return {dot3(m.x, v), dot3(m.y, v), dot3(m.z, v)}; }

/// angle / sin(angle) - 1 where 1 - cos(angle) = x is in [0, 1]; relative error 1e-7.
HWY_INLINE V angle_over_sine_minus_one(D d, V x) {
  V p = hn::Set(d, kAngleSeries.back());
  for (std::size_t i = kAngleSeries.size() - 1; i-- > 0;) p = hn::MulAdd(p, x, hn::Set(d, kAngleSeries[i]));
  return hn::Mul(p, x);
}

/// A corner, or a point where an edge meets the horizon: from the receiver and from the polygon's centre; height above the horizon, not
/// scaled.
struct Corner {
  V3 from_receiver, from_centre;
  V height;
};

HWY_INLINE Corner select_corner(M m, const Corner& a, const Corner& b) {
  return {select3(m, a.from_receiver, b.from_receiver), select3(m, a.from_centre, b.from_centre), hn::IfThenElse(m, a.height, b.height)};
}

/// The two sums of the formula.
class EdgeSum {
 public:
  /// `centre` is scaled to about unit length, `excess` its squared length less 1.
  EdgeSum(D d, const V3& centre, V excess) : d_(d), centre_(centre), excess_(excess), sum_(hn::Zero(d)) {}

  HWY_INLINE void add(const Corner& u, const Corner& v) {
    const V one = hn::Set(d_, 1.f), tiny = hn::Set(d_, 1e-30f);
    const V3 &a = u.from_receiver, &b = v.from_receiver;
    const V3 e = sub3(v.from_centre, u.from_centre);
    const V3 across = {hn::Sub(hn::Mul(e.y, a.z), hn::Mul(e.z, a.y)), hn::Sub(hn::Mul(e.z, a.x), hn::Mul(e.x, a.z)),
                       hn::Sub(hn::Mul(e.x, a.y), hn::Mul(e.y, a.x))};
    const V squares = hn::Max(hn::Mul(dot3(a, a), dot3(b, b)), tiny);
    const V length = hn::Sqrt(squares);

    // Of the angle: excess of angle / sine over 1. Beyond a right angle through its supplement.
    const V cosine = hn::Min(hn::Max(hn::Div(dot3(a, b), length), hn::Neg(one)), one);
    const V sine_squared = hn::Min(hn::Div(dot3(across, across), squares), one);
    const M obtuse = hn::Lt(cosine, hn::Zero(d_));
    const V series = angle_over_sine_minus_one(d_, hn::Div(sine_squared, hn::Add(one, hn::Abs(cosine))));
    const V sine = hn::Sqrt(hn::Max(sine_squared, tiny));
    const V supplement = hn::Sub(hn::Sub(hn::Div(hn::Set(d_, kPi), sine), hn::Set(d_, 2.f)), series);
    const V angle = hn::IfThenElse(obtuse, supplement, series);

    // Of the distances: excess of 1 / (|u| |v|) over 1.
    const V p = square_excess(u), q = square_excess(v);
    const V distance = hn::Neg(hn::Div(hn::Add(hn::Add(p, q), hn::Mul(p, q)), hn::Mul(length, hn::Add(one, length))));

    const V weight = hn::Add(hn::Add(angle, distance), hn::Mul(angle, distance));
    const V area = hn::Sub(hn::Mul(v.from_centre.x, u.from_centre.y), hn::Mul(v.from_centre.y, u.from_centre.x));
    sum_ = hn::Add(sum_, hn::Add(area, hn::Mul(weight, across.z)));
  }
  V sum() const { return sum_; }

 private:
  /// |u|² - 1.
  HWY_INLINE V square_excess(const Corner& u) const { return hn::Add(dot3(u.from_centre, add3(u.from_receiver, centre_)), excess_); }

  D d_;
  V3 centre_;
  V excess_, sum_;
};

/// Integral of z / pi over the directions of the polygon above the horizon of `normal`, taken through `transform`; signed as
/// horizon_form_factor().
HWY_INLINE V polygon_form_factor(D d, const PolygonView& polygon, const V3& normal, const Rows3& transform) {
  const V one = hn::Set(d, 1.f), zero = hn::Zero(d);

  // Everything is scaled so that lengths are about 1, however near or far the polygon is.
  const V3 unscaled = multiply(transform, polygon.centre);
  const V norm = hn::Sqrt(hn::Add(hn::Add(dot3(transform.x, transform.x), dot3(transform.y, transform.y)), dot3(transform.z, transform.z)));
  const V distance = hn::Sqrt(dot3(unscaled, unscaled)), near = hn::Mul(hn::Set(d, polygon.reach), norm);
  const V scale = hn::Div(one, hn::Max(hn::Max(distance, near), hn::Set(d, 1e-30f)));
  const Rows3 m = {scale3(transform.x, scale), scale3(transform.y, scale), scale3(transform.z, scale)};
  const V3 centre = scale3(unscaled, scale);
  const V excess = hn::IfThenElse(hn::Gt(distance, near), zero, hn::Sub(dot3(centre, centre), one));

  // Nearby the corners are measured from the receiver, lest their rounding show up in angles; far away offsets must be exact instead.
  const M far = hn::Gt(distance, hn::Mul(hn::Set(d, 4.f), near));
  const bool any_far = !hn::AllFalse(d, far), any_near = !hn::AllTrue(d, far);
  const V centre_height = dot3(normal, polygon.centre);
  const Corner middle = {centre, {zero, zero, zero}, zero};
  const auto corner = [&](std::size_t i) {
    Corner c = middle;
    if (any_far) {
      const V3 offset = set3(d, polygon.offsets[i]);
      c.from_centre = multiply(m, offset);
      c.from_receiver = add3(centre, c.from_centre);
      c.height = hn::Add(centre_height, dot3(normal, offset));
    }
    if (any_near) {
      const V3 to_corner = sub3(set3(d, polygon.corners[i]), polygon.position), u = multiply(m, to_corner);
      c = select_corner(far, c, {u, sub3(u, centre), dot3(normal, to_corner)});
    }
    return c;
  };
  EdgeSum edges(d, centre, excess);
  Corner leave = middle, enter = middle;
  Corner a = corner(polygon.corners.size() - 1);
  M a_above = hn::Ge(a.height, zero);
  for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
    const Corner b = corner(i);
    const M b_above = hn::Ge(b.height, zero);
    if (hn::AllTrue(d, hn::And(a_above, b_above))) {
      edges.add(a, b);
    } else if (!hn::AllFalse(d, hn::Or(a_above, b_above))) {
      // Where the edge passes the horizon.
      const V t = hn::Div(a.height, hn::Sub(a.height, b.height));
      const V3 along = scale3(sub3(b.from_centre, a.from_centre), t);
      const Corner crossing = {add3(a.from_receiver, along), add3(a.from_centre, along), zero};
      leave = select_corner(hn::AndNot(b_above, a_above), crossing, leave);
      enter = select_corner(hn::AndNot(a_above, b_above), crossing, enter);
      const Corner from = select_corner(a_above, a, select_corner(b_above, crossing, middle));
      const Corner to = select_corner(b_above, b, select_corner(a_above, crossing, middle));
      edges.add(from, to);
    }
    a = b;
    a_above = b_above;
  }
  // The horizon closes what it cuts.
  edges.add(leave, enter);
  return hn::Mul(edges.sum(), hn::Set(d, 0.5f * kInvPi));
}

/// Right-handed frame around unit normals [Duff2017].
HWY_INLINE Rows3 frame_of(D d, const V3& n) {
  const V one = hn::Set(d, 1.f), sign = hn::CopySign(one, n.z);
  const V a = hn::Neg(hn::Div(one, hn::Add(sign, n.z)));
  const V b = hn::Mul(hn::Mul(n.x, n.y), a);
  return {{hn::Add(one, hn::Mul(hn::Mul(sign, hn::Mul(n.x, n.x)), a)), hn::Mul(sign, b), hn::Neg(hn::Mul(sign, n.x))},
          {b, hn::Add(sign, hn::Mul(hn::Mul(n.y, n.y), a)), hn::Neg(n.y)},
          n};
}

/// Form factors of lanes that a polygon of the given plane may light, in [0, 1]; 0 for the others.
HWY_INLINE V seen_part(D d, V signed_form_factor, V height, float least_height, EmitterSides sides) {
  const V zero = hn::Zero(d);
  const M front = hn::Gt(height, hn::Set(d, least_height));
  const M back = sides == EmitterSides::two ? hn::Lt(height, hn::Set(d, -least_height)) : hn::Lt(hn::Set(d, 1.f), zero);
  const V outward = hn::IfThenElse(front, signed_form_factor, hn::Neg(signed_form_factor));
  return hn::IfThenElseZero(hn::And(hn::Or(front, back), hn::Gt(outward, zero)), hn::Min(outward, hn::Set(d, 1.f)));
}

}  // namespace sightline::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();

#endif  // SIGHTLINE_SHADE_ANALYTIC_POLYGON_LANES_INL_H_
