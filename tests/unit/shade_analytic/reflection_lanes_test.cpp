// Reflection of polygons in vectors against its definition, on every instruction set.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <random>

#include "shade/analytic/reflection.h"
#include "support/every_target.h"

namespace sightline {
namespace {

struct Reflectors {
  Vec3Batch position, normal, wo;
  AnalyticLobesBatch lobes;
  std::vector<AnalyticLobes> each;
  explicit Reflectors(std::size_t n) {
    for (Vec3Batch* b : {&position, &normal, &wo}) b->resize(n);
    lobes.resize(n);
  }
  static void set(Vec3Batch& b, std::size_t i, const Vec3& v) { b.x[i] = v.x, b.y[i] = v.y, b.z[i] = v.z; }
  static Vec3 get(const Vec3Batch& b, std::size_t i) { return {b.x[i], b.y[i], b.z[i]}; }
  void add(const Vec3& p, const Vec3& n, const Vec3& w, const AnalyticBsdf& bsdf) {
    const std::size_t i = each.size();
    set(position, i, p), set(normal, i, n), set(wo, i, w);
    each.push_back(analytic_lobes(bsdf, glm::dot(n, w)));
    lobes.set(i, each.back());
  }
};

TEST(ReflectPolygonLanes, AgreeWithTheDefinition) {
  std::mt19937 engine(11);
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine); };
  const auto direction = [&] { return normalize_or(Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)), Vec3(0, 0, 1)); };
  constexpr std::size_t kCount = 301;
  for (const float roughness : {0.1f, 0.25f, 0.6f, 1.f}) {
    for (const EmitterSides sides : {EmitterSides::one, EmitterSides::two}) {
      const Vec3 corner{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}, e1 = direction(), e2 = direction();
      const std::vector<Vec3> polygon{corner, corner + e1, corner + e1 + e2, corner + e2};
      const Vec3 middle = corner + 0.5f * (e1 + e2);
      Reflectors receivers(kCount);
      while (receivers.each.size() < kCount) {
        const std::size_t i = receivers.each.size();
        const Vec3 p = middle + uniform(0.3f, 20) * direction(), n = direction();
        // Mostly near the mirror direction of the light, where the lobe is; some anywhere, some along the normal.
        const Vec3 wi = glm::normalize(middle - p);
        const Vec3 mirror = 2 * glm::dot(wi, n) * n - wi;
        const Vec3 wo = i % 7 == 0 ? n : i % 5 == 0 ? direction() : glm::normalize(mirror + 0.2f * direction());
        const AnalyticBsdf form = i % 3 == 0 ? *analytic_form(Bsdf(Lambert{Color(0.2f, 0.5f, 0.7f)}))
                                             : *analytic_form(Bsdf(MetallicRoughness(Color(0.8f, 0.6f, 0.3f), 0.5f, roughness)));
        receivers.add(p, n, wo, form);
      }
      test::on_every_target([&] {
        Vec3Batch diffuse, specular, alone;
        for (Vec3Batch* b : {&diffuse, &specular, &alone}) b->resize(kCount);
        const ReceiverBatch batch{receivers.position, receivers.normal, receivers.wo, receivers.lobes};
        reflect_polygon(polygon, batch, kCount, diffuse, specular, sides);
        ltc_specular(polygon, batch, kCount, alone, sides);
        for (std::size_t i = 0; i < kCount; ++i) {
          const PolygonReflection truth =
              reflect_polygon(polygon, Reflectors::get(receivers.position, i), Reflectors::get(receivers.normal, i),
                              Reflectors::get(receivers.wo, i), receivers.each[i], sides);
          const Color d = Reflectors::get(diffuse, i), s = Reflectors::get(specular, i);
          for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(d[k], truth.diffuse[k], 1e-5 * truth.diffuse[k] + 4e-6) << roughness << " " << i;
            EXPECT_NEAR(s[k], truth.specular[k], 1e-4 * truth.specular[k] + 1e-5) << roughness << " " << i;
            EXPECT_GE(d[k], 0);
            EXPECT_GE(s[k], 0);
          }
          EXPECT_EQ(Reflectors::get(alone, i), s);
        }
      });
    }
  }
}

TEST(ReflectPolygonLanes, GrazingAndDegenerateViewsGiveNumbers) {
  const std::vector<Vec3> polygon{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}};
  Reflectors receivers(2048);
  for (const float roughness : {0.035f, 0.1f, 1.f})
    for (const Vec3& wo : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0.8f, 0, -0.6f), Vec3(1e-5f, 1, 0), Vec3(0)})
      for (const float x : {-1e6f, -1.f, 0.f, 0.5f, 1.f})
        for (const float z : {-1e6f, 0.f, 0.999999f, 1.f, 1.5f})
          receivers.add({x, 0.5f, z}, {0, 0, 1}, wo, *analytic_form(Bsdf(MetallicRoughness(Color(1), 0.5f, roughness))));
  test::on_every_target([&] {
    Vec3Batch diffuse, specular;
    diffuse.resize(2048), specular.resize(2048);
    const std::size_t count = receivers.each.size();
    reflect_polygon(polygon, {receivers.position, receivers.normal, receivers.wo, receivers.lobes}, count, diffuse, specular,
                    EmitterSides::two);
    for (std::size_t i = 0; i < count; ++i) {
      const Color d = Reflectors::get(diffuse, i), s = Reflectors::get(specular, i);
      ASSERT_TRUE(d.x >= 0 && d.x <= 1.2f && s.x >= 0 && s.x <= 1.2f) << i << " " << d.x << " " << s.x;
    }
  });
}

}  // namespace
}  // namespace sightline
