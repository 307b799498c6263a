#include "shade/bsdf_albedo.h"

#include <cmath>

#include "shade/sphere_quadrature.h"

namespace sightline {

namespace {

constexpr int kColumns = 16, kLobeProbes = 1024;

/// What a few samples tell: delta parts, and around which direction transmitted light gathers.
struct Probe {
  Color delta_reflected{0}, delta_transmitted{0};
  Vec3 transmitted_axis;

  Probe(const Bsdf& bsdf, const Vec3& wo, TransportMode mode) {
    Vec3 sum(0);
    for (int i = 0; i < kLobeProbes; ++i) {
      const Vec2 u{(static_cast<float>(i % kColumns) + 0.5f) / kColumns,
                   (static_cast<float>(i / kColumns % kColumns) + 0.5f) / kColumns};  // NOLINT(bugprone-integer-division): the row
      const auto s = bsdf.sample(wo, (static_cast<float>(i) + 0.5f) / kLobeProbes, u, mode);
      if (!s) continue;
      // A delta part is one direction, so that weight times probability is all of it.
      if (s->is_delta) (s->is_transmission ? delta_transmitted : delta_reflected) = s->weight * s->pdf;
      if (!s->is_delta && s->is_transmission) sum += s->wi;
    }
    transmitted_axis = normalize_or(sum, -wo);
  }
};

glm::dvec4 integrate_side(const Bsdf& bsdf, const Vec3& wo, TransportMode mode, const Vec3& axis, double tolerance) {
  constexpr int kCells = 8, kDepth = 7;
  constexpr float kPower = 4;
  const PolarMap map(axis, kPower);
  const auto integrand = [&](double s, double turn) {
    const Vec3 wi = map.direction(s, turn);
    if (wi.z * axis.z <= 0) return glm::dvec4(0);
    const BsdfEval e = bsdf.evaluate(wo, wi, mode);
    return glm::dvec4(e.f_cos, e.pdf) * map.jacobian(s);
  };
  glm::dvec4 sum(0);
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j)
      sum += integrate_cell(integrand,
                            {static_cast<double>(i) / kCells, (i + 1.0) / kCells, static_cast<double>(j) / kCells, (j + 1.0) / kCells},
                            tolerance / (kCells * kCells), kDepth);
  return sum;
}

}  // namespace

DirectionalAlbedo integrate_directional_albedo(const Bsdf& bsdf, const Vec3& wo, TransportMode mode, float tolerance) {
  DirectionalAlbedo result;
  const Probe probe(bsdf, wo, mode);
  result.delta_reflected = probe.delta_reflected;
  result.delta_transmitted = probe.delta_transmitted;
  if (bsdf.is_delta()) return result;
  const glm::dvec4 near_side = integrate_side(bsdf, wo, mode, Vec3(-wo.x, -wo.y, wo.z), tolerance);
  const glm::dvec4 far_side = integrate_side(bsdf, wo, mode, probe.transmitted_axis, tolerance);
  result.reflected = Color(near_side);
  result.transmitted = Color(far_side);
  result.density = static_cast<float>(near_side.w + far_side.w);
  return result;
}

}  // namespace sightline
