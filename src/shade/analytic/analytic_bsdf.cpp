#include "shade/analytic/analytic_bsdf.h"

#include <cmath>

#include "shade/fresnel.h"
#include "shade/ggx_albedo.h"

namespace sightline {

namespace {

/// The form of each model; nothing for those without.
struct FormOf {
  std::optional<AnalyticBsdf> operator()(const Lambert& m) const { return AnalyticBsdf{.diffuse = m.reflectance}; }
  std::optional<AnalyticBsdf> operator()(const MetallicRoughness& m) const {
    return AnalyticBsdf{.diffuse = m.diffuse(), .coated = true, .has_specular = !m.ggx().is_smooth(), .ggx = m.ggx(), .f0 = m.f0()};
  }
  std::optional<AnalyticBsdf> operator()(const Conductor& m) const {
    if (m.ggx().alpha().x != m.ggx().alpha().y) return std::nullopt;
    // cos (1 - cos)^6 is greatest at 1/7; there the fit is made exact.
    constexpr float kPeak = 1.f / 7;
    constexpr float kLobe = kPeak * (6 * kPeak) * (6 * kPeak) * (6 * kPeak) * (6 * kPeak) * (6 * kPeak) * (6 * kPeak);
    const Color f0 = fresnel_conductor(1, m.eta(), m.k());
    const Color metal = (fresnel_conductor(kPeak, m.eta(), m.k()) - fresnel_schlick(f0, kPeak)) / kLobe;
    return AnalyticBsdf{.has_specular = !m.ggx().is_smooth(), .ggx = m.ggx(), .f0 = f0, .metal = metal, .scale = m.tint()};
  }
  std::optional<AnalyticBsdf> operator()(const Phong& m) const {
    if (!is_black(m.specular())) return std::nullopt;
    return AnalyticBsdf{.diffuse = m.diffuse()};
  }
  template <class Other>
  std::optional<AnalyticBsdf> operator()(const Other&) const {
    return std::nullopt;
  }
};

}  // namespace

std::optional<AnalyticBsdf> analytic_form(const Bsdf& bsdf) { return std::visit(FormOf(), bsdf.model()); }

AnalyticLobes analytic_lobes(const AnalyticBsdf& bsdf, float cos_o) {
  const float cosine = std::fabs(cos_o);
  AnalyticLobes lobes;
  lobes.diffuse = bsdf.diffuse;
  if (bsdf.coated && !is_black(bsdf.diffuse)) {
    // diffuse (1 - E(wo)) (1 - E(wi)), the last factor split into what is constant and what is stretched.
    const CoatAlbedoFit fit = coat_albedo_fit(bsdf.ggx);
    const Color let_out = bsdf.diffuse * (1.f - ggx_schlick_albedo(bsdf.f0, cosine, bsdf.ggx));
    const Color mean = bsdf.f0 * fit.mean.x + (1.f - bsdf.f0) * fit.mean.y,
                amount = bsdf.f0 * fit.amount.x + (1.f - bsdf.f0) * fit.amount.y;
    lobes.diffuse = let_out * (1.f - mean + amount);
    lobes.wide = -let_out * amount;
    lobes.stretch = fit.stretch;
  }
  if (bsdf.has_specular) {
    const LtcLobe lobe = ltc_lobe(cosine, bsdf.ggx.alpha().x);
    lobes.specular = bsdf.scale * lobe.scale * (bsdf.f0 * lobe.energy + (1.f - bsdf.f0) * lobe.schlick + bsdf.metal * lobe.metal);
    lobes.m11 = lobe.m11, lobes.m13 = lobe.m13, lobes.m31 = lobe.m31, lobes.m33 = lobe.m33;
  }
  return lobes;
}

}  // namespace sightline
