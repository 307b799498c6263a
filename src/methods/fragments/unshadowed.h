// What points of a light send to a surface point if nothing is in between.
#pragma once

#include <cmath>

#include "base/math/vec3_batch.h"
#include "methods/fragments/g_buffer.h"

namespace sightline {

/// A surface point as the estimators see it.
struct Receiver {
  Vec3 position, geometric_normal, shading_normal;
  const GlossyPoint* glossy = nullptr;  ///< null: Lambert
};
inline Receiver receiver_at(const GBuffer& g, int x, int y) {
  const std::size_t at = g.at(x, y);
  return {load(g.position, at), load(g.geometric_normal, at), load(g.shading_normal, at),
          g.kind[at] == PixelKind::analytic ? &g.glossy_at(x, y) : nullptr};
}

/// cos cos' / (pi d²) for a light point with normal `light_normal`: irradiance / pi of unit radiance and area; 0 from behind [Koa2017, Eq.
/// 3].
inline float geometry_term(const Receiver& r, const Vec3& point, const Vec3& light_normal, bool two_sided) {
  const Vec3 d = point - r.position;
  const float squared = glm::dot(d, d), cosine = glm::dot(d, r.shading_normal), side = glm::dot(d, r.geometric_normal);
  float away = -glm::dot(d, light_normal);
  if (two_sided) away = std::fabs(away);
  if (!(cosine > 0 && side > 0 && away > 0)) return 0;
  return cosine * away / (kPi * squared * squared);
}

/// How much more than a white Lambert surface one with a lobe reflects from unit `wi`, luminance.
inline float lobe_weight(const Receiver& r, const Vec3& wi) {
  const Vec3 wo_local = r.glossy->frame.to_local(r.glossy->wo), wi_local = r.glossy->frame.to_local(wi);
  const Color f_cos = r.glossy->bsdf.evaluate(wo_local, wi_local).f_cos;
  return luminance(f_cos) * kPi / std::fmax(std::fabs(wi_local.z), 1e-6f);
}
inline float reflected_term(const Receiver& r, const Vec3& point, const Vec3& light_normal, bool two_sided) {
  const float geometry = geometry_term(r, point, light_normal, two_sided);
  return r.glossy && geometry > 0 ? geometry * lobe_weight(r, glm::normalize(point - r.position)) : geometry;
}

}  // namespace sightline
