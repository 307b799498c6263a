// The vector path of Lambert surfaces against the scalar classes it stands for, on every instruction set of this machine.
#include "methods/lambert_lanes.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <limits>

#include "base/sample/sobol.h"
#include "shade/lambert.h"
#include "support/chi_square.h"
#include "support/every_target.h"

namespace sightline::test {
namespace {

constexpr std::size_t kCount = 1000;

void put(Vec3Batch& batch, std::size_t i, const Vec3& v) { batch.x[i] = v.x, batch.y[i] = v.y, batch.z[i] = v.z; }
Vec3 at(const Vec3Batch& batch, std::size_t i) { return {batch.x[i], batch.y[i], batch.z[i]}; }

struct Random : Uniform {
  using Uniform::Uniform;
  Vec3 vector() {
    const Vec2 a = next2();
    return {a.x, a.y, next()};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 v = 2.f * vector() - 1.f;
      if (glm::dot(v, v) < 1 && glm::dot(v, v) > 0.01f) return glm::normalize(v);
    }
  }
};

/// Surfaces whose shading normals lean up to far away from the geometric ones, seen from both sides, with light samples of every kind.
struct Setting {
  RayBatch rays;
  SurfaceBatch surfaces;
  Vec3Batch throughput;
  LightSampleBatch lights;

  explicit Setting(std::uint32_t seed) {
    Random random(seed);
    rays.resize(kCount), surfaces.resize(kCount), throughput.resize(kCount), lights.resize(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      rays.set(i, {10.f * random.vector(), 0, random.direction()});
      const Vec3 normal = random.direction();
      Vec3 shading = glm::normalize(normal + 0.9f * random.next() * random.direction());
      if (glm::dot(shading, normal) < 0) shading = -shading;
      put(surfaces.geometric_normal, i, normal);
      put(surfaces.shading_normal, i, shading);
      put(surfaces.position, i, 10.f * random.vector());
      put(surfaces.albedo, i, random.vector());
      surfaces.error[i] = 1e-4f * random.next();
      put(throughput, i, i % 17 == 0 ? Vec3(0) : random.vector());
      LightSample light;
      light.wi = random.direction();
      light.distance = 1 + 5 * random.next();
      light.normal = random.direction();
      light.point = at(surfaces.position, i) + light.distance * light.wi;
      light.point_error = 1e-4f * random.next();
      light.radiance = i % 13 == 0 ? Vec3(0) : 3.f * random.vector();
      light.pdf = i % 11 == 0 ? 0.f : 0.05f + random.next();
      if (i % 5 == 1) light.is_delta = true, light.normal = Vec3(0), light.point_error = 0;
      if (i % 5 == 2) light.is_mesh = true;
      if (i % 5 == 3) light.distance = std::numeric_limits<float>::infinity();
      if (i % 5 == 4) light.distance = std::numeric_limits<float>::infinity(), light.is_delta = true;
      lights.set(i, std::span(&light, 1));
    }
  }
};

struct Expected {
  std::uint32_t point;
  Vec3 origin, direction, contribution;
  float t_far, cosine;
};

Vec3 usable_normal(const Vec3& wo, const Vec3& shading, const Vec3& geometric) {
  return glm::dot(wo, shading) * glm::dot(wo, geometric) > 0 ? shading : geometric;
}

/// One light sample as kernel.cpp's scalar path treats it; nothing where it carries no light.
std::optional<Expected> scalar(const Setting& s, std::size_t point, std::size_t lane, const DirectLightOptions& options) {
  const Vec3 wo = -at(s.rays.direction, point), geometric = at(s.surfaces.geometric_normal, point), wi = at(s.lights.wi, lane);
  if (!(s.lights.pdf[lane] > 0)) return std::nullopt;
  const Frame3 frame = frame_from_normal(usable_normal(wo, at(s.surfaces.shading_normal, point), geometric));
  if (!(glm::dot(wo, geometric) * glm::dot(wi, geometric) > 0)) return std::nullopt;
  const BsdfEval eval = Lambert{at(s.surfaces.albedo, point)}.evaluate(frame.to_local(wo), frame.to_local(wi));
  Color value = eval.f_cos * at(s.lights.radiance, lane) * at(s.throughput, point) / (s.lights.pdf[lane] * options.samples);
  if (is_black(value)) return std::nullopt;
  const bool infinite = std::isinf(s.lights.distance[lane]);
  if (options.mis && !s.lights.is_delta[lane] && (s.lights.is_mesh[lane] || infinite)) {
    const double a = static_cast<double>(options.samples) * s.lights.pdf[lane], b = eval.pdf;
    value *= static_cast<float>(a * a / (a * a + b * b));
  }
  const Vec3 origin = offset_origin(at(s.surfaces.position, point), geometric, s.surfaces.error[point], wi);
  const Vec3 target = offset_origin(at(s.lights.point, lane), at(s.lights.normal, lane), s.lights.point_error[lane], -wi);
  return Expected{static_cast<std::uint32_t>(point),
                  origin,
                  infinite ? wi : target - origin,
                  value,
                  infinite ? std::numeric_limits<float>::infinity() : 1.f,
                  std::fabs(glm::dot(wi, frame.normal))};
}

void expect_equal(const std::vector<Expected>& expected, const ShadowLanes& out) {
  ASSERT_EQ(out.count, expected.size());
  for (std::size_t i = 0; i < out.count; ++i) {
    const Expected& e = expected[i];
    ASSERT_EQ(out.point[i], e.point);
    // Positions are about 10, so their spacing is 1e-6; contributions are products of a dozen rounded factors, one of them a cosine that is
    // exact to 1e-7 or so.
    EXPECT_LE(glm::distance(at(out.rays.origin, i), e.origin), 4e-6f);
    EXPECT_LE(glm::distance(at(out.rays.direction, i), e.direction), 8e-6f);
    EXPECT_LE(glm::distance(at(out.contribution, i), e.contribution), (4e-6f + 2e-7f / e.cosine) * glm::length(e.contribution));
    EXPECT_EQ(out.rays.t_near[i], 0);
    EXPECT_EQ(out.rays.t_far[i], e.t_far);
  }
}

constexpr DirectLightOptions kOptions[] = {{1, true}, {1, false}, {7, true}};

TEST(LambertLanes, OneSampleAPointEqualsTheScalarPath) {
  const Setting s(1);
  AlignedVector<std::uint8_t> active(padded(kCount), 1);
  for (std::size_t i = 0; i < kCount; i += 3) active[i] = 0;
  for (const std::int64_t target : simd_targets()) {
    const PinnedTarget pinned(target);
    for (const DirectLightOptions& options : kOptions) {
      ShadowLanes out;
      out.resize(kCount);
      append_direct_light_each({&s.rays, &s.surfaces, &s.throughput}, 0, s.lights, kCount, active.data(), options, out);
      std::vector<Expected> expected;
      for (std::size_t i = 0; i < kCount; ++i) {
        if (!active[i]) continue;
        if (const auto e = scalar(s, i, i, options)) expected.push_back(*e);
      }
      EXPECT_GT(expected.size(), kCount / 10);
      expect_equal(expected, out);
    }
  }
}

TEST(LambertLanes, ManySamplesOfAPointEqualTheScalarPath) {
  const Setting s(2);
  for (const std::int64_t target : simd_targets()) {
    const PinnedTarget pinned(target);
    for (const DirectLightOptions& options : kOptions) {
      ShadowLanes out;
      out.resize(kCount);
      std::vector<Expected> expected;
      // Runs of every length, beginning anywhere.
      std::size_t first = 0;
      for (std::uint32_t point = 0; first < kCount - 40; ++point) {
        const std::size_t count = point % 37;
        append_direct_light({&s.rays, &s.surfaces, &s.throughput}, point, s.lights, first, count, options, out);
        for (std::size_t k = first; k < first + count; ++k) {
          if (const auto e = scalar(s, point, k, options)) expected.push_back(*e);
        }
        first += count;
      }
      EXPECT_GT(expected.size(), kCount / 10);
      expect_equal(expected, out);
    }
  }
}

TEST(LambertLanes, DirectionsAreTheScalarOnesInTheFrameOfTheNormal) {
  const Setting s(3);
  Random random(4);
  AlignedVector<float> u(padded(kCount)), v(padded(kCount)), pdf(padded(kCount));
  for (std::size_t i = 0; i < kCount; ++i) u[i] = random.next(), v[i] = random.next();
  // The corners and the centre of the square, where the map from square to disk has its seams.
  const float special[] = {0, 0.5f, 0x1.fffffep-1f};
  for (std::size_t i = 0; i < 9; ++i) u[i] = special[i % 3], v[i] = special[i / 3];
  for (const std::int64_t target : simd_targets()) {
    const PinnedTarget pinned(target);
    Vec3Batch wi;
    wi.resize(kCount);
    sample_lambert({&s.rays, &s.surfaces, &s.throughput}, u.data(), v.data(), kCount, wi, pdf.data());
    std::size_t blocked = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vec3 wo = -at(s.rays.direction, i), geometric = at(s.surfaces.geometric_normal, i);
      Vec3 normal = usable_normal(wo, at(s.surfaces.shading_normal, i), geometric);
      if (glm::dot(wo, normal) < 0) normal = -normal;
      const Frame3 frame = frame_from_normal(normal);
      const auto expected = Lambert{}.sample(frame.to_local(wo), 0, {u[i], v[i]});
      const Vec3 direction = at(wi, i);
      EXPECT_NEAR(glm::length(direction), 1, 1e-6f);
      if (!expected) {
        EXPECT_LE(pdf[i], 1e-3f);
        continue;
      }
      // Near the horizon the height is the root of a small difference.
      const float height_error = 3e-7f / std::fmax(5e-4f, expected->wi.z);
      EXPECT_LE(glm::distance(direction, frame.to_world(expected->wi)), 3e-6f + height_error);
      const float sides = glm::dot(direction, geometric) * glm::dot(wo, geometric);
      if (std::fabs(sides) < 1e-6f) continue;
      blocked += sides < 0;
      EXPECT_NEAR(pdf[i], sides > 0 ? expected->pdf : 0.f, 3e-6f + height_error) << target << " lane " << i;
    }
    EXPECT_GT(blocked, 10u);
    EXPECT_LT(blocked, kCount / 3);
  }
}

TEST(LambertLanes, DirectionsFollowTheirDensity) {
  constexpr std::size_t kSamples = 200000;
  const std::vector<std::int64_t> all = simd_targets();
  const Vec3 normals[] = {{0, 0, 1}, {0, 0, -1}, glm::normalize(Vec3(1, 2, -0.5f))};
  for (const std::int64_t target : all) {
    const PinnedTarget pinned(target);
    for (const Vec3& normal : normals) {
      const Vec3 wo = glm::normalize(normal + Vec3(0.3f, 0.1f, 0.2f));
      RayBatch rays;
      SurfaceBatch surfaces;
      Vec3Batch throughput, wi;
      rays.resize(kCount), surfaces.resize(kCount), throughput.resize(kCount), wi.resize(kCount);
      for (std::size_t i = 0; i < kCount; ++i) {
        rays.set(i, {Vec3(0), 0, -wo});
        put(surfaces.geometric_normal, i, normal);
        put(surfaces.shading_normal, i, normal);
      }
      Random random(5);
      AlignedVector<float> u(padded(kCount)), v(padded(kCount)), pdf(padded(kCount));
      std::size_t next = kCount;
      const auto sample = [&]() -> std::optional<Vec3> {
        if (next == kCount) {
          for (std::size_t i = 0; i < kCount; ++i) u[i] = random.next(), v[i] = random.next();
          sample_lambert({&rays, &surfaces, &throughput}, u.data(), v.data(), kCount, wi, pdf.data());
          next = 0;
        }
        const std::size_t i = next++;
        if (!(pdf[i] > 0)) return std::nullopt;
        return at(wi, i);
      };
      const auto density = [&](const Vec3& direction) { return std::fmax(0.f, glm::dot(direction, normal)) * kInvPi; };
      const ChiSquareResult result = chi_square_directions(sample, density, {.axis = normal}, kSamples);
      EXPECT_GT(result.p_value, sidak(1e-3, static_cast<int>(3 * all.size()))) << target << "\n" << result.table;
    }
  }
}

}  // namespace
}  // namespace sightline::test
