#include "shade/material_eval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/chi_square.h"

namespace sightline::test {
namespace {

MaterialId add(Scene& scene, const SurfaceModel& model) {
  Material material;
  material.model = model;
  scene.materials.push_back(std::move(material));
  return MaterialId(scene.materials.size() - 1);
}

TextureId add_constant(Scene& scene, const Vec4& value) {
  scene.textures.push_back({"constant", ConstantTexture{value}});
  return TextureId(scene.textures.size() - 1);
}

/// Height or colour that rises by 1 from left to right, in float steps of one texel.
TextureId add_ramp(Scene& scene, int width) {
  auto image = std::make_shared<Image>();
  image->width = width;
  image->height = 2;
  image->channels = 1;
  Image::Floats values;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < width; ++x) values.push_back((static_cast<float>(x) + 0.5f) / static_cast<float>(width));
  image->data = std::move(values);
  scene.images.push_back({"ramp", image});
  ImageTexture texture;
  texture.image = ImageId(scene.images.size() - 1);
  texture.encoding = ColorEncoding::linear;
  texture.filter = TextureFilter::linear;
  scene.textures.push_back({"ramp", texture});
  return TextureId(scene.textures.size() - 1);
}

const TexturePoint kMiddle{Vec2(0.5f), Vec2(0), Vec2(0)};

TEST(MaterialEval, NoMaterialIsLambertSeventyPercent) {
  const Scene scene;
  const TextureSet textures;
  for (const MaterialId id : {MaterialId(), MaterialId(std::size_t{7})}) {
    const Bsdf bsdf = make_bsdf(scene, textures, id, kMiddle, 0.5f);
    ASSERT_TRUE(bsdf.lambert());
    EXPECT_EQ(bsdf.lambert()->reflectance, Color(0.7f));
  }
}

TEST(MaterialEval, EachModelBecomesItsBsdf) {
  Scene scene;
  const TextureSet textures;
  const auto made = [&](const SurfaceModel& model) { return make_bsdf(scene, textures, add(scene, model), kMiddle, 0.5f).model(); };
  EXPECT_TRUE(std::holds_alternative<Lambert>(made(DiffuseMaterial{})));
  EXPECT_TRUE(std::holds_alternative<MetallicRoughness>(made(MetallicRoughnessMaterial{})));
  EXPECT_TRUE(std::holds_alternative<Conductor>(made(ConductorMaterial{})));
  EXPECT_TRUE(std::holds_alternative<Dielectric>(made(DielectricMaterial{})));
  EXPECT_TRUE(std::holds_alternative<CoatedDiffuse>(made(CoatedDiffuseMaterial{})));
  EXPECT_TRUE(std::holds_alternative<Phong>(made(PhongMaterial{})));
  EXPECT_TRUE(std::holds_alternative<DiffuseTransmission>(made(DiffuseTransmissionMaterial{})));
  EXPECT_TRUE(std::holds_alternative<Ward>(made(WardMaterial{})));
  EXPECT_TRUE(std::holds_alternative<CookTorrance>(made(CookTorranceMaterial{})));
  EXPECT_TRUE(std::holds_alternative<Lambert>(made(MeasuredMaterial{})));
  const ReflectanceSample sample{.value = Color(0.1f)};
  MeasuredMaterial measured;
  measured.data = std::make_shared<const MeasuredReflectance>(std::span(&sample, 1));
  EXPECT_TRUE(std::holds_alternative<MeasuredBrdf>(made(measured)));
}

TEST(MaterialEval, InterfacesLetLightPassStraight) {
  Scene scene;
  const MaterialId interface = add(scene, InterfaceMaterial{}), plain = add(scene, DiffuseMaterial{});
  EXPECT_TRUE(is_interface(scene, interface));
  EXPECT_FALSE(is_interface(scene, plain));
  EXPECT_FALSE(is_interface(scene, {}));
  const Vec3 wo = glm::normalize(Vec3(0.3f, -0.4f, 0.6f));
  const auto s = make_bsdf(scene, TextureSet(), interface, kMiddle, 0.5f).sample(wo, 0, Vec2(0.5f));
  ASSERT_TRUE(s && s->is_transmission && s->is_delta);
  EXPECT_LT(glm::length(s->wi + wo), 1e-6f);
  EXPECT_EQ(s->weight, Color(1));
}

TEST(MaterialEval, RoughnessIsRemappedByItsRoot) {
  Scene scene;
  ConductorMaterial remapped, plain;
  remapped.alpha_u = remapped.alpha_v = 0.09f;
  remapped.remap_roughness = true;
  plain.alpha_u = plain.alpha_v = 0.3f;
  const TextureSet textures;
  const Bsdf a = make_bsdf(scene, textures, add(scene, remapped), kMiddle, 0),
             b = make_bsdf(scene, textures, add(scene, plain), kMiddle, 0);
  const Vec3 wo = glm::normalize(Vec3(0.3f, 0, 1)), wi = glm::normalize(Vec3(-0.2f, 0.1f, 1));
  EXPECT_NEAR(a.evaluate(wo, wi).pdf, b.evaluate(wo, wi).pdf, 1e-4);
}

TEST(MaterialEval, ParametersBeyondTheirRangeAreTakenBackIntoIt) {
  Scene scene;
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf, -inf, -1.f, 7.f}) {
    const SurfaceModel models[] = {DiffuseMaterial{bad},
                                   MetallicRoughnessMaterial{bad, bad, bad},
                                   ConductorMaterial{bad, bad, bad, bad, bad, true},
                                   DielectricMaterial{bad, bad, bad, true, false},
                                   CoatedDiffuseMaterial{bad, bad, bad, bad, true},
                                   PhongMaterial{bad, bad, bad},
                                   DiffuseTransmissionMaterial{bad, bad},
                                   WardMaterial{bad, bad, bad, bad},
                                   CookTorranceMaterial{bad, bad, bad, bad}};
    for (const SurfaceModel& model : models) {
      const Bsdf bsdf = make_bsdf(scene, TextureSet(), add(scene, model), kMiddle, 0.5f);
      Uniform random(1);
      for (int i = 0; i < 100; ++i) {
        const Vec3 wo = sample_cosine_hemisphere(random.next2());
        const auto s = bsdf.sample(wo, random.next(), random.next2(), TransportMode::importance);
        if (!s) continue;
        EXPECT_TRUE(is_finite(s->weight) && is_finite(s->wi) && std::isfinite(s->pdf)) << model.index() << " " << bad;
      }
      EXPECT_TRUE(is_finite(bsdf.albedo())) << model.index() << " " << bad;
    }
  }
}

TEST(MaterialEval, TexturesScaleParameters) {
  Scene scene;
  DiffuseMaterial diffuse;
  diffuse.reflectance = Color(0.5f);
  diffuse.reflectance.texture = add_constant(scene, Vec4(0.2f, 0.4f, 0.8f, 1));
  const MaterialId id = add(scene, diffuse);
  const TextureSet textures(scene, Context());
  const Bsdf bsdf = make_bsdf(scene, textures, id, kMiddle, 0.5f);
  ASSERT_TRUE(bsdf.lambert());
  EXPECT_LT(glm::length(bsdf.lambert()->reflectance - Color(0.1f, 0.2f, 0.4f)), 1e-6f);
}

TEST(MaterialEval, MixPicksTheSecondWithItsAmount) {
  Scene scene;
  const MaterialId first = add(scene, DiffuseMaterial{}), second = add(scene, DiffuseMaterial{});
  const MaterialId inner = add(scene, MixMaterial{first, second, 0.25f});
  const MaterialId outer = add(scene, MixMaterial{first, inner, 0.8f});
  const TextureSet textures;
  int picked = 0;
  constexpr int kCount = 10000;
  for (int i = 0; i < kCount; ++i) {
    float u = (static_cast<float>(i) + 0.5f) / kCount;
    const MaterialId id = resolve_mix(scene, textures, outer, kMiddle, u);
    EXPECT_TRUE(id == first || id == second);
    EXPECT_TRUE(u >= 0 && u < 1);
    picked += id == second;
  }
  EXPECT_NEAR(picked, 0.8 * 0.25 * kCount, 2);
}

TEST(MaterialEval, CircularMixesEnd) {
  Scene scene;
  const MaterialId loop = add(scene, MixMaterial{MaterialId(std::size_t{0}), MaterialId(std::size_t{0}), 0.5f});
  float u = 0.3f;
  EXPECT_FALSE(resolve_mix(scene, TextureSet(), loop, kMiddle, u).valid());
  EXPECT_TRUE(make_bsdf(scene, TextureSet(), loop, kMiddle, 0.3f).lambert());
}

class PerturbFrame : public ::testing::Test {
 protected:
  Frame3 perturb(const Vec3& wo = Vec3(0)) {
    const TextureSet textures(scene_, Context());
    return perturb_frame(scene_, textures, MaterialId(std::size_t{0}), kMiddle, frame_, dp_du_, dp_dv_, geometric_, wo);
  }
  Scene scene_;
  // A table top: u along x, v (downwards in the image) along -y, so that image-up is +y.
  Vec3 dp_du_{2, 0, 0}, dp_dv_{0, -2, 0}, geometric_{0, 0, 1};
  Frame3 frame_ = frame_from_normal_tangent(Vec3(0, 0, 1), Vec3(1, 0, 0));
};

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  EXPECT_LT(glm::length(a - b), tolerance) << "(" << a.x << ", " << a.y << ", " << a.z << ") against (" << b.x << ", " << b.y << ", " << b.z
                                           << ")";
}

TEST_F(PerturbFrame, FlatNormalMapChangesNothing) {
  add(scene_, DiffuseMaterial{});
  scene_.materials[0].normal_map = add_constant(scene_, Vec4(0.5f, 0.5f, 1, 1));
  expect_near(perturb().normal, Vec3(0, 0, 1));
  expect_near(perturb().tangent, Vec3(1, 0, 0));
}

TEST_F(PerturbFrame, RedTiltsAlongUAndGreenUpTheImage) {
  add(scene_, DiffuseMaterial{});
  const Vec3 wanted = glm::normalize(Vec3(0.3f, 0.4f, 0.8f));
  scene_.materials[0].normal_map = add_constant(scene_, Vec4(0.5f + 0.5f * wanted, 1));
  expect_near(perturb().normal, wanted);
  // Mirrored texture coordinates turn only the green direction.
  dp_dv_ = -dp_dv_;
  expect_near(perturb().normal, Vec3(wanted.x, -wanted.y, wanted.z));
  dp_dv_ = -dp_dv_;
  scene_.materials[0].normal_scale = 0.5f;
  expect_near(perturb().normal, glm::normalize(Vec3(0.5f * wanted.x, 0.5f * wanted.y, wanted.z)));
}

TEST_F(PerturbFrame, BumpFollowsTheSlopeOfTheHeight) {
  add(scene_, DiffuseMaterial{});
  scene_.materials[0].bump = add_ramp(scene_, 64);
  scene_.materials[0].bump_scale = 0.5f;
  // Height rises by 0.5 over one unit of u, which is 2 world units: slope 1/4.
  expect_near(perturb().normal, glm::normalize(Vec3(-0.25f, 0, 1)), 2e-3f);
}

TEST(PerturbFrameOnASphere, BumpIsTheNormalOfTheDisplacedSphere) {
  Scene scene;
  add(scene, DiffuseMaterial{});
  scene.materials[0].bump = add_ramp(scene, 64);
  scene.materials[0].bump_scale = 0.6f;
  const TextureSet textures(scene, Context());
  constexpr double kRadius = 0.9;
  const auto outward = [](double u, double v) {
    return Vec3d(std::sin(kPi * v) * std::cos(2 * kPi * u), std::sin(kPi * v) * std::sin(2 * kPi * u), std::cos(kPi * v));
  };
  const auto displaced = [&](double u, double v) { return (kRadius + 0.6 * u) * outward(u, v); };
  for (const double u : {0.2, 0.5, 0.8}) {
    for (const double v : {0.25, 0.5, 0.7}) {
      constexpr double h = 1e-5;
      const Vec3 n(outward(u, v));
      const Vec3 dn_du((outward(u + h, v) - outward(u - h, v)) / (2 * h)), dn_dv((outward(u, v + h) - outward(u, v - h)) / (2 * h));
      const Vec3 dp_du = static_cast<float>(kRadius) * dn_du, dp_dv = static_cast<float>(kRadius) * dn_dv;
      const TexturePoint point{Vec2(static_cast<float>(u), static_cast<float>(v)), Vec2(0), Vec2(0)};
      const Frame3 frame = frame_from_normal_tangent(n, dp_du);
      Vec3d truth = glm::cross(displaced(u + h, v) - displaced(u - h, v), displaced(u, v + h) - displaced(u, v - h));
      if (glm::dot(truth, Vec3d(n)) < 0) truth = -truth;
      expect_near(perturb_frame(scene, textures, MaterialId(std::size_t{0}), point, frame, dp_du, dp_dv, dn_du, dn_dv, n).normal,
                  Vec3(glm::normalize(truth)), 1e-3f);
      // From within, the height is measured along the normal there.
      Vec3d inner = glm::cross((kRadius - 0.6 * u) * (outward(u + h, v) - outward(u - h, v)) - 1.2 * h * outward(u, v),
                               (kRadius - 0.6 * u) * (outward(u, v + h) - outward(u, v - h)));
      if (glm::dot(inner, Vec3d(n)) > 0) inner = -inner;
      const Frame3 turned = frame_from_normal_tangent(-n, dp_du);
      expect_near(perturb_frame(scene, textures, MaterialId(std::size_t{0}), point, turned, dp_du, dp_dv, -dn_du, -dn_dv, -n).normal,
                  Vec3(glm::normalize(inner)), 1e-3f);
    }
  }
}

TEST_F(PerturbFrame, ConstantBumpChangesNothing) {
  add(scene_, DiffuseMaterial{});
  scene_.materials[0].bump = add_constant(scene_, Vec4(3));
  expect_near(perturb().normal, Vec3(0, 0, 1));
}

TEST_F(PerturbFrame, NormalStaysOnTheSidesOfGeometryAndViewer) {
  add(scene_, DiffuseMaterial{});
  Uniform random(4);
  for (int i = 0; i < 500; ++i) {
    scene_.textures.clear();
    const Vec3 texel(random.next(), random.next(), random.next());
    scene_.materials[0].normal_map = add_constant(scene_, Vec4(texel, 1));
    frame_ = frame_from_normal(sample_uniform_hemisphere(random.next2()));
    const Vec3 wo = sample_uniform_sphere(random.next2());
    const Frame3 frame = perturb(wo);
    EXPECT_GT(glm::dot(frame.normal, geometric_), 0);
    EXPECT_GT(glm::dot(frame.normal, wo) * glm::dot(geometric_, wo), 0);
    EXPECT_NEAR(glm::length(frame.normal), 1, 1e-5);
    EXPECT_NEAR(glm::dot(frame.tangent, frame.normal), 0, 1e-4);
    EXPECT_NEAR(glm::dot(frame.bitangent, frame.tangent), 0, 1e-5);
  }
}

}  // namespace
}  // namespace sightline::test
