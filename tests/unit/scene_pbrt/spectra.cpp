#include "scene/load/pbrt/spectrum.h"

#include <cmath>
#include <complex>

#include "scene/load/pbrt/environment.h"
#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline::pbrt {
namespace {

TEST(PbrtSpectra, AConstantIsItsOwnColor) {
  expect_near(reflectance_color(Spectrum{{{500.f, 0.25f}}}), {0.25f, 0.25f, 0.25f});
  EXPECT_NEAR(mean_value(Spectrum{{{500.f, 1.5f}}}), 1.5f, 1e-6f);
}

TEST(PbrtSpectra, InterpolatesLinearlyAndHoldsItsEnds) {
  const Spectrum s{{{400.f, 1.f}, {500.f, 3.f}}};
  EXPECT_FLOAT_EQ(s.at(450), 2);
  EXPECT_FLOAT_EQ(s.at(100), 1);
  EXPECT_FLOAT_EQ(s.at(900), 3);
}

TEST(PbrtSpectra, DaylightIsWhite) { expect_near(emission_color(Spectrum{daylight_d65_samples()}), {1, 1, 1}, 5e-3f); }

TEST(PbrtSpectra, EqualEnergyIsReddishAgainstDaylight) {
  // CIE E in linear Rec.709: (1.2048, 0.9483, 0.9088).
  expect_near(emission_color(Spectrum{{{500.f, 7.f}}}), {1.2048f, 0.9483f, 0.9088f}, 6e-3f);
}

TEST(PbrtSpectra, BlackbodiesFollowPlanck) {
  const Spectrum s = blackbody_spectrum(5000);
  const auto planck = [](double nm) { return std::pow(nm, -5) / std::expm1(1.438776877e7 / (nm * 5000)); };
  EXPECT_NEAR(s.at(450) / s.at(650), planck(450) / planck(650), 1e-4);
  // CIE illuminant A is a black body of 2856 K: chromaticity (0.4476, 0.4074).
  const Color a = emission_color(blackbody_spectrum(2856));
  const double x = 0.4124 * a.x + 0.3576 * a.y + 0.1805 * a.z, y = 0.2126 * a.x + 0.7152 * a.y + 0.0722 * a.z,
               z = 0.0193 * a.x + 0.1192 * a.y + 0.9505 * a.z;
  EXPECT_NEAR(x / (x + y + z), 0.4476, 3e-3);
  EXPECT_NEAR(y / (x + y + z), 0.4074, 3e-3);
  for (const float t : {1.f, 100.f, 1e6f, 1e20f}) {
    const Color c = emission_color(blackbody_spectrum(t));
    EXPECT_TRUE(is_finite(c)) << t;
  }
}

TEST(PbrtSpectra, NamedMetalsHaveTheReflectanceOfTheirSpectra) {
  for (const char* name : {"metal-Ag", "metal-Al", "metal-Au", "metal-Cu", "metal-CuZn", "metal-TiO2", "metal-MgO"}) {
    const auto eta = named_spectrum(std::string(name) + "-eta"), k = named_spectrum(std::string(name) + "-k");
    ASSERT_TRUE(eta && k) << name;
    const ConductorColors colors = conductor_colors(*eta, *k);
    Spectrum reflectance;
    for (int nm = 380; nm <= 780; nm += 10) {
      const std::complex<double> n(static_cast<double>(eta->at(static_cast<float>(nm))),
                                   static_cast<double>(k->at(static_cast<float>(nm))));
      reflectance.samples.emplace_back(static_cast<float>(nm), static_cast<float>(std::norm((n - 1.0) / (n + 1.0))));
    }
    const Color expected = glm::clamp(reflectance_color(reflectance), Color(0), Color(0.9999f));
    for (int c = 0; c < 3; ++c) {
      const std::complex<double> n(static_cast<double>(colors.eta[c]), static_cast<double>(colors.k[c]));
      EXPECT_NEAR(std::norm((n - 1.0) / (n + 1.0)), static_cast<double>(expected[c]), 2e-3) << name << c;
    }
  }
}

TEST(PbrtSpectra, SilverIsBrightAndGoldIsYellow) {
  const auto f0 = [](const std::string& name) {
    const ConductorColors c = conductor_colors(*named_spectrum(name + "-eta"), *named_spectrum(name + "-k"));
    const Color below = c.eta - Color(1), above = c.eta + Color(1);
    return (below * below + c.k * c.k) / (above * above + c.k * c.k);
  };
  EXPECT_GT(f0("metal-Ag").z, 0.9f);
  const Color gold = f0("metal-Au");
  EXPECT_GT(gold.x, 0.9f);
  EXPECT_NEAR(gold.y, 0.75f, 0.06f);
  EXPECT_LT(gold.z, 0.5f);
  const Color copper = f0("metal-Cu");
  EXPECT_GT(copper.x, copper.y + 0.2f);
}

TEST(PbrtSpectra, GlassesHaveTheirIndexAtTheSodiumLine) {
  EXPECT_NEAR(named_spectrum("glass-BK7")->at(587.6f), 1.5168f, 1e-3f);
  EXPECT_NEAR(named_spectrum("glass-SF10")->at(587.6f), 1.7283f, 1e-3f);
  EXPECT_NEAR(named_spectrum("glass-LASF9")->at(587.6f), 1.8503f, 1e-3f);
  EXPECT_FALSE(named_spectrum("glass-ABC"));
}

TEST(PbrtSpectra, ListsMustIncrease) {
  EXPECT_TRUE(spectrum_from_text("# nm value\n400 1\n500, 2\n"));
  for (const char* text : {"", "400", "400 1 400 2", "500 1 400 2", "400 x", "400 nan"}) EXPECT_FALSE(spectrum_from_text(text)) << text;
}

TEST(PbrtSpectra, WhiteStaysWhiteInEveryColorSpace) {
  for (const ColorSpace space : {ColorSpace::srgb, ColorSpace::dci_p3, ColorSpace::rec2020, ColorSpace::aces2065_1}) {
    expect_near(to_working_space(space, Color(0.5f)), Color(0.5f), 2e-4f);
  }
  // Published: Rec.2020 red in linear Rec.709.
  expect_near(to_working_space(ColorSpace::rec2020, {1, 0, 0}), {1.6605f, -0.1246f, -0.0182f}, 2e-3f);
}

TEST(PbrtSpectra, ColorSpaceDirectivesConvert) {
  const Scene scene = parse_world("ColorSpace \"rec2020\" Material \"diffuse\" \"rgb reflectance\" [0 .5 0]\n" + std::string(kTriangle));
  const Color color = std::get<DiffuseMaterial>(scene.materials[0].model).reflectance.value;
  EXPECT_GT(color.y, 0.5f);
  EXPECT_EQ(color.x, 0);  // out of gamut, cut
  EXPECT_TRUE(warns_of(parse_world("ColorSpace \"cmyk\"\n"), "test.pbrt:2:1: colour space 'cmyk' is unknown"));
}

TEST(PbrtSpectra, MaterialsTakeNamedAndInlineSpectra) {
  const Scene scene = parse_world("Material \"conductor\" \"spectrum eta\" \"metal-Ag-eta\" \"spectrum k\" \"metal-Ag-k\"\n" +
                                  std::string(kTriangle) + "Material \"diffuse\" \"spectrum reflectance\" [400 .3 700 .3]\n" + kTriangle +
                                  "Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"\n" + kTriangle);
  EXPECT_LT(std::get<ConductorMaterial>(scene.materials[0].model).eta.value.y, 0.2f);
  expect_near(std::get<DiffuseMaterial>(scene.materials[1].model).reflectance.value, Color(0.3f));
  EXPECT_NEAR(std::get<DielectricMaterial>(scene.materials[2].model).eta, 1.5185f, 2e-3f);
  EXPECT_TRUE(warns_of(parse_world("Material \"conductor\" \"spectrum eta\" \"metal-Agg-eta\"\n"), "(did you mean 'metal-Ag-eta'?)"));
  EXPECT_NE(error_of("WorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" [700 1 400 1]").find("test.pbrt:2:20"), std::string::npos);
}

TEST(PbrtSpectra, TheEqualAreaMapCoversTheSphereEvenly) {
  // Means over the square are means over the sphere: of z² and x² one third, of z zero; the map's known points lie where they must.
  double z = 0, zz = 0, xx = 0;
  constexpr int kSide = 128;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Vec3 w = equal_area_direction({(static_cast<float>(x) + 0.5f) / kSide, (static_cast<float>(y) + 0.5f) / kSide});
      ASSERT_NEAR(glm::length(w), 1, 1e-5f);
      z += static_cast<double>(w.z), zz += static_cast<double>(w.z * w.z), xx += static_cast<double>(w.x * w.x);
    }
  }
  const double count = kSide * kSide;
  EXPECT_NEAR(z / count, 0, 1e-4);
  EXPECT_NEAR(zz / count, 1.0 / 3, 1e-3);
  EXPECT_NEAR(xx / count, 1.0 / 3, 1e-3);
  expect_near(equal_area_direction({0.5f, 0.5f}), {0, 0, 1});
  expect_near(equal_area_direction({1, 0.5f}), {1, 0, 0});
  expect_near(equal_area_direction({0.5f, 1}), {0, 1, 0});
  expect_near(equal_area_direction({0, 0}), {0, 0, -1}, 1e-3f);
}

TEST(PbrtSpectra, AnEvenSkyHasIlluminancePi) {
  Image image{64, 64, 3, Image::Floats(std::size_t{64} * 64 * 3, 1.f)};
  EXPECT_NEAR(upper_illuminance(image), 3.14159265, 0.01);
}

}  // namespace
}  // namespace sightline::pbrt
