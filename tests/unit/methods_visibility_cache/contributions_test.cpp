// Vector contributions against their scalar definitions.
#include "methods/visibility_cache/contributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "base/math/vec3_batch.h"
#include "base/sample/warp.h"
#include "support/every_target.h"

namespace sightline {
namespace {

using test::on_every_target;

class Random {
 public:
  float unit() { return uniform_(engine_); }
  Vec3 point() { return {2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1}; }
  Vec3 direction() { return sample_uniform_sphere({unit(), unit()}); }
  Color color() { return {unit(), unit(), unit()}; }

 private:
  std::mt19937 engine_{5};
  std::uniform_real_distribution<float> uniform_{0, 1};
};

// A model of each shape that vectors know, and one that they do not.
std::vector<Bsdf> models(Random& random) {
  return {Bsdf(Lambert{random.color()}),
          Bsdf(CoatedDiffuse(random.color(), 1.5f, Ggx())),
          Bsdf(CoatedDiffuse(random.color(), 1.7f, Ggx(0.3f, 0.3f))),
          Bsdf(CoatedDiffuse(random.color(), 1.3f, Ggx(0.05f, 0.6f))),
          Bsdf(Conductor({0.2f, 0.9f, 1.4f}, {3.9f, 2.4f, 1.6f}, random.color(), Ggx(0.4f, 0.15f))),
          Bsdf(Conductor({0.2f, 0.9f, 1.4f}, {3.9f, 2.4f, 1.6f}, random.color(), Ggx())),
          Bsdf(MetallicRoughness(random.color(), 0.3f, 0.5f)),
          Bsdf(MetallicRoughness(random.color(), 1, 0.7f)),
          Bsdf(MetallicRoughness(random.color(), 0, 0)),
          Bsdf(Phong(0.5f * random.color(), 0.4f * random.color(), 8))};
}

EyeSample random_eye(Random& random, const Bsdf& bsdf, bool from_behind = false) {
  EyeSample eye;
  eye.position = random.point();
  eye.geometric_normal = random.direction();
  eye.frame = frame_from_normal(glm::normalize(eye.geometric_normal + 0.3f * random.direction()));
  eye.wo = random.direction();
  if (glm::dot(eye.wo, eye.geometric_normal) < 0) eye.wo = -eye.wo;
  if (from_behind) eye.frame = frame_from_normal(-eye.frame.normal);
  eye.bsdf = bsdf;
  eye.bsdf.prepare(eye.frame.to_local(eye.wo));
  eye.weight = random.color();
  return eye;
}
EyeSample random_eye(Random& random) { return random_eye(random, Bsdf(Lambert{random.color()})); }

LightSampleBatch random_samples(Random& random, std::size_t count) {
  LightSampleBatch lights;
  lights.resize(count + kLanes);
  for (std::size_t i = 0; i < count; ++i) {
    LightSample s;
    s.wi = random.direction();
    s.radiance = i % 5 == 0 ? Color(0) : random.color();
    s.pdf = i % 7 == 0 ? 0.f : 0.1f + random.unit();
    lights.set(i, {&s, 1});
  }
  return lights;
}

// A narrow lobe multiplies the rounding of its half vector.
float tolerance(const Bsdf& bsdf) { return bsdf.lambert() ? 1e-5f : 1e-4f; }

// Each lane that the scalar code finds non-zero, and no other, is there with its value.
template <class Scalar>
void expect_same(const Contributions& found, std::uint32_t eye, std::size_t first_light, std::size_t count, float relative, Scalar scalar) {
  std::size_t at = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Color expected = scalar(k);
    const bool listed = at < found.size && found.light[at] == first_light + k;
    // Where rounding decides the sign of a cosine, either may drop the lane.
    if (max_component(expected) < 1e-6f && !listed) continue;
    ASSERT_TRUE(listed) << k << ": " << expected.x;
    EXPECT_EQ(found.eye[at], eye);
    EXPECT_NEAR(found.color.x[at], expected.x, 1e-5f + relative * expected.x) << k;
    EXPECT_NEAR(found.color.y[at], expected.y, 1e-5f + relative * expected.y) << k;
    EXPECT_NEAR(found.color.z[at], expected.z, 1e-5f + relative * expected.z) << k;
    ++at;
  }
  EXPECT_EQ(at, found.size);
}

TEST(Contributions, VectorsOfLightSamplesMatchTheScalarDefinition) {
  on_every_target([] {
    Random random;
    std::size_t model = 0;
    for (const Bsdf& bsdf : models(random)) {
      SCOPED_TRACE(model++);
      for (const SampleWeights& weights : {SampleWeights{}, SampleWeights{0.25f, 0, 0}, SampleWeights{0.25f, 4, 2}}) {
        for (const std::size_t count : {1u, 15u, 16u, 17u, 64u, 100u}) {
          const LightSampleBatch lights = random_samples(random, count + 3);
          const EyeSample eye = random_eye(random, bsdf, count % 2 == 0);
          Contributions found;
          found.resize(count);
          add_samples(eye, 9, lights, 3, count, 40, weights, found);
          expect_same(found, 9, 40, count, tolerance(bsdf),
                      [&](std::size_t k) { return sample_contribution(eye, lights, 3 + k, weights); });
        }
      }
    }
  });
}

TEST(Contributions, SmallLobesAreWeightedAgainstTheEnvironmentsSamples) {
  // The balance heuristic: shares of both techniques for one direction add up to one sample of their mixture.
  Random random;
  const LightSampleBatch lights = random_samples(random, 64);
  const EyeSample eye = random_eye(random);
  const SampleWeights weights{1 / 6.f, 6, 2};
  for (std::size_t k = 0; k < 64; ++k) {
    const Color value = sample_contribution(eye, lights, k, weights);
    if (!(max_component(value) > 0)) continue;
    const Vec3 wi(lights.wi.x[k], lights.wi.y[k], lights.wi.z[k]);
    const BsdfEval eval = eye.bsdf.evaluate(eye.frame.to_local(eye.wo), eye.frame.to_local(wi));
    const Color integrand = eye.weight * eval.f_cos * Color(lights.radiance.x[k], lights.radiance.y[k], lights.radiance.z[k]);
    EXPECT_NEAR(value.x, integrand.x / (6 * lights.pdf[k] + 2 * eval.pdf), 1e-6f + 1e-5f * value.x);
  }
}

VirtualPointLights random_virtual_lights(Random& random, std::size_t count, float most) {
  VirtualPointLights lights;
  lights.size = count;
  for (Vec3Batch* batch : {&lights.position, &lights.normal, &lights.flux, &lights.radiosity}) batch->resize(count);
  lights.error.resize(padded(count)), lights.cell_area.resize(padded(count)), lights.lambert.resize(padded(count));
  lights.wi.resize(count), lights.frame.resize(count), lights.bsdf.resize(count), lights.lobes.resize(count);
  lights.max_geometry_term = most;
  const auto put = [](Vec3Batch& batch, std::size_t i, const Vec3& v) { batch.x[i] = v.x, batch.y[i] = v.y, batch.z[i] = v.z; };
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 normal = random.direction();
    const Color flux = random.color(), reflectance = random.color();
    put(lights.position, i, random.point()), put(lights.normal, i, normal), put(lights.flux, i, flux);
    put(lights.radiosity, i, flux * reflectance * kInvPi);
    lights.lambert[i] = i % 4 != 0;
    lights.wi[i] = glm::normalize(normal + 0.7f * random.direction());
    lights.frame[i] = frame_from_normal(normal);
    lights.bsdf[i] = lights.lambert[i] ? Bsdf(Lambert{reflectance})
                     : i % 8           ? Bsdf(CoatedDiffuse(reflectance, 1.5f, Ggx(0.2f, 0.4f)))
                                       : Bsdf(Phong(0.5f * reflectance, 0.4f * reflectance, 8));
    // Every other one was bent, so that some directions see another frame.
    if (i % 2 == 0) lights.frame[i] = frame_from_normal(glm::normalize(normal + 0.4f * random.direction()));
    lights.lobes[i] = lights.bsdf[i].lobes(lights.frame[i].to_local(lights.wi[i]));
  }
  return lights;
}

TEST(Contributions, VectorsOfVirtualLightsMatchTheScalarDefinition) {
  on_every_target([] {
    Random random;
    std::size_t model = 0;
    for (const Bsdf& bsdf : models(random)) {
      SCOPED_TRACE(model++);
      for (const float most : {0.5f, std::numeric_limits<float>::infinity()}) {
        // 13 of 50 are no Lamberts, 17 of 66: less and more than a vector of them.
        for (const std::size_t count : {50u, 66u}) {
          const VirtualPointLights lights = random_virtual_lights(random, count, most);
          const EyeSample eye = random_eye(random, bsdf, count == 66);
          std::vector<std::uint32_t> general;
          for (std::uint32_t j = 0; j < lights.size; ++j) {
            if (!lights.lambert[j]) general.push_back(j);
          }
          Contributions found;
          found.resize(lights.size);
          Vec3Batch points;
          points.resize(3);
          store(points, 2, eye.position);
          SentRadiance sent;
          send_radiance(lights, general, points, 3, sent);
          add_virtual_lights(eye, 2, lights, general, sent, found);
          std::vector<Color> by_light(lights.size, Color(0));
          for (std::size_t k = 0; k < found.size; ++k) by_light[found.light[k]] = {found.color.x[k], found.color.y[k], found.color.z[k]};
          for (std::uint32_t j = 0; j < lights.size; ++j) {
            const Color expected = virtual_light_contribution(eye, lights, j);
            // Lights that are no Lamberts have a narrow lobe of their own.
            const float relative = lights.lambert[j] ? tolerance(bsdf) : 1e-4f;
            EXPECT_NEAR(by_light[j].x, expected.x, 2e-6f + relative * expected.x) << j;
            EXPECT_NEAR(by_light[j].z, expected.z, 2e-6f + relative * expected.z) << j;
          }
        }
      }
    }
  });
}

TEST(Contributions, ALambertLightIsTheSameByItsRadiosityAndByItsBsdf) {
  Random random;
  VirtualPointLights lights = random_virtual_lights(random, 40, 2);
  const EyeSample eye = random_eye(random);
  for (std::uint32_t j = 0; j < lights.size; ++j) {
    if (!lights.lambert[j]) continue;
    const Color by_radiosity = virtual_light_contribution(eye, lights, j);
    lights.lambert[j] = 0;
    const Color by_bsdf = virtual_light_contribution(eye, lights, j);
    // The BSDF also asks for the side that the light arrived from, where both agree by construction.
    EXPECT_NEAR(by_radiosity.y, by_bsdf.y, 1e-6f + 1e-4f * by_bsdf.y) << j;
  }
}

TEST(Contributions, WeightedSumsStopAtTheirEnds) {
  Random random;
  Contributions c;
  c.resize(70);
  std::vector<float> weights(96, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < 70; ++i) c.color.x[i] = static_cast<float>(i), c.color.y[i] = 1, c.color.z[i] = 2;
  for (std::size_t i = 3; i < 40; ++i) weights[i] = i % 2 ? 1.f : 0.f;
  const Color sum = weighted_sum(c, weights.data(), 3, 40);
  EXPECT_EQ(sum.y, 19);
  EXPECT_EQ(sum.z, 38);
  EXPECT_EQ(sum.x, 399);  // 3 + 5 + … + 39
}

}  // namespace
}  // namespace sightline
