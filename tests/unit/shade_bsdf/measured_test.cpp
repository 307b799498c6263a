// Measured reflectance: files, interpolation, tables.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/core/error.h"
#include "bsdf_cases.h"
#include "shade/bsdf_albedo.h"
#include "shade/measured_file.h"
#include "shade/measured_reflectance.h"
#include "support/chi_square.h"

namespace sightline::test {
namespace {

constexpr const char* kHeader = "# a comment\n3 # wavelengths\n450 550\n650\n";

std::vector<ReflectanceSample> parse(const std::string& text) { return parse_cornell_brdf(text, "test.brdf"); }

TEST(CornellBrdf, AnglesAndAzimuthAreTakenFromEachLine) {
  const auto samples = parse(std::string(kHeader) + "0.1 0.5 0.2 2.0 1 1 1\n0.3 0 0.4 -1.5 0 0 0 # dark\n");
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_FLOAT_EQ(samples[0].theta_i, 0.1f);
  EXPECT_FLOAT_EQ(samples[0].theta_o, 0.2f);
  EXPECT_FLOAT_EQ(samples[0].delta_phi, 1.5f);
  EXPECT_FLOAT_EQ(samples[1].delta_phi, -1.5f);
  EXPECT_EQ(samples[1].value, Color(0));
}

TEST(CornellBrdf, AFlatSpectrumIsGrey) {
  for (const std::string header : {"1\n550\n", "3\n450 550 650\n", "5\n400 475 550 625 700\n"}) {
    std::string line = "0 0 0 0";
    for (char c = '0'; c < header[0]; ++c) line += " 0.5";
    const Color value = parse(header + line)[0].value;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], 0.5f, 1e-5f) << header;
  }
}

TEST(CornellBrdf, SpectraHaveTheirColours) {
  const Color blue = parse("4\n420 460 500 700\n0 0 0 0 1 1 0 0")[0].value, red = parse("4\n400 580 640 700\n0 0 0 0 0 0 1 1")[0].value,
              green = parse("4\n480 520 560 600\n0 0 0 0 0 1 1 0")[0].value;
  EXPECT_GT(blue.z, 3 * blue.y);
  EXPECT_GT(blue.z, 3 * blue.x);
  EXPECT_GT(red.x, 3 * red.y);
  EXPECT_GT(red.x, 3 * red.z);
  EXPECT_GT(green.y, 2 * green.x);
  EXPECT_GT(green.y, 3 * green.z);
}

TEST(CornellBrdf, WhatIsWrongIsNamedWithItsLine) {
  const auto error_of = [](const std::string& text) -> std::string {
    try {
      parse(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input) << text;
      return error.what();
    }
    return "";
  };
  const std::pair<std::string, const char*> cases[] = {{"", "test.brdf:1"},
                                                       {"0", "wavelengths"},
                                                       {"-3", "wavelengths"},
                                                       {"1e9", "wavelengths"},
                                                       {"2.5\n1 2 3", "wavelengths"},
                                                       {"nan", "number"},
                                                       {"2\n500 400\n", "increase"},
                                                       {"2\n500\n", "ends where"},
                                                       {std::string(kHeader), "no measurement"},
                                                       {std::string(kHeader) + "0 0 0 0 1 1", "ends where"},
                                                       {std::string(kHeader) + "0 0 0 0 1 1 x", "test.brdf:5"},
                                                       {std::string(kHeader) + "0 0 0 0 1 1 inf", "number"},
                                                       {std::string(kHeader) + "0 0 0 0 1 1 1e9", "no reflectance"},
                                                       {std::string(kHeader) + "2 0 0 0 1 1 1", "theta_i"},
                                                       {std::string(kHeader) + "0 0 -0.1 0 1 1 1", "theta_o"}};
  for (const auto& [text, says] : cases) EXPECT_NE(error_of(text).find(says), std::string::npos) << text << ": " << error_of(text);
}

TEST(PairPoint, DirectionsAndAnglesAgreeAndMayBeSwapped) {
  Uniform random(1);
  for (int i = 0; i < 200; ++i) {
    const float theta_i = 0.05f + 1.5f * random.next(), theta_o = 0.05f + 1.5f * random.next(), turn = 2 * kPi * random.next(),
                at = 6 * random.next();
    const auto direction = [](float theta, float phi) { return direction_at(std::cos(theta), phi); };
    const Vec3 wi = direction(theta_i, at), wo = direction(theta_o, at + turn);
    const PairPoint a = pair_point(wo, wi), b = pair_point(wi, wo), c = pair_point(ReflectanceSample{theta_i, theta_o, turn, Color(0)});
    EXPECT_EQ(a, b);
    EXPECT_NEAR(glm::length(a - c), 0, 2e-3f);
  }
}

/// All samples by brute force: the definition of the interpolation without its tree.
Color brute_force(std::span<const ReflectanceSample> samples, const PairPoint& point) {
  constexpr std::size_t kNeighbours = 12;
  std::vector<std::pair<double, Color>> found;
  const double azimuth = std::clamp(static_cast<double>(point.x) / 0.1, 0.0, 1.0);
  for (const ReflectanceSample& s : samples) {
    const Vec3d d = Vec3d(pair_point(s)) - Vec3d(point);
    found.emplace_back(d.x * d.x + azimuth * azimuth * d.y * d.y + d.z * d.z, s.value);
  }
  std::partial_sort(found.begin(), found.begin() + kNeighbours, found.end(),
                    [](const auto& a, const auto& b) { return a.first < b.first; });
  Vec3d sum(0);
  double weights = 0;
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    const double weight = std::exp(-5 * found[i].first / found[kNeighbours - 1].first);
    sum += weight * Vec3d(found[i].second);
    weights += weight;
  }
  return Color(sum / weights);
}

TEST(ScatteredReflectance, TheTreeFindsTheNearestSamples) {
  Uniform random(2);
  std::vector<ReflectanceSample> samples;
  for (int i = 0; i < 500; ++i)
    samples.push_back(
        {1.57f * random.next(), 1.57f * random.next(), kPi * random.next(), Color(random.next(), random.next(), random.next())});
  const ScatteredReflectance scattered(samples);
  for (int i = 0; i < 300; ++i) {
    const Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
    const Color found = scattered.at(pair_point(wo, wi)), expected = brute_force(samples, pair_point(wo, wi));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 1e-4f);
  }
}

TEST(ScatteredReflectance, DoesNotDependOnTheAzimuthAlongTheNormal) {
  std::vector<ReflectanceSample> samples;
  Uniform random(3);
  for (int i = 0; i < 300; ++i) samples.push_back({0.5f * random.next(), 1.5f * random.next(), kPi * random.next(), Color(random.next())});
  const ScatteredReflectance scattered(samples);
  for (const float z : {1.f, 0.7f, 0.2f}) {
    const Color at_zero = scattered.at({0, 0, z}), at_half = scattered.at({0, 0.5f, z}), near = scattered.at({1e-4f, 1, z});
    EXPECT_NEAR(at_zero.x, at_half.x, 1e-5f);
    EXPECT_NEAR(at_zero.x, near.x, 1e-2f);
  }
}

TEST(ScatteredReflectance, AnyNumberOfSamplesWillDo) {
  for (const std::size_t count : {1u, 2u, 11u, 13u, 5000u}) {
    const std::vector<ReflectanceSample> same(count, {0.3f, 0.4f, 1, Color(0.25f, 0.5f, 1)});
    const Color value = ScatteredReflectance(same).at({0.5f, 0.5f, 0.5f});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], same[0].value[c], 1e-6f) << count;
  }
}

TEST(MeasuredReflectance, LambertMeasuredIsLambert) {
  std::vector<ReflectanceSample> samples;
  Uniform random(4);
  for (int i = 0; i < 200; ++i) samples.push_back({1.5f * random.next(), 1.5f * random.next(), kPi * random.next(), Color(0.6f * kInvPi)});
  const MeasuredReflectance data(samples);
  EXPECT_EQ(data.least_scale(), 1);
  const Bsdf measured((MeasuredBrdf(data))), lambert(Lambert{Color(0.6f)});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(measured.albedo()[c], 0.6f, 1e-3f);
  for (int i = 0; i < 200; ++i) {
    const Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
    const BsdfEval a = measured.evaluate(wo, wi), b = lambert.evaluate(wo, wi);
    EXPECT_NEAR(a.f_cos.x, b.f_cos.x, 1e-5f);
    EXPECT_NEAR(a.pdf, b.pdf, 1e-4f);
  }
}

TEST(MeasuredReflectance, FollowsASmoothModel) {
  // Dense measurements of a lobe are given back between them.
  const Ward ward(Color(0.2f, 0.3f, 0.1f), Color(0.2f), 0.5f, 0.5f);
  Uniform random(5);
  std::vector<ReflectanceSample> samples;
  for (int i = 0; i < 20000; ++i) {
    const float theta_i = 1.5f * random.next(), theta_o = 1.5f * random.next(), turn = kPi * random.next();
    const Vec3 wi = direction_at(std::cos(theta_i), 0), wo = direction_at(std::cos(theta_o), turn);
    samples.push_back({theta_i, theta_o, turn, ward.evaluate(wo, wi).f_cos / wi.z});
  }
  const MeasuredReflectance data(samples);
  for (int i = 0; i < 300; ++i) {
    const Vec3 wo = sample_cosine_hemisphere(random.next2()), wi = sample_cosine_hemisphere(random.next2());
    if (std::min(wo.z, wi.z) < 0.25f) continue;
    const Color expected = ward.evaluate(wo, wi).f_cos / wi.z, found = data.value(wo, wi);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 0.08f * expected[c] + 2e-3f);
  }
}

TEST(MeasuredReflectance, APeakThatWouldReturnTooMuchIsTakenBack) {
  std::vector<ReflectanceSample> samples;
  for (int i = 0; i <= 8; ++i)
    for (int o = 0; o <= 8; ++o)
      for (int t = 0; t <= 12; ++t) {
        const bool peak = i == 7 && o == 7 && t == 12;
        samples.push_back({0.19f * static_cast<float>(i), 0.19f * static_cast<float>(o), kPi * static_cast<float>(t) / 12,
                           peak ? Color(600, 500, 400) : Color(0.05f)});
      }
  const MeasuredReflectance data(samples);
  EXPECT_LT(data.least_scale(), 0.5f);
  const Bsdf measured((MeasuredBrdf(data)));
  float most = 0;
  for (const float cosine : {1.f, 0.8f, 0.5f, 0.3f, 0.24f, 0.2f, 0.1f, 0.03f}) {
    const Color albedo = integrate_directional_albedo(measured, direction_at(cosine, 1), TransportMode::radiance, 1e-4f).total();
    EXPECT_LE(max_component(albedo), 1) << cosine;
    EXPECT_NEAR(albedo.x, data.directional_albedo(cosine).x, 0.03f) << cosine;
    most = std::max(most, albedo.x);
  }
  // Far from the peak nothing changes.
  EXPECT_NEAR(data.value(direction_at(0.95f, 0), direction_at(0.9f, 1)).x, 0.05f, 1e-3f);
  EXPECT_GT(most, 0.8f);
}

TEST(MeasuredReflectance, TheHashIsOfTheMeasurements) {
  const ReflectanceSample a{.theta_i = 0.1f, .value = Color(0.1f)}, b{.theta_i = 0.2f, .value = Color(0.1f)};
  EXPECT_EQ(MeasuredReflectance(std::span(&a, 1)).content_hash(), MeasuredReflectance(std::span(&a, 1)).content_hash());
  EXPECT_NE(MeasuredReflectance(std::span(&a, 1)).content_hash(), MeasuredReflectance(std::span(&b, 1)).content_hash());
}

TEST(MeasuredFile, RealPaintsHaveTheirColoursAndKeepTheEnergy) {
  const char* data = std::getenv("SIGHTLINE_DATA");
  const std::filesystem::path folder = std::filesystem::path(data ? data : "") / "brdf";
  if (!data || !std::filesystem::is_directory(folder)) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".brdf") continue;
    const MeasuredMaterial material = load_measured_material(entry.path());
    EXPECT_EQ(material.content_hash, material.data->content_hash());
    const Color albedo = material.data->albedo();
    if (entry.path().stem() == "acryl_blue") {
      EXPECT_GT(albedo.z, 2 * std::max(albedo.x, albedo.y));
    }
    if (entry.path().stem() == "garnet_red") {
      EXPECT_GT(albedo.x, 2 * std::max(albedo.y, albedo.z));
    }
    const Bsdf bsdf((MeasuredBrdf(*material.data)));
    for (const Vec3& wo : outgoing_directions()) {
      const DirectionalAlbedo reflected = integrate_directional_albedo(bsdf, wo, TransportMode::radiance, 1e-3f);
      EXPECT_LE(max_component(reflected.total()), 1) << entry.path() << " cos " << wo.z;
      EXPECT_NEAR(reflected.density, 1, 5e-3f) << entry.path() << " cos " << wo.z;
    }
  }
}

}  // namespace
}  // namespace sightline::test
