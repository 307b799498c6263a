#include "bsdf_cases.h"

#include <cmath>

namespace sightline::test {

namespace {

const Color kGoldEta{0.143f, 0.375f, 1.442f}, kGoldK{3.983f, 2.386f, 1.603f};

}  // namespace

std::vector<BsdfCase> rough_cases() {
  const Color tan{0.8f, 0.5f, 0.2f};
  return {
      {"lambert", Bsdf(Lambert{tan})},
      {"diffuse transmission", Bsdf(DiffuseTransmission(tan * 0.6f, tan * 0.3f))},
      {"phong, broad", Bsdf(Phong(tan * 0.5f, Color(0.4f), 5))},
      {"phong, narrow", Bsdf(Phong(tan * 0.2f, Color(0.7f), 2000)), true},
      {"metallic-roughness, dielectric", Bsdf(MetallicRoughness(tan, 0, 0.6f))},
      {"metallic-roughness, metal", Bsdf(MetallicRoughness(tan, 1, 0.4f))},
      {"metallic-roughness, half metal, polished", Bsdf(MetallicRoughness(tan, 0.5f, 0.15f)), true},
      {"metallic-roughness, smooth dielectric", Bsdf(MetallicRoughness(tan, 0, 0))},
      {"metallic-roughness, white, roughest", Bsdf(MetallicRoughness(Color(1), 0, 1))},
      {"conductor, rough", Bsdf(Conductor(kGoldEta, kGoldK, Color(1), Ggx(0.4f, 0.4f)))},
      {"conductor, brushed", Bsdf(Conductor(kGoldEta, kGoldK, Color(1), Ggx(0.5f, 0.1f))), true},
      {"conductor, polished", Bsdf(Conductor(kGoldEta, kGoldK, Color(1), Ggx(0.02f, 0.02f))), true},
      {"dielectric, rough", Bsdf(Dielectric(1.5f, Ggx(0.4f, 0.4f), false))},
      {"dielectric, brushed", Bsdf(Dielectric(1.33f, Ggx(0.15f, 0.5f), false)), true},
      {"dielectric, frosted", Bsdf(Dielectric(1.8f, Ggx(0.08f, 0.08f), false)), true},
      {"dielectric, bubble", Bsdf(Dielectric(1 / 1.5f, Ggx(0.3f, 0.3f), false))},
      {"coated diffuse, smooth", Bsdf(CoatedDiffuse(tan, 1.5f, Ggx()))},
      {"coated diffuse, rough", Bsdf(CoatedDiffuse(tan, 1.5f, Ggx(0.3f, 0.3f)))},
      {"coated diffuse, polished", Bsdf(CoatedDiffuse(tan, 1.8f, Ggx(0.05f, 0.05f))), true},
      {"ward, broad", Bsdf(Ward(tan * 0.4f, Color(0.5f), 0.4f, 0.4f))},
      {"ward, brushed", Bsdf(Ward(tan * 0.2f, Color(0.6f), 0.08f, 0.4f)), true},
      {"ward, polished", Bsdf(Ward(Color(0), tan, 0.03f, 0.03f)), true},
      {"cook-torrance, rough", Bsdf(CookTorrance(tan * 0.4f, Color(0.6f), 0.5f, Color(0.3f)))},
      {"cook-torrance, metal", Bsdf(CookTorrance(Color(0), Color(1), 0.3f, Color(0.95f, 0.64f, 0.54f)))},
      {"cook-torrance, polished", Bsdf(CookTorrance(tan * 0.5f, Color(0.5f), 0.05f, Color(0.04f))), true},
      {"measured", Bsdf(MeasuredBrdf(measured_paint()))},
  };
}

std::vector<BsdfCase> delta_cases() {
  return {
      {"conductor, mirror", Bsdf(Conductor(kGoldEta, kGoldK, Color(1), Ggx()))},
      {"metallic-roughness, mirror", Bsdf(MetallicRoughness(Color(0.9f, 0.8f, 0.3f), 1, 0))},
      {"dielectric, smooth", Bsdf(Dielectric(1.5f, Ggx(), false))},
      {"dielectric, thin", Bsdf(Dielectric(1.5f, Ggx(), true))},
      {"dielectric, no contrast", Bsdf(Dielectric(1, Ggx(0.3f, 0.3f), false))},
  };
}

std::vector<BsdfCase> all_cases() {
  std::vector<BsdfCase> cases = rough_cases();
  for (const BsdfCase& c : delta_cases()) cases.push_back(c);
  return cases;
}

const MeasuredReflectance& measured_paint() {
  static const MeasuredReflectance paint = [] {
    std::vector<ReflectanceSample> samples;
    for (int i = 0; i <= 8; ++i) {
      for (int o = 0; o <= 8; ++o) {
        for (int t = 0; t <= 12; ++t) {
          const float theta_i = 0.19f * static_cast<float>(i), theta_o = 0.19f * static_cast<float>(o), turn = static_cast<float>(t) / 12;
          const float gloss = std::exp(-20 * ((theta_i - theta_o) * (theta_i - theta_o) + 4 * (1 - turn) * (1 - turn)));
          samples.push_back({theta_i, theta_o, kPi * turn, Color(0.05f, 0.1f, 0.2f) + 0.3f * gloss});
        }
      }
    }
    return MeasuredReflectance(samples);
  }();
  return paint;
}

Vec3 direction_at(float cos_theta, float phi) {
  const float sin_theta = std::sqrt(1 - cos_theta * cos_theta);
  return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta};
}

std::vector<Vec3> outgoing_directions() {
  return {Vec3(0, 0, 1),          direction_at(0.7f, 0.5f), direction_at(0.3f, 2),
          direction_at(0.04f, 4), direction_at(-0.6f, 1),   direction_at(-0.2f, 5)};
}

}  // namespace sightline::test
