#include "methods/bidirectional/vertex.h"

#include <cmath>

#include "methods/media.h"
#include "shade/material_eval.h"

namespace sightline::bidirectional {
namespace {

/// Whether the shading normal sees w on the same side as the geometric one.
bool agrees(const Vec3& shading, const Vec3& geometric, const Vec3& w) { return glm::dot(w, shading) * glm::dot(w, geometric) > 0; }

Vec3 normal_seen_from(const Surface& surface, const Vec3& w) {
  return agrees(surface.frame.normal, surface.side_normal(), w) ? surface.frame.normal : frame_seen_from(surface, w).normal;
}

/// Reflection by the shading normal must be reflection by the geometric one, else light leaks through.
bool is_consistent(const Surface& surface, const Vec3& local_a, const Vec3& local_b, const Vec3& a, const Vec3& b) {
  return (local_a.z * local_b.z > 0) == (glm::dot(a, surface.side_normal()) * glm::dot(b, surface.side_normal()) > 0);
}

ScatterEval evaluate_lambert(const Surface& surface, const Lambert& lambert, const Vec3& wo, const Vec3& wi) {
  const Vec3& ng = surface.side_normal();
  if (!(glm::dot(wo, ng) * glm::dot(wi, ng) > 0)) return {};
  const Vec3 seen = normal_seen_from(surface, wo);
  const float cos_o = glm::dot(wo, seen), cos_i = glm::dot(wi, seen);
  if (!(cos_o * cos_i > 0)) return {};
  const Vec3 lit = normal_seen_from(surface, wi);
  const float reverse_o = glm::dot(wo, lit), reverse_i = glm::dot(wi, lit);
  const float pdf = std::fabs(cos_i) * kInvPi;
  return {lambert.reflectance * pdf, pdf, reverse_o * reverse_i > 0 ? std::fabs(reverse_o) * kInvPi : 0.f};
}

}  // namespace

Frame3 frame_seen_from(const Surface& surface, const Vec3& w) {
  const Vec3& ng = surface.side_normal();
  if (agrees(surface.frame.normal, ng, w)) return surface.frame;
  if (surface.plain) return frame_from_normal(ng);
  const Frame3 turned = face_viewer(surface.frame, surface.tangent, ng, w);
  return agrees(turned.normal, ng, w) ? turned : frame_from_normal_tangent(ng, turned.tangent);
}

ScatterEval evaluate_scatter(const Surface& surface, const Vec3& wo, const Vec3& wi) {
  if (const Lambert* lambert = surface.bsdf.lambert()) return evaluate_lambert(surface, *lambert, wo, wi);
  const Frame3 seen = frame_seen_from(surface, wo);
  const Vec3 o = seen.to_local(wo), i = seen.to_local(wi);
  if (!is_consistent(surface, o, i, wo, wi)) return {};
  const BsdfEval eye = surface.bsdf.evaluate(o, i, TransportMode::radiance);
  if (is_black(eye.f_cos)) return {};
  const Frame3 lit = frame_seen_from(surface, wi);
  const Vec3 lit_o = lit.to_local(wo), lit_i = lit.to_local(wi);
  ScatterEval result{eye.f_cos, eye.pdf, 0};
  if (is_consistent(surface, lit_o, lit_i, wo, wi)) result.pdf_light = surface.bsdf.evaluate(lit_i, lit_o, TransportMode::importance).pdf;
  return result;
}

std::optional<ScatterSample> sample_from_eye(const Surface& surface, const Vec3& wo, float u_lobe, const Vec2& u) {
  const Frame3 seen = frame_seen_from(surface, wo);
  const Vec3 o = seen.to_local(wo);
  const std::optional<BsdfSample> sample = surface.bsdf.sample(o, u_lobe, u, TransportMode::radiance);
  if (!sample) return std::nullopt;
  ScatterSample s;
  s.direction = seen.to_world(sample->wi);
  s.crosses = glm::dot(s.direction, surface.side_normal()) * glm::dot(wo, surface.side_normal()) < 0;
  if (s.crosses != sample->is_transmission) return std::nullopt;
  s.weight = sample->weight;
  s.pdf = sample->pdf;
  s.is_delta = sample->is_delta;
  s.eta = sample->eta;
  if (!s.is_delta) {
    s.pdf_reverse = evaluate_scatter(surface, wo, s.direction).pdf_light;
  } else if (normal_seen_from(surface, s.direction) == seen.normal) {
    // eta_o² cos_o dw_o = eta_i² cos_i dw_i.
    s.pdf_reverse = s.pdf * std::fabs(o.z / sample->wi.z) / (s.eta * s.eta);
  }
  return s;
}

std::optional<ScatterSample> sample_from_light(const Surface& surface, const Vec3& wi, float u_lobe, const Vec2& u) {
  const Frame3 lit = frame_seen_from(surface, wi);
  const Vec3 i = lit.to_local(wi);
  const std::optional<BsdfSample> sample = surface.bsdf.sample(i, u_lobe, u, TransportMode::importance);
  if (!sample) return std::nullopt;
  ScatterSample s;
  s.direction = lit.to_world(sample->wi);
  const float leaving = glm::dot(s.direction, surface.geometric_normal);
  s.crosses = glm::dot(s.direction, surface.side_normal()) * glm::dot(wi, surface.side_normal()) < 0;
  if (s.crosses != sample->is_transmission) return std::nullopt;
  s.is_delta = sample->is_delta;
  s.eta = sample->eta;
  if (!s.is_delta) {
    const ScatterEval eval = evaluate_scatter(surface, s.direction, wi);
    s.weight = eval.f_cos * (std::fabs(leaving) / sample->pdf);
    s.pdf = sample->pdf;
    s.pdf_reverse = eval.pdf_eye;
    return s;
  }
  // An eye that sees another normal there has no such delta.
  if (normal_seen_from(surface, s.direction) != lit.normal || sample->wi.z == 0) return std::nullopt;
  const float cosines = std::fabs(i.z / sample->wi.z);
  s.weight = sample->weight * (cosines * std::fabs(leaving));
  s.pdf_reverse = sample->pdf;
  s.pdf = sample->pdf * s.eta * s.eta / cosines;
  return s;
}

MediumId medium_towards(const PathVertex& vertex, const Vec3& w) {
  return Media::towards(w, vertex.to_previous, vertex.surface.side_normal(), vertex.medium, vertex.surface.interior);
}

}  // namespace sightline::bidirectional
