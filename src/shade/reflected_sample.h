// What models share whose two sides reflect alike: directions are sampled above the surface and turned over where wo lies below it.
#pragma once

#include <cmath>
#include <optional>

#include "shade/bsdf_types.h"

namespace sightline {

inline Vec3 upper_side(const Vec3& w) { return {w.x, w.y, std::fabs(w.z)}; }

/// The mirror's direction, as a delta chosen with probability `pdf`.
inline BsdfSample mirror_sample(const Vec3& wo, const Color& weight, float pdf) {
  BsdfSample s;
  s.wi = Vec3(-wo.x, -wo.y, wo.z);
  s.weight = weight;
  s.pdf = pdf;
  s.is_delta = true;
  return s;
}

/// `wi`, which one of several lobes gave for upper_side(wo), weighted by `evaluate(wi)`, the sum of all lobes; nothing below the surface.
template <class Evaluate>
std::optional<BsdfSample> reflected_sample(const Vec3& wo, const Vec3& wi, const Evaluate& evaluate) {
  if (!(wi.z > 0)) return std::nullopt;
  const BsdfEval e = evaluate(wi);
  if (!(e.pdf > 0)) return std::nullopt;
  BsdfSample s;
  s.wi = {wi.x, wi.y, wo.z < 0 ? -wi.z : wi.z};
  s.weight = e.f_cos / e.pdf;
  s.pdf = e.pdf;
  return s;
}

}  // namespace sightline
