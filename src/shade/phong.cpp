#include "shade/phong.h"

#include <algorithm>
#include <cmath>

#include "base/math/frame.h"
#include "base/sample/warp.h"

namespace sightline {

Phong::Phong(const Color& diffuse, const Color& specular, float exponent)
    : diffuse_(glm::max(diffuse, 0.f)), specular_(glm::max(specular, 0.f)), exponent_(std::clamp(exponent, 0.f, 1e6f)) {
  const Color scale = 1.f / glm::max(diffuse_ + specular_, Color(1));
  diffuse_ *= scale;
  specular_ *= scale;
  const float d = luminance(diffuse_), s = luminance(specular_);
  specular_probability_ = d + s > 0 ? s / (d + s) : 0;
}

BsdfEval Phong::evaluate(const Vec3& wo, const Vec3& wi, TransportMode) const {
  if (!(wo.z * wi.z > 0)) return {};
  const float cosine = std::fabs(wi.z);
  BsdfEval result{diffuse_ * (cosine * kInvPi), (1 - specular_probability_) * cosine * kInvPi};
  if (specular_probability_ > 0) {
    const float lobe = pdf_phong_lobe(std::min(glm::dot(Vec3(-wo.x, -wo.y, wo.z), wi), 1.f), exponent_);
    result.f_cos += specular_ * (lobe * cosine * (exponent_ + 2) / (exponent_ + 1));
    result.pdf += specular_probability_ * lobe;
  }
  return result;
}

std::optional<BsdfSample> Phong::sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode) const {
  BsdfSample s;
  if (u_lobe < specular_probability_) {
    s.wi = frame_from_normal(Vec3(-wo.x, -wo.y, wo.z)).to_world(sample_phong_lobe(u, exponent_));
  } else {
    s.wi = sample_cosine_hemisphere(u);
    if (wo.z < 0) s.wi.z = -s.wi.z;
  }
  const BsdfEval e = evaluate(wo, s.wi, mode);
  if (!(e.pdf > 0)) return std::nullopt;
  s.pdf = e.pdf;
  s.weight = e.f_cos / e.pdf;
  return s;
}

}  // namespace sightline
