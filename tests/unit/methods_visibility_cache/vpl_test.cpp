// Virtual point lights against closed forms and path tracing.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/visibility_cache/virtual_point_lights.h"
#include "methods/visibility_cache/vpl_density.h"
#include "scene/builtin/parts.h"
#include "vpl_scenes.h"

namespace sightline::test {
namespace {

VirtualPointLights lights_of(const Room& room, const VirtualPointLightOptions& options, int threads = 1) {
  const View view(room.camera, {64, 48}, PixelFilter());
  Context context;
  context.threads = threads;
  RayCounts rays;
  return make_virtual_point_lights(*room.world, view, options, context, rays);
}

/// Means of either way agree within `deviations` standard errors, which must be small themselves.
void expect_same(const std::vector<Mean>& a, const std::vector<Mean>& b, double deviations, double precision, const std::string& name) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double x = static_cast<double>(luminance(a[k].value)), y = static_cast<double>(luminance(b[k].value));
    // Channels rise and fall together: their errors add up.
    const double ex = static_cast<double>(luminance(a[k].error)), ey = static_cast<double>(luminance(b[k].error));
    const double error = std::sqrt(ex * ex + ey * ey);
    EXPECT_GT(x, 0) << name;
    EXPECT_LT(error, precision * y) << name << " at receiver " << k;
    EXPECT_NEAR(x, y, deviations * error) << name << " at receiver " << k << ": " << (x - y) / error << " deviations";
  }
}

std::vector<Mean> path_traced(const Room& room, const std::vector<Receiver>& at, int max_bounces, int paths) {
  std::vector<Mean> means;
  for (const Receiver& receiver : at) means.push_back(path_traced_irradiance(*room.world, receiver, max_bounces, paths, 7));
  return means;
}

constexpr int kSeeds = 48;
constexpr RoomLight kLights[] = {RoomLight::area, RoomLight::point, RoomLight::directional, RoomLight::environment};

TEST(VirtualPointLights, OneBounceAgreesWithPathTracingWhicheverWayTheyAreMade) {
  const std::vector<Receiver> at = receivers();
  for (const RoomLight light : kLights) {
    const Room room = make_room(light);
    const std::vector<Mean> truth = path_traced(room, at, 1, 1 << 16);
    for (const float share : {0.f, 0.5f, 1.f}) {
      const VirtualPointLightOptions options{.count = 64, .candidates = 4, .backward_share = share, .clamp_distance = 0, .max_bounces = 1};
      expect_same(mean_virtual_irradiance(room, at, options, kSeeds), truth, 3, 0.08, room.name + ", share " + std::to_string(share));
    }
  }
}

TEST(VirtualPointLights, ManyBouncesAgreeWithPathTracing) {
  const std::vector<Receiver> at = receivers();
  for (const RoomLight light : {RoomLight::area, RoomLight::environment}) {
    const Room room = make_room(light);
    const std::vector<Mean> truth = path_traced(room, at, 3, 1 << 16);
    for (const float share : {0.f, 0.5f, 1.f}) {
      const VirtualPointLightOptions options{.count = 64, .candidates = 4, .backward_share = share, .clamp_distance = 0, .max_bounces = 3};
      expect_same(mean_virtual_irradiance(room, at, options, kSeeds), truth, 3, 0.08, room.name + ", share " + std::to_string(share));
    }
  }
}

TEST(VirtualPointLights, OneBounceAgreesWithPathTracingForAllReflectances) {
  const std::vector<Receiver> at = receivers();
  ConductorMaterial rough_metal;
  rough_metal.alpha_u = rough_metal.alpha_v = FloatParam{0.8f};
  DielectricMaterial frosted;
  frosted.alpha_u = frosted.alpha_v = FloatParam{0.7f};
  const std::pair<std::string, SurfaceModel> models[] = {{"diffuse", DiffuseMaterial{.reflectance = Color(0.9f)}},
                                                         {"metal", rough_metal},
                                                         {"paper", DiffuseTransmissionMaterial{Color(0.2f), Color(0.7f)}},
                                                         {"coated", CoatedDiffuseMaterial{}},
                                                         {"frosted glass", frosted}};
  for (const auto& [name, model] : models) {
    const Room room = make_room_of(model);
    const std::vector<Mean> truth = path_traced(room, at, 1, 1 << 16);
    for (const float share : {0.f, 0.5f}) {
      const VirtualPointLightOptions options{.count = 64, .candidates = 4, .backward_share = share, .clamp_distance = 0, .max_bounces = 1};
      expect_same(mean_virtual_irradiance(room, at, options, kSeeds), truth, 3, 0.08, name + ", share " + std::to_string(share));
    }
  }
}

TEST(VirtualPointLights, ParticlesGoByWayOfMirrors) {
  const std::vector<Receiver> at{receivers()[0]};
  const std::vector<Mean> truth = path_traced(make_mirror_room(false), at, 1, 1 << 16);
  const Room mirror = make_mirror_room(true);
  const VirtualPointLightOptions options{.count = 64, .candidates = 4, .clamp_distance = 0, .max_bounces = 2};
  expect_same(mean_virtual_irradiance(mirror, at, options, kSeeds), truth, 3, 0.02, "mirror");
  VirtualPointLightOptions once = options;
  once.max_bounces = 1;
  const float less = luminance(mean_virtual_irradiance(mirror, at, once, kSeeds)[0].value);
  EXPECT_LT(less, 0.95f * luminance(truth[0].value));
}

TEST(VirtualPointLights, ComeFromTheEyeWhereParticlesHardlyGetIn) {
  // Not one that sees the bright ground through the slit: most of the judges do not.
  const std::vector<Receiver> at{receivers()[0]};
  const Room room = make_slit_room();
  const std::vector<Mean> truth = path_traced(room, at, 3, 1 << 17);
  VirtualPointLightOptions options{.count = 32, .candidates = 4, .clamp_distance = 0, .max_bounces = 3};
  const std::vector<Mean> both = mean_virtual_irradiance(room, at, options, kSeeds);
  expect_same(both, truth, 3, 0.15, "slit");
  // Particles alone find next to nothing.
  options.backward_share = 0;
  const std::vector<Mean> particles = mean_virtual_irradiance(room, at, options, kSeeds);
  EXPECT_LT(luminance(particles[0].value), 0.5f * luminance(truth[0].value));
}

TEST(VirtualPointLights, CarryThePowerOfTheLight) {
  const Color radiance(3, 2, 1);
  constexpr float kSize = 0.5f, kReflectance = 0.75f;
  const Room room = make_closed_box(kReflectance, radiance, kSize);
  const Color power = radiance * (kPi * kSize * kSize);
  // Every particle meets a wall, so the flux of first bounces is exact without resampling.
  const VirtualPointLights all = lights_of(room, {.count = 512, .candidates = 1, .backward_share = 0, .max_bounces = 1});
  EXPECT_EQ(all.size, 512u);
  Color flux(0), reflected(0);
  for (std::size_t i = 0; i < all.size; ++i) flux += load(all.flux, i), reflected += load(all.radiosity, i) * kPi;
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(flux[c], power[c], 1e-4f * power[c]);
    EXPECT_NEAR(reflected[c], kReflectance * power[c], 1e-4f * power[c]);
  }
  // With resampling, weighting and n bounces: (1 + r + r² + ...) P on average.
  for (const int bounces : {1, 4}) {
    double sum = 0, squares = 0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const VirtualPointLights some = lights_of(room, {.count = 64, .max_bounces = bounces, .seed = static_cast<std::uint64_t>(seed)});
      double carried = 0;
      for (std::size_t i = 0; i < some.size; ++i) carried += static_cast<double>(some.flux.x[i]);
      sum += carried, squares += carried * carried;
    }
    const double mean = sum / kSeeds, error = std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1));
    double expected = 0;
    for (int b = 0; b < bounces; ++b) expected += std::pow(static_cast<double>(kReflectance), b) * static_cast<double>(power.x);
    EXPECT_LT(error, 0.05 * expected);
    EXPECT_NEAR(mean, expected, 3 * error) << bounces;
  }
}

TEST(VirtualPointLights, ResamplingKeepsTheMean) {
  const std::vector<Receiver> at = receivers();
  const Room room = make_room(RoomLight::point);
  const VirtualPointLightOptions all{.count = 1536, .candidates = 1, .clamp_distance = 0, .max_bounces = 2};
  const std::vector<Mean> truth = mean_virtual_irradiance(room, at, all, 12);
  // Few of many, and so many that some are drawn more than once.
  VirtualPointLightOptions few = all, most = all;
  few.count = 24, few.candidates = 16;
  most.count = 256, most.candidates = 2;
  expect_same(mean_virtual_irradiance(room, at, few, 96), truth, 3, 0.05, "few");
  expect_same(mean_virtual_irradiance(room, at, most, 48), truth, 3, 0.02, "most");
}

TEST(VirtualPointLights, DoNotDependOnThreads) {
  const Room room = make_room(RoomLight::environment);
  const VirtualPointLightOptions options{.count = 300, .max_bounces = 4, .seed = 3, .pass = 2};
  const VirtualPointLights one = lights_of(room, options, 1);
  EXPECT_GT(one.size, 100u);
  for (const int threads : {2, 5}) {
    const VirtualPointLights many = lights_of(room, options, threads);
    ASSERT_EQ(many.size, one.size);
    EXPECT_EQ(many.position.x, one.position.x);
    EXPECT_EQ(many.flux.x, one.flux.x);
    EXPECT_EQ(many.flux.z, one.flux.z);
    EXPECT_EQ(many.radiosity.y, one.radiosity.y);
    EXPECT_EQ(many.cell_area, one.cell_area);
  }
  VirtualPointLightOptions other = options;
  other.pass = 3;
  EXPECT_NE(lights_of(room, other).position.x, one.position.x);
}

TEST(VirtualPointLights, AreMergedWhereTheyCoincide) {
  const VirtualPointLights lights = lights_of(make_room(RoomLight::area), {.count = 400, .backward_share = 1});
  std::set<std::tuple<float, float, float>> places;
  for (std::size_t i = 0; i < lights.size; ++i) places.insert({lights.position.x[i], lights.position.y[i], lights.position.z[i]});
  EXPECT_GT(lights.size, 200u);
  EXPECT_EQ(places.size(), lights.size);
}

TEST(VirtualPointLights, PaddingIsDarkAndTheClampIsThatOfTheScene) {
  const Room room = make_room(RoomLight::area);
  const VirtualPointLights lights = lights_of(room, {.count = 50, .clamp_distance = 0.1f});
  EXPECT_LE(lights.size, 50u);
  for (std::size_t i = lights.size; i < padded(lights.size); ++i) EXPECT_EQ(load(lights.flux, i), Vec3(0));
  const float radius = room.world->bounds().half_diagonal();
  EXPECT_FLOAT_EQ(lights.max_geometry_term, 100 / (radius * radius));
  EXPECT_TRUE(std::isinf(lights_of(room, {.count = 8, .clamp_distance = 0}).max_geometry_term));
}

TEST(VirtualPointLights, NoneWithoutLightsBouncesOrCount) {
  const Room room = make_room(RoomLight::area);
  EXPECT_EQ(lights_of(room, {.count = 0}).size, 0u);
  EXPECT_EQ(lights_of(room, {.max_bounces = 0}).size, 0u);
  Scene dark;
  builtin::add_camera(dark, {0, 0, 3}, {0, 0, 0}, 40);
  const Room empty{"dark", World::build(dark, {}, Context()), dark.cameras.at(0)};
  EXPECT_EQ(lights_of(empty, {}).size, 0u);
}

TEST(VirtualPointLightDensity, AgreesWithBruteForce) {
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < 700; ++i) {
    const Vec2 a = sobol_2d(1, i, 0), b = sobol_2d(2, i, 1);
    points.emplace_back(a.x, a.y, i % 3 ? b.x : 0.5f);
  }
  points.resize(710, Vec3(0.25f));  // many in one place
  constexpr std::size_t kCount = 8;
  const std::vector<float> areas = vpl::neighbour_areas(points, kCount, 0, 100, Context());
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<float> squared;
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (j != i) squared.push_back(length_squared(points[j] - points[i]));
    }
    std::nth_element(squared.begin(), squared.begin() + kCount - 1, squared.end());
    EXPECT_FLOAT_EQ(areas[i], kPi * squared[kCount - 1] / kCount) << i;
  }
}

TEST(VirtualPointLightDensity, PointsOfAPlaneShareItsArea) {
  // Independent points: hashes, not a low-discrepancy sequence.
  constexpr std::uint32_t kPoints = 8000;
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < kPoints; ++i) points.emplace_back(3 * unit_float(hash32(2 * i)), 0, 2 * unit_float(hash32(2 * i + 1)));
  const std::vector<float> areas = vpl::neighbour_areas(points, 8, 0, 100, Context());
  double sum = 0, count = 0;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    if (points[i].x < 0.3f || points[i].x > 2.7f || points[i].z < 0.3f || points[i].z > 1.7f) continue;
    sum += static_cast<double>(areas[i]), ++count;
  }
  // A disk's area has a relative deviation of 1/sqrt(8); about 8 points share what they tell.
  EXPECT_NEAR(kPoints * sum / count, 6, 4 * 6 / std::sqrt(count));
}

TEST(VirtualPointLightDensity, FewPointsUseWhatThereIs) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  const std::vector<float> areas = vpl::neighbour_areas(points, 8, 0, 100, Context());
  EXPECT_FLOAT_EQ(areas[0], 4 * kPi / 2);
  EXPECT_FLOAT_EQ(areas[1], 5 * kPi / 2);
  EXPECT_EQ(vpl::neighbour_areas(std::span(points).first(1), 8, 0, 42, Context())[0], 42);
  EXPECT_TRUE(vpl::neighbour_areas({}, 8, 0, 42, Context()).empty());
}

TEST(VirtualPointLightDensity, LightsSpreadEvenlyOverAPlaneShareItsArea) {
  Scene scene;
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}).build("floor"),
                    builtin::add_diffuse(scene, "floor", Color(0.5f)));
  scene.lights.push_back({.name = "sun", .shape = DirectionalLight{{0, -1, 0}, Color(1)}, .node = {}});
  builtin::add_camera(scene, {0, 3, 0.1f}, {0, 0, 0}, 60);
  const Room room{"floor", World::build(scene, {}, Context()), scene.cameras.at(0)};
  const VirtualPointLights lights = lights_of(room, {.count = 2000, .candidates = 1, .eye_samples = 0, .max_bounces = 1});
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < lights.size; ++i) {
    if (std::fabs(lights.position.x[i]) > 0.8f || std::fabs(lights.position.z[i]) > 0.8f) continue;
    sum += static_cast<double>(lights.cell_area[i]), ++count;
  }
  EXPECT_NEAR(static_cast<double>(lights.size) * sum / count, 4, 4 * 4 / std::sqrt(count));
}

}  // namespace
}  // namespace sightline::test
