// Multiple importance sampling over all strategies (s, t) of a path, by sums that both subpaths carry along.
#pragma once

#include <cmath>

namespace sightline::bidirectional {

/// How densities are weighed against each other [Veach1997, §9.2]: by themselves or by their squares.
struct Heuristic {
  bool power = true;
  double operator()(double ratio) const { return power ? ratio * ratio : ratio; }
};

/// What a vertex z_i of a subpath must know to weigh the strategies that have fewer vertices of its own subpath. Both subpaths are alike:
/// i counts from the light on one side and from the camera on the other, "own" densities are those of the subpath's own sampler, "reverse"
/// ones those of the other side's. Densities are by area, or by solid angle for vertices at infinity.
///
/// With p_j the density of the strategy that takes j vertices from this side, p_j / p_(j+1) = reverse(z_j) / own(z_j), so that
///   sum_i = (sum over j <= i of p_j / p_i without the factor of z_i itself) = connect_i + (reverse(z_(i-1)) / own(z_(i-1))) sum_(i-1),
/// where connect_i is 1 if z_(i-1) and z_i may be connected and 0 if one of them scatters by a delta: [Veach1997, §10.2], written as the
/// recursion of [Georgiev2012].
struct MisVertex {
  double previous_sum = 0;  ///< sum_(i-1)
  double connect = 0;       ///< weight of the connection of z_(i-1) and z_i, as far as z_(i-1) allows it
  double pdf = 0;           ///< own density of z_i
  double previous_pdf = 0;  ///< own density of z_(i-1)
  double to_previous = 0;   ///< turns a density of directions at z_i into one of z_(i-1)

  /// sum_i, given the density `reverse` with which the other side's sampler, at z_i, would have chosen the direction to z_(i-1).
  double sum(Heuristic h, double reverse, bool scatters_by_delta) const {
    double result = scatters_by_delta ? 0 : connect;
    if (previous_sum > 0) result += h(reverse * to_previous / previous_pdf) * previous_sum;
    return result;
  }
};

/// What the next vertex inherits from `vertex`, whose scattering chose the way on: `reverse` is the density of directions with which the
/// other side's sampler would have come back.
inline MisVertex after(const MisVertex& vertex, Heuristic h, double reverse, bool scatters_by_delta) {
  MisVertex next;
  next.previous_sum = vertex.sum(h, reverse, scatters_by_delta);
  next.previous_pdf = vertex.pdf;
  next.connect = scatters_by_delta ? 0 : 1;
  return next;
}

/// Completes `next` at the end of an edge: `pdf` is the density of directions of its ray, and the cosines are those between the edge and
/// both surfaces (1 where there is none). From infinity `pdf` is by area across the beam, and the squared length counts as 1.
inline void arrive(MisVertex& next, double pdf, double cosine, double previous_cosine, double squared_length) {
  next.pdf = pdf * cosine / squared_length;
  next.to_previous = previous_cosine / squared_length;
}

/// Weight of a connection of two vertices: `eye_pdf_light` is the density by area with which the eye's sampler would have made the light
/// subpath's end, `light_pdf_eye` the converse; sums are MisVertex::sum of both ends (0 for an eye that is the camera).
inline double connection_weight(Heuristic h, double eye_pdf_light, double light_own_pdf, double light_sum, double light_pdf_eye,
                                double eye_own_pdf, double eye_sum) {
  double others = 0;
  if (light_sum > 0) others += h(eye_pdf_light / light_own_pdf) * light_sum;
  if (eye_sum > 0) others += h(light_pdf_eye / eye_own_pdf) * eye_sum;
  return 1 / (1 + others);
}

/// What light sampling and emission would have given a path that begins on a light.
struct LightDensities {
  double direct = 0;  ///< of the point, as light sampling chooses it from the next vertex (s = 1)
  double start = 0;   ///< of the point, as paths from lights begin (s >= 2)
  double leave = 0;   ///< of the next vertex given the point, by area
};

/// s = 1: a light sample seen from eye vertex `eye`. `found` is the density with which the eye's sampler would have found the point, 0
/// where rays cannot; `eye_sum` is MisVertex::sum of the eye vertex.
inline double light_sample_weight(Heuristic h, const LightDensities& light, double found, const MisVertex& eye, double eye_sum) {
  double others = h(found / light.direct);
  if (eye_sum > 0) others += h(light.start / light.direct) * h(light.leave / eye.pdf) * eye_sum;
  return 1 / (1 + others);
}

/// s = 0: the eye subpath ended on a light by itself; `hit` is that vertex. `light.leave` is by solid angle here: the density with which
/// emission would have left the point towards the vertex before.
inline double emission_weight(Heuristic h, const LightDensities& light, const MisVertex& hit, bool seen_by_camera) {
  // Directly seen lights compete with the light image of the light subpath's first vertex alone.
  double others = h((seen_by_camera ? light.start : light.direct) / hit.pdf) * hit.connect;
  if (hit.previous_sum > 0) others += h(light.start / hit.pdf) * h(light.leave * hit.to_previous / hit.previous_pdf) * hit.previous_sum;
  return 1 / (1 + others);
}

}  // namespace sightline::bidirectional
