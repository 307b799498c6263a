#include "shade/ggx_albedo.h"

#include <algorithm>
#include <cmath>

#include "shade/fresnel.h"
#include "shade/ggx_albedo_table.h"

namespace sightline {

namespace {

using namespace ggx_table;

/// Where `position` in [0, 1] lies between the nodes of an axis.
struct AxisPoint {
  int low;
  float fraction;

  AxisPoint(float position, int count) {
    const float scaled = (position > 0 ? std::min(position, 1.f) : 0.f) * static_cast<float>(count - 1);
    low = std::min(static_cast<int>(scaled), count - 2);
    fraction = scaled - static_cast<float>(low);
  }
  float mix(float a, float b) const { return a + fraction * (b - a); }
};

AxisPoint cos_axis(float cos_theta) { return {std::sqrt(cos_theta), kCosCount}; }
AxisPoint alpha_axis(const Ggx& ggx) { return {std::sqrt(std::sqrt(ggx.alpha().x * ggx.alpha().y)), kAlphaCount}; }
AxisPoint eta_axis(float eta) { return {std::sqrt(2 * (eta - 1) / (eta + 1)), kEtaCount}; }

/// Sums `term(reflected, shadowing, cosine at the micro-facet)` over visible normals.
template <class Term>
void for_each_reflection(float cos_theta, float alpha, int resolution, const Term& term) {
  const Ggx ggx(alpha, alpha);
  const float cosine = std::max(cos_theta, 1e-6f);
  const Vec3 wo{std::sqrt(std::max(0.f, 1 - cosine * cosine)), 0, cosine};
  const float masking = ggx.masking_over_cosine(wo);
  const float step = 1 / static_cast<float>(resolution);
  for (int row = 0; row < resolution; ++row) {
    for (int column = 0; column < resolution; ++column) {
      const Vec2 u{(static_cast<float>(row) + 0.5f) * step, (static_cast<float>(column) + 0.5f) * step};
      const Vec3 m = ggx.sample_visible(wo, u);
      const Vec3 wi = reflect_about(wo, m);
      if (wi.z > 0) term(ggx.shadowing_over_cosine(wo, wi) / masking, glm::dot(wo, m));
    }
  }
}

}  // namespace

float ggx_dielectric_albedo(float cos_theta, const Ggx& ggx, float eta) {
  const float smooth = fresnel_dielectric(cos_theta, eta);
  if (ggx.is_smooth()) return smooth;
  const AxisPoint c = cos_axis(cos_theta), a = alpha_axis(ggx), e = eta_axis(eta);
  const auto row = [&](int eta_index, int alpha_index) {
    const float* values = kDielectric[eta_index][alpha_index] + c.low;
    return c.mix(values[0], values[1]);
  };
  const auto plane = [&](int eta_index) { return a.mix(row(eta_index, a.low), row(eta_index, a.low + 1)); };
  return smooth * e.mix(plane(e.low), plane(e.low + 1));
}

float ggx_dielectric_mean_albedo(const Ggx& ggx, float eta) {
  if (ggx.is_smooth()) return fresnel_dielectric_diffuse(eta);
  const AxisPoint a = alpha_axis(ggx), e = eta_axis(eta);
  const auto row = [&](int eta_index) { return a.mix(kDielectricMean[eta_index][a.low], kDielectricMean[eta_index][a.low + 1]); };
  return e.mix(row(e.low), row(e.low + 1)) * (eta - 1) / (eta + 1);
}

Color ggx_schlick_albedo(const Color& f0, float cos_theta, const Ggx& ggx) {
  if (ggx.is_smooth()) return fresnel_schlick(f0, cos_theta);
  const AxisPoint c = cos_axis(cos_theta), a = alpha_axis(ggx);
  const auto value = [&](int part) {
    const auto row = [&](int alpha_index) { return c.mix(kSchlick[alpha_index][c.low][part], kSchlick[alpha_index][c.low + 1][part]); };
    return a.mix(row(a.low), row(a.low + 1));
  };
  return f0 * value(0) + (1.f - f0) * value(1);
}

SurfaceLobes::Nodes ggx_dielectric_albedo_nodes(const Ggx& ggx, float eta) {
  const AxisPoint a = alpha_axis(ggx), e = eta_axis(eta);
  SurfaceLobes::Nodes nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto plane = [&](int eta_index) { return a.mix(kDielectric[eta_index][a.low][i], kDielectric[eta_index][a.low + 1][i]); };
    nodes[i] = e.mix(plane(e.low), plane(e.low + 1));
  }
  return nodes;
}

void ggx_schlick_albedo_nodes(const Ggx& ggx, SurfaceLobes::Nodes& f0_part, SurfaceLobes::Nodes& rest) {
  const AxisPoint a = alpha_axis(ggx);
  for (std::size_t i = 0; i < f0_part.size(); ++i) {
    f0_part[i] = a.mix(kSchlick[a.low][i][0], kSchlick[a.low + 1][i][0]);
    rest[i] = a.mix(kSchlick[a.low][i][1], kSchlick[a.low + 1][i][1]);
  }
}

Color ggx_schlick_mean_albedo(const Color& f0, const Ggx& ggx) {
  // The cosine-weighted mean of (1 - cos)^5 is 1/21.
  if (ggx.is_smooth()) return f0 + (1.f - f0) / 21.f;
  const AxisPoint a = alpha_axis(ggx);
  const auto value = [&](int part) { return a.mix(kSchlickMean[a.low][part], kSchlickMean[a.low + 1][part]); };
  return f0 * value(0) + (1.f - f0) * value(1);
}

float integrate_ggx_dielectric_albedo(float cos_theta, float alpha, float eta, int resolution) {
  if (alpha < Ggx::kSmooth) return fresnel_dielectric(cos_theta, eta);
  double sum = 0;
  for_each_reflection(cos_theta, alpha, resolution,
                      [&](float shadowing, float cosine) { sum += shadowing * fresnel_dielectric(cosine, eta); });
  return static_cast<float>(sum / (static_cast<double>(resolution) * resolution));
}

Vec2 integrate_ggx_schlick_albedo(float cos_theta, float alpha, int resolution) {
  // F = f0 + (1 - f0) w, w the Schlick weight.
  if (alpha < Ggx::kSmooth) return {1, schlick_weight(cos_theta)};
  double all = 0, weighted = 0;
  for_each_reflection(cos_theta, alpha, resolution, [&](float shadowing, float cosine) {
    all += shadowing;
    weighted += shadowing * schlick_weight(cosine);
  });
  const double count = static_cast<double>(resolution) * resolution;
  return {static_cast<float>(all / count), static_cast<float>(weighted / count)};
}

}  // namespace sightline
