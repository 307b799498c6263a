#include "shade/dielectric.h"

#include <cmath>

#include "shade/fresnel.h"

namespace sightline {

namespace {

/// Below this difference of the indices a rough interface bends light so little that its half vectors drown in rounding: it passes as
/// smooth.
constexpr float kLeastContrast = 1e-3f;

/// Refraction of w (at `cosine` = w·m > 0) into the far side of index ratio eta, whose cosine is `cos_t`.
Vec3 refract_through(const Vec3& w, const Vec3& m, float cosine, float eta, float cos_t) { return -w / eta + (cosine / eta - cos_t) * m; }

}  // namespace

Dielectric::Dielectric(float eta, const Ggx& ggx, bool thin)
    : eta_(eta > 0 && std::isfinite(eta) ? eta : 1.f),
      ggx_(ggx),
      thin_(thin),
      delta_(thin || ggx.is_smooth() || std::fabs(eta_ - 1) < kLeastContrast) {}

BsdfEval Dielectric::evaluate(const Vec3& wo, const Vec3& wi, TransportMode mode) const {
  if (delta_ || wo.z == 0 || wi.z == 0) return {};
  const float eta = wo.z > 0 ? eta_ : 1 / eta_;
  const bool reflects = (wo.z > 0) == (wi.z > 0);
  Vec3 m = reflects ? wo + wi : wo + eta * wi;
  const float m_length2 = length_squared(m);
  if (!(m_length2 > 0) || m.z == 0) return {};
  m *= std::copysign(1 / std::sqrt(m_length2), m.z);
  const float cos_o = glm::dot(wo, m), cos_i = glm::dot(wi, m);
  // Micro-facets that are seen from behind on either side do not count.
  if (!(cos_o * wo.z > 0) || !(cos_i * wi.z > 0)) return {};
  const float fresnel = fresnel_dielectric(std::fabs(cos_o), eta);
  const float distribution = ggx_.distribution(m);
  float jacobian = 0.5f * fresnel;
  float radiance_scale = 1;
  if (!reflects) {
    // d m / d wi of [Walter2007, Eq. 17]; the factor 2 belongs to the cosine that Ggx divides by.
    const float denominator = cos_i + cos_o / eta;
    jacobian = (1 - fresnel) * 2 * std::fabs(cos_i * cos_o) / (denominator * denominator);
    if (mode == TransportMode::radiance) radiance_scale = 1 / (eta * eta);
  }
  return {Color(distribution * jacobian * radiance_scale * ggx_.shadowing_over_cosine(wo, wi)),
          distribution * jacobian * ggx_.masking_over_cosine(wo)};
}

std::optional<BsdfSample> Dielectric::sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode) const {
  if (wo.z == 0) return std::nullopt;
  if (delta_) return sample_smooth(wo, u_lobe, mode);
  const float side = wo.z < 0 ? -1.f : 1.f;
  const float eta = wo.z > 0 ? eta_ : 1 / eta_;
  const Vec3 upper{wo.x, wo.y, side * wo.z};
  const Vec3 m = ggx_.sample_visible(upper, u);
  const float cosine = glm::dot(upper, m);
  if (!(cosine > 0)) return std::nullopt;
  float cos_t;
  const float fresnel = fresnel_dielectric(cosine, eta, cos_t);
  const float masking = ggx_.masking_over_cosine(upper);
  BsdfSample s;
  s.is_transmission = !(u_lobe < fresnel);
  float jacobian = 0.5f * fresnel;
  float radiance_scale = 1;
  if (s.is_transmission) {
    s.wi = refract_through(upper, m, cosine, eta, cos_t);
    if (!(s.wi.z < 0) || !(cos_t > 0)) return std::nullopt;
    const float denominator = cosine / eta - cos_t;
    jacobian = (1 - fresnel) * 2 * cosine * cos_t / (denominator * denominator);
    s.eta = eta;
    if (mode == TransportMode::radiance) radiance_scale = 1 / (eta * eta);
  } else {
    s.wi = reflect_about(upper, m);
    if (!(s.wi.z > 0)) return std::nullopt;
  }
  s.wi = glm::normalize(s.wi);
  s.pdf = ggx_.distribution(m) * jacobian * masking;
  s.weight = Color(radiance_scale * ggx_.shadowing_over_cosine(upper, s.wi) / masking);
  if (!(s.pdf > 0) || !std::isfinite(s.pdf)) return std::nullopt;
  s.wi.z *= side;
  return s;
}

DeltaLobes Dielectric::delta_lobes(const Vec3& wo, TransportMode mode) const {
  DeltaLobes lobes;
  if (!delta_ || wo.z == 0) return lobes;
  const float eta = wo.z > 0 || thin_ ? eta_ : 1 / eta_;
  float cos_t;
  float reflectance = fresnel_dielectric(std::fabs(wo.z), eta, cos_t);
  // R + T R T + T R R R T + ... = 2 R / (1 + R) for a slab.
  if (thin_) reflectance = 2 * reflectance / (1 + reflectance);
  BsdfSample s;
  s.is_delta = true;
  if (reflectance > 0) {
    s.wi = Vec3(-wo.x, -wo.y, wo.z);
    s.weight = Color(reflectance);
    s.pdf = reflectance;
    lobes.add(s);
  }
  if (reflectance < 1) {
    s.is_transmission = true;
    s.pdf = 1 - reflectance;
    s.weight = Color(s.pdf);
    s.wi = -wo;
    if (!thin_) {
      s.wi = glm::normalize(Vec3(-wo.x / eta, -wo.y / eta, std::copysign(cos_t, -wo.z)));
      s.eta = eta;
      if (mode == TransportMode::radiance) s.weight *= 1 / (eta * eta);
    }
    lobes.add(s);
  }
  return lobes;
}

std::optional<BsdfSample> Dielectric::sample_smooth(const Vec3& wo, float u_lobe, TransportMode mode) const {
  // One of the lobes, each as often as its share.
  const DeltaLobes lobes = delta_lobes(wo, mode);
  BsdfSample s = lobes[lobes.size() > 1 && !(u_lobe < lobes[0].pdf) ? 1 : 0];
  s.weight = Color(mode == TransportMode::radiance ? 1 / (s.eta * s.eta) : 1.f);
  return s;
}

}  // namespace sightline
