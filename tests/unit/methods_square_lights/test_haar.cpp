#include "methods/square_lights/haar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace sightline::square_lights {
namespace {

std::vector<float> random_values(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<float> values(count);
  for (float& v : values) v = unit(random);
  return values;
}

double dot(const std::vector<float>& a, const std::vector<float>& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); }

TEST(Haar, BasisIsOrthonormal) {
  constexpr int kSize = 8;
  std::vector<std::vector<float>> images;
  for (std::size_t i = 0; i < kSize * kSize; ++i) {
    std::vector<float> unit(kSize * kSize, 0.f);
    unit[i] = 1;
    haar_transform(unit, kSize);
    images.push_back(unit);
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) EXPECT_NEAR(dot(images[i], images[j]), i == j ? 1 : 0, 1e-6);
  }
}

TEST(Haar, InverseRestoresAndScalingComesFirst) {
  const std::vector<float> values = random_values(32 * 32, 1);
  std::vector<float> face = values;
  haar_transform(face, 32);
  EXPECT_NEAR(face[0], std::accumulate(values.begin(), values.end(), 0.0) / 32, 1e-4);
  haar_inverse(face, 32);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(face[i], values[i], 1e-5f);
}

TEST(Haar, SupportsCountTheTexelsThatACoefficientTouches) {
  constexpr int kSize = 16;
  const std::vector<float> support = haar_support(kSize);
  for (std::size_t i = 0; i < kSize * kSize; ++i) {
    std::vector<float> face(kSize * kSize, 0.f);
    face[i] = 1;
    haar_inverse(face, kSize);
    EXPECT_EQ(support[i], static_cast<float>(std::count_if(face.begin(), face.end(), [](float v) { return v != 0; })))
        << "coefficient " << i;
  }
}

LightCube cube_of(int size) {
  LightCube cube;
  cube.size = size;
  const auto count = static_cast<std::size_t>(6 * size * size);
  const std::vector<float> r = random_values(count, 2), g = random_values(count, 3), b = random_values(count, 4);
  for (std::size_t i = 0; i < count; ++i) cube.texels.push_back({r[i], g[i], b[i] < 0.02f ? 40 * b[i] : 0.1f});
  return cube;
}

TEST(WaveletLight, DotProductOfAllTermsIsTheIntegral) {
  const LightCube cube = cube_of(16);
  const std::vector<float> values = random_values(cube.count(), 7);
  std::vector<float> transport = values;
  wavelet_transport(transport, 16);
  const WaveletLight light = wavelet_light(cube, 0, true);
  for (int c = 0; c < 3; ++c) {
    ASSERT_EQ(light.channel[c].size(), cube.count());
    double expected = 0, sum = 0;
    for (std::size_t i = 0; i < cube.count(); ++i) expected += static_cast<double>(cube.solid_angle(i)) * values[i] * cube.texels[i][c];
    for (const WaveletLight::Term& term : light.channel[c]) sum += static_cast<double>(term.value) * transport[term.index];
    EXPECT_NEAR(sum / expected, 1, 1e-5);
  }
}

TEST(WaveletLight, KeepsTheLargestTerms) {
  const LightCube cube = cube_of(16);
  const std::vector<float> support = haar_support(16);
  const WaveletLight all = wavelet_light(cube, 0, false);
  for (const bool weighted : {false, true}) {
    const WaveletLight light = wavelet_light(cube, 20, weighted);
    for (int c = 0; c < 3; ++c) {
      ASSERT_EQ(light.channel[c].size(), 20u);
      const auto rank = [&](const WaveletLight::Term& t) { return std::fabs(t.value) * (weighted ? support[t.index % 256] : 1.f); };
      float least = 1e30f;
      for (const auto& term : light.channel[c]) least = std::min(least, rank(term));
      const auto greater = std::count_if(all.channel[c].begin(), all.channel[c].end(), [&](const auto& t) { return rank(t) > least; });
      EXPECT_LE(greater, 19);
    }
  }
  // By area the six scalings always belong to them; the values themselves prefer the bright specks of blue.
  const WaveletLight weighted = wavelet_light(cube, 20, true), plain = wavelet_light(cube, 20, false);
  const auto scalings = [](const WaveletLight& light) {
    return std::count_if(light.channel[2].begin(), light.channel[2].end(), [](const auto& t) { return t.index % 256 == 0; });
  };
  EXPECT_EQ(scalings(weighted), 6);
  EXPECT_NE(plain.channel[2][5].index, weighted.channel[2][5].index);
}

}  // namespace
}  // namespace sightline::square_lights
