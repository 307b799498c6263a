// The environment as texels and as squares: areas, energy, the error J, and the order of merges.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "base/math/frame.h"
#include "base/sample/warp.h"
#include "methods/square_lights/merge_tree.h"
#include "methods/square_lights/square_fit.h"
#include "methods/square_lights/texel_exchange.h"

namespace sightline::square_lights {
namespace {

/// Smooth light with a few small bright spots.
Color sky(const Vec3& d) {
  Color light = Color(0.4f, 0.5f, 0.7f) * (1.2f + d.y) + Color(0.2f) * std::sin(7 * d.x) * std::cos(5 * d.z + 1) + Color(0.25f);
  if (glm::dot(d, glm::normalize(Vec3(1, 2, 0.3f))) > 0.995f) light += Color(300, 280, 200);
  if (glm::dot(d, glm::normalize(Vec3(-1, 0.2f, 0.6f))) > 0.98f) light += Color(3, 9, 20);
  return light;
}

LightCube sky_cube(int size) {
  const Context context;
  return make_light_cube(sky, size, 4, context);
}

constexpr std::array kCriteria{MergeOptions::Criterion::paper, MergeOptions::Criterion::ward, MergeOptions::Criterion::moments};

Color total(std::span<const SquareLight> lights) {
  glm::dvec3 sum(0);
  for (const SquareLight& light : lights) sum += static_cast<double>(light.solid_angle()) * glm::dvec3(light.radiance);
  return Color(sum);
}

TEST(LightCube, ASunOfOnePixelIsNotLost) {
  // One pixel, a thousandth of a texel, wherever in the texels it falls.
  constexpr int width = 512, height = 256;
  for (const IVec2 sun : {IVec2(100, 75), IVec2(311, 120), IVec2(7, 150)}) {
    Image image{width, height, 3, Image::Floats{}};
    auto& values = std::get<Image::Floats>(image.data);
    values.assign(image.pixel_count() * 3, 0.f);
    std::fill_n(values.begin() + (std::ptrdiff_t{sun.y} * width + sun.x) * 3, 3, 1e5f);
    Environment environment;
    environment.image = std::make_shared<const Image>(std::move(image));
    environment.scale = Color(1, 2, 0.5f);
    const Color sum = light_cube_of(environment, 8, Context{}).integral();
    const auto row = [](int y) { return std::cos(kPi * static_cast<float>(y) / height); };
    const float angle = 2 * kPi / width * (row(sun.y) - row(sun.y + 1));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / (1e5f * angle * environment.scale[c]), 1, 0.01f) << sun.x;
  }
}

TEST(LightCube, CentersLieInTheirTexels) {
  const LightCube cube = sky_cube(8);
  ASSERT_EQ(cube.count(), 6u * 64);
  double sphere = 0;
  for (std::size_t i = 0; i < cube.count(); ++i) {
    EXPECT_EQ(cube.texel_of(cube.center(i)), i);
    sphere += cube.solid_angle(i);
  }
  EXPECT_NEAR(sphere, 4 * std::numbers::pi, 1e-4);
}

TEST(LightCube, KeepsTheIntegralOfSmallLights) {
  const Context context;
  // A cap of 2 pi (1 - cos) = 0.0126 sr: some twelve texels, most of them cut by its edge.
  const Vec3 axis = glm::normalize(Vec3(0.3f, 0.9f, 0.4f));
  const auto cap = [&](const Vec3& d) { return glm::dot(d, axis) > 0.998f ? Color(10, 20, 30) : Color(0); };
  const Color sum = make_light_cube(cap, 16, 24, context).integral();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / (10 * (c + 1) * 2 * kPi * 0.002f), 1, 0.02f);
}

TEST(SquareLight, HasTheSolidAngleOfItsSquare) {
  // Stratified directions of a cap around the light, counted within the square.
  constexpr int kEdge = 1200;
  for (const float r : {0.01f, 0.1f, 0.5f, 1.f}) {
    const float half = r / std::sqrt(2.f), height = 0.55f * r * r;  // 1 - cos of the cap: 2 sin(angle / 2) = sqrt(2 height) >= r
    int inside = 0;
    for (int i = 0; i < kEdge * kEdge; ++i) {
      const float drop = height * (static_cast<float>(i / kEdge) + 0.5f) / kEdge, turn = (static_cast<float>(i % kEdge) + 0.5f) / kEdge;
      const float sine = std::sqrt(drop * (2 - drop)), angle = 2 * kPi * turn;
      const Vec2 p = lambert_azimuthal({sine * std::cos(angle), sine * std::sin(angle), 1 - drop});
      inside += std::fabs(p.x) <= half && std::fabs(p.y) <= half;
    }
    const float measured = 2 * kPi * height * static_cast<float>(inside) / (kEdge * kEdge);
    const SquareLight light{{0, 0, 1}, r, Color(1)};
    EXPECT_NEAR(measured / light.solid_angle(), 1, 2e-3f) << "r " << r;
  }
}

/// A block of texels of a face with made-up colours; calls add(direction, solid angle, radiance) for `points` x `points` parts of each.
template <class Add>
void block_points(int points, Add&& add) {
  constexpr int kSize = 16;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int y = 3; y < 8; ++y) {
    for (int x = 6; x < 12; ++x) {
      const Color radiance(unit(random), 2 * unit(random), unit(random) < 0.2f ? 6.f : 0.5f);
      for (int j = 0; j < points; ++j) {
        for (int i = 0; i < points; ++i) {
          const int fine = kSize * points, px = x * points + i, py = y * points + j;
          add(glm::normalize(cube_direction(2, cube_coordinate(px, fine), cube_coordinate(py, fine))), cube_texel_solid_angle(px, py, fine),
              radiance);
        }
      }
    }
  }
}

TEST(SquareFit, ErrorIsTheIntegralOfTheSquaredDifference) {
  SquareFitter fitter;
  block_points(24, [&](const Vec3& d, float w, const Color& l) { fitter.add(d, w, l); });
  const double region = fitter.solid_angle();
  const Vec3 center = glm::normalize(cube_direction(2, 0.06f, -0.27f));
  for (const float scale : {0.5f, 0.8f, 1.f, 1.4f}) {
    const float r = scale * std::sqrt(static_cast<float>(region) / 2), half = r / std::sqrt(2.f);
    const SquareLight light = fitter.light(center, r);
    // (T - F)² over S and O, by many small pieces of S; what of O lies beyond S has T = 0.
    const Frame3 frame = frame_from_normal(center);
    double error = 0;
    for (int turn = 0; turn < 4; ++turn) {
      const double c = std::cos(turn * std::numbers::pi / 8), s = std::sin(turn * std::numbers::pi / 8);
      double shared = 0;
      block_points(96, [&](const Vec3& d, float w, const Color& l) {
        const Vec2 p = lambert_azimuthal(frame.to_local(d));
        const bool inside = std::fabs(c * p.x + s * p.y) <= half && std::fabs(c * p.y - s * p.x) <= half;
        const glm::dvec3 difference = glm::dvec3(l) - (inside ? glm::dvec3(light.radiance) : glm::dvec3(0));
        error += w * glm::dot(difference, difference) / 4;
        if (inside) shared += w;
      });
      error += (2.0 * r * r - shared) * glm::dot(glm::dvec3(light.radiance), glm::dvec3(light.radiance)) / 4;
    }
    EXPECT_NEAR(fitter.error(center, r, true) / (region * error), 1, 1e-4) << "scale " << scale;
    EXPECT_NEAR(fitter.error(center, r, false) / error, 1, 1e-4);
  }
}

TEST(SquareFit, NoOtherSquareNearbyIsMuchBetter) {
  SquareFitter fitter;
  block_points(2, [&](const Vec3& d, float w, const Color& l) { fitter.add(d, w, l); });
  const SquareFit fit = fitter.fit({}, true);
  EXPECT_NEAR(fitter.error(fit.light.center, fit.light.radius, true), fit.error, 1e-6 * fit.error);
  const Frame3 frame = frame_from_normal(fit.light.center);
  double least = fit.error;
  for (int y = -4; y <= 4; ++y) {
    for (int x = -4; x <= 4; ++x) {
      const float step = 0.1f * fit.light.radius;
      const Vec3 center = glm::normalize(frame.to_world({step * static_cast<float>(x), step * static_cast<float>(y), 1}));
      for (float scale = 0.5f; scale < 1.8f; scale *= 1.1f) least = std::min(least, fitter.error(center, scale * fit.light.radius, true));
    }
  }
  EXPECT_GT(least, 0.97 * fit.error);
}

TEST(MergeTree, KeepsTheEnergyAtEveryNumberOfLights) {
  const LightCube cube = sky_cube(16);
  const Context context;
  for (const auto criterion : kCriteria) {
    const MergeTree tree = MergeTree::build(cube, {criterion, true}, context);
    EXPECT_EQ(tree.least(), criterion == MergeOptions::Criterion::moments ? 1u : 6u);
    const Color expected = cube.integral();
    for (const std::size_t count : {6u, 10u, 30u, 100u, 1000u, 1536u}) {
      const std::vector<SquareLight> lights = tree.lights(count);
      ASSERT_EQ(lights.size(), count);
      const Color sum = total(lights);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / expected[c], 1, 1e-5);
    }
  }
}

TEST(MergeTree, CutsAreRegionsThatCoverEveryTexelOnce) {
  const LightCube cube = sky_cube(8);
  const Context context;
  for (const auto criterion : kCriteria) {
    const MergeTree tree = MergeTree::build(cube, {criterion, true}, context);
    EXPECT_EQ(tree.cut(1).size(), tree.least());
    EXPECT_EQ(tree.cut(100000).size(), tree.texels());
    for (const std::size_t count : {6u, 25u, 200u}) {
      std::multiset<std::int32_t> covered;
      for (const std::int32_t top : tree.cut(count)) {
        std::vector<std::int32_t> open{top};
        double area = 0;
        glm::dvec2 sums(0);
        std::vector<std::int32_t> texels;
        while (!open.empty()) {
          const std::int32_t node = open.back();
          open.pop_back();
          const MergeNode& n = tree.nodes()[static_cast<std::size_t>(node)];
          if (n.left < 0) {
            texels.push_back(node);
          } else {
            open.push_back(n.left), open.push_back(n.right);
          }
        }
        for (const std::int32_t t : texels) {
          const auto i = static_cast<std::size_t>(t);
          area += cube.solid_angle(i);
          sums.x += static_cast<double>(cube.solid_angle(i)) * luminance(cube.texels[i]);
          if (criterion != MergeOptions::Criterion::moments) {
            EXPECT_EQ(i / 64, static_cast<std::size_t>(texels[0]) / 64) << "of one face";
          }
        }
        double second = 0, third = 0;
        for (const std::int32_t t : texels) {
          const auto i = static_cast<std::size_t>(t);
          const double d = std::fabs(luminance(cube.texels[i]) - sums.x / area);
          second += cube.solid_angle(i) * d * d / area, third += cube.solid_angle(i) * d * d * d / area;
        }
        const MergeNode& node = tree.nodes()[static_cast<std::size_t>(top)];
        EXPECT_NEAR(node.solid_angle, area, 1e-5 * area);
        EXPECT_NEAR(node.deviation, std::sqrt(second), 1e-4 * std::sqrt(second) + 1e-6);
        EXPECT_NEAR(node.third_moment, std::cbrt(third), 1e-4 * std::cbrt(third) + 1e-6);
        covered.insert(texels.begin(), texels.end());
      }
      ASSERT_EQ(covered.size(), cube.count());
      for (std::size_t i = 0; i < cube.count(); ++i) EXPECT_EQ(covered.count(static_cast<std::int32_t>(i)), 1u);
    }
  }
}

TEST(MergeTree, IsTheSameForAnyNumberOfThreads) {
  const LightCube cube = sky_cube(8);
  Context one, four;
  one.threads = 1, four.threads = 4;
  const MergeTree a = MergeTree::build(cube, {}, one), b = MergeTree::build(cube, {}, four);
  ASSERT_EQ(a.nodes().size(), b.nodes().size());
  for (std::size_t i = 0; i < a.nodes().size(); ++i) {
    EXPECT_EQ(a.nodes()[i].left, b.nodes()[i].left);
    EXPECT_EQ(a.nodes()[i].error, b.nodes()[i].error);
    EXPECT_EQ(a.nodes()[i].light.center, b.nodes()[i].light.center);
  }
}

/// The paper's algorithm word for word: in every step the error of each pair of neighbours, anew.
std::vector<std::pair<std::int32_t, std::int32_t>> merge_naively(const LightCube& cube, MergeOptions options) {
  const int size = cube.size;
  const std::size_t face_texels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  struct Region {
    std::vector<std::uint32_t> texels;
    Vec3 center;
    double error;
  };
  SquareFitter fitter;
  const auto collect = [&](const Region& region, bool fine) {
    for (const std::uint32_t t : region.texels) {
      if (!fine) fitter.add(cube.center(t), cube.solid_angle(t), cube.texels[t]);
      const int face = static_cast<int>(t / face_texels), x = static_cast<int>(t % face_texels) % size;
      const int y = static_cast<int>(t % face_texels) / size;
      for (int q = 0; q < (fine ? 4 : 0); ++q) {
        const int i = 2 * x + q % 2, j = 2 * y + q / 2;
        const Vec3 d = glm::normalize(cube_direction(face, cube_coordinate(i, 2 * size), cube_coordinate(j, 2 * size)));
        fitter.add(d, cube_texel_solid_angle(i, j, 2 * size), cube.texels[t]);
      }
    }
  };
  std::map<std::int32_t, Region> regions;
  for (std::uint32_t t = 0; t < cube.count(); ++t) {
    Region region{{t}, cube.center(t), 0};
    fitter.clear();
    collect(region, true);
    region.error = static_cast<float>(std::max(0.0, fitter.error(region.center, std::sqrt(cube.solid_angle(t) / 2), options.area_penalty)));
    regions.emplace(static_cast<std::int32_t>(t), region);
  }
  const auto adjacent = [&](const Region& a, const Region& b) {
    for (const std::uint32_t s : a.texels) {
      for (const std::uint32_t t : b.texels) {
        if (s / face_texels != t / face_texels) continue;
        const int dx = static_cast<int>(s % static_cast<std::uint32_t>(size)) - static_cast<int>(t % static_cast<std::uint32_t>(size));
        const int dy = static_cast<int>(s % face_texels) / size - static_cast<int>(t % face_texels) / size;
        if (std::abs(dx) + std::abs(dy) == 1) return true;
      }
    }
    return false;
  };
  std::vector<std::pair<std::int32_t, std::int32_t>> merges;
  // The same pair has the same fit: only time is saved. -1: not neighbours, -2: not known yet.
  const std::size_t most = 2 * cube.count();
  std::vector<SquareFit> fits(most * most);
  for (SquareFit& fit : fits) fit.error = -2;
  while (regions.size() > 6) {
    float least = 1e30f;
    std::pair<std::int32_t, std::int32_t> best;
    for (auto a = regions.begin(); a != regions.end(); ++a) {
      for (auto b = std::next(a); b != regions.end(); ++b) {
        const std::pair pair{a->first, b->first};
        SquareFit& fit = fits[static_cast<std::size_t>(a->first) * most + static_cast<std::size_t>(b->first)];
        if (fit.error == -2) {
          fit.error = -1;
          if (adjacent(a->second, b->second)) {
            fitter.clear();
            const bool fine = a->second.texels.size() + b->second.texels.size() < 64;
            collect(a->second, fine), collect(b->second, fine);
            const std::array<Vec3, 2> starts{a->second.center, b->second.center};
            fit = fitter.fit(starts, options.area_penalty);
          }
        }
        if (fit.error < 0) continue;
        float key = fit.error;
        if (options.criterion == MergeOptions::Criterion::ward)
          key -= static_cast<float>(a->second.error) + static_cast<float>(b->second.error);
        if (key < least) least = key, best = pair;
      }
    }
    const SquareFit fit = fits[static_cast<std::size_t>(best.first) * most + static_cast<std::size_t>(best.second)];
    Region merged{{}, fit.light.center, fit.error};
    const Region &a = regions.at(best.first), &b = regions.at(best.second);
    std::merge(a.texels.begin(), a.texels.end(), b.texels.begin(), b.texels.end(), std::back_inserter(merged.texels));
    regions.erase(best.first), regions.erase(best.second);
    regions.emplace(static_cast<std::int32_t>(cube.count() + merges.size()), merged);
    merges.push_back(best);
  }
  return merges;
}

TEST(MergeTree, MergesInTheOrderOfTheNaiveAlgorithm) {
  const LightCube cube = sky_cube(8);
  const Context context;
  for (const auto criterion : {MergeOptions::Criterion::paper, MergeOptions::Criterion::ward}) {
    const MergeOptions options{criterion, true};
    const MergeTree tree = MergeTree::build(cube, options, context);
    const auto merges = merge_naively(cube, options);
    ASSERT_EQ(merges.size(), tree.nodes().size() - tree.texels());
    for (std::size_t k = 0; k < merges.size(); ++k) {
      const MergeNode& node = tree.nodes()[tree.texels() + k];
      ASSERT_EQ(std::minmax(node.left, node.right), std::minmax(merges[k].first, merges[k].second)) << "merge " << k;
    }
  }
}

TEST(MergeTree, FindsASquareSource) {
  constexpr int kSize = 32;
  LightCube cube;
  cube.size = kSize;
  cube.texels.assign(6 * kSize * kSize, Color(0.01f));
  double area = 0;
  for (std::size_t y = 12; y < 18; ++y) {
    for (std::size_t x = 9; x < 15; ++x) {
      const std::size_t texel = (std::size_t{2} * kSize + y) * kSize + x;
      cube.texels[texel] = Color(50, 40, 30);
      area += cube.solid_angle(texel);
    }
  }
  const Vec3 truth = glm::normalize(cube_direction(2, 2 * 12.f / kSize - 1, 2 * 15.f / kSize - 1));
  const float texel = std::sqrt(static_cast<float>(area) / 36);
  const Context context;
  for (const auto criterion : kCriteria) {
    const std::vector<SquareLight> lights = MergeTree::build(cube, {criterion, true}, context).lights(7);
    const SquareLight& found = *std::max_element(lights.begin(), lights.end(),
                                                 [](const SquareLight& a, const SquareLight& b) { return a.radiance.x < b.radiance.x; });
    if (criterion == MergeOptions::Criterion::moments) {
      // Cuts large bright regions up, by design; together they are where the source is.
      Vec3 sum(0);
      for (const SquareLight& light : lights)
        sum += light.solid_angle() * light.radiance.x * (light.radiance.x > 10 ? light.center : Vec3(0));
      EXPECT_LT(glm::length(glm::normalize(sum) - truth), 0.5f * texel);
      continue;
    }
    EXPECT_LT(glm::length(found.center - truth), 0.5f * texel);
    EXPECT_NEAR(found.radius / std::sqrt(area / 2), 1, 0.05);
    EXPECT_NEAR(found.radiance.x, 50, 5);
  }
}

TEST(MergeTree, MomentsKeepCentroidAndSpread) {
  const LightCube cube = sky_cube(8);
  const Context context;
  const MergeTree tree = MergeTree::build(cube, {MergeOptions::Criterion::moments, true}, context);
  for (const std::int32_t top : tree.cut(40)) {
    const SquareLight& light = tree.nodes()[static_cast<std::size_t>(top)].light;
    std::vector<std::int32_t> open{top};
    Vec3d sum(0);
    double flux = 0, spread = 0;
    while (!open.empty()) {
      const std::int32_t id = open.back();
      const MergeNode& node = tree.nodes()[static_cast<std::size_t>(id)];
      open.pop_back();
      if (node.left >= 0) {
        open.push_back(node.left), open.push_back(node.right);
        continue;
      }
      const auto i = static_cast<std::size_t>(id);
      const double weight = static_cast<double>(cube.solid_angle(i)) * luminance(cube.texels[i]);
      const Vec3 offset = cube.center(i) - light.center;
      flux += weight, sum += weight * Vec3d(cube.center(i));
      spread += weight * (glm::dot(offset, offset) + cube.solid_angle(i) / 6);
    }
    EXPECT_NEAR(luminance(light.radiance) * light.solid_angle() / flux, 1, 1e-4);
    EXPECT_LT(glm::length(glm::normalize(sum) - Vec3d(light.center)), 1e-5);
    EXPECT_NEAR(light.radius * light.radius / 3 / (spread / flux), 1, 1e-4);
  }
}

TEST(MergeTree, MomentsTellSmoothTransportTheTruth) {
  // Irradiance of random normals, by squares whose cosine is averaged over them: fewer lights by moments than by the paper's criterion.
  const LightCube cube = sky_cube(16);
  const Context context;
  const auto error_of = [&](MergeOptions::Criterion criterion) {
    const std::vector<SquareLight> lights = MergeTree::build(cube, {criterion, true}, context).lights(30);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1, 1);
    double error = 0, total_square = 0;
    for (int k = 0; k < 60; ++k) {
      const Vec3 axis = glm::normalize(Vec3(unit(random), unit(random), unit(random)));
      const auto lobe = [&axis](const Vec3& d) { return std::exp(4 * (glm::dot(d, axis) - 1)); };
      double truth = 0, sum = 0;
      for (std::size_t i = 0; i < cube.count(); ++i)
        truth += static_cast<double>(cube.solid_angle(i)) * cube.texels[i].y * lobe(cube.center(i));
      for (const SquareLight& light : lights) {
        const Frame3 frame = frame_from_normal(light.center);
        double mean = 0;
        for (int j = 0; j < 36; ++j) {
          const Vec2 p = (Vec2(j % 6, j / 6) + 0.5f - 3.f) * (std::sqrt(2.f) * light.radius / 6);
          const float s = std::min(glm::dot(p, p), 4.f), k2 = std::sqrt(1 - s / 4);
          mean += lobe(frame.to_world({p.x * k2, p.y * k2, 1 - s / 2})) / 36;
        }
        sum += light.solid_angle() * light.radiance.y * mean;
      }
      error += (sum - truth) * (sum - truth), total_square += truth * truth;
    }
    return error / total_square;
  };
  const double by_moments = error_of(MergeOptions::Criterion::moments), by_paper = error_of(MergeOptions::Criterion::paper);
  EXPECT_LT(by_moments, 0.5 * by_paper);
  EXPECT_LT(by_moments, 1e-3);
}

/// Sum over regions and channels of flux² times mean squared distance from the centroid of luminance, from its definition.
double direction_error(const LightCube& cube, std::span<const std::uint32_t> region, std::size_t count) {
  std::vector<Vec3d> centroid(count, Vec3d(0));
  for (std::size_t t = 0; t < cube.count(); ++t)
    centroid[region[t]] += static_cast<double>(cube.solid_angle(t)) * luminance(cube.texels[t]) * Vec3d(cube.center(t));
  std::vector<glm::dvec3> flux(count, glm::dvec3(0)), spread(count, glm::dvec3(0));
  for (std::size_t t = 0; t < cube.count(); ++t) {
    const Vec3d offset = Vec3d(cube.center(t)) - glm::normalize(centroid[region[t]]);
    const glm::dvec3 own = static_cast<double>(cube.solid_angle(t)) * glm::dvec3(cube.texels[t]);
    flux[region[t]] += own, spread[region[t]] += own * (glm::dot(offset, offset) + cube.solid_angle(t) / 6);
  }
  double sum = 0;
  for (std::size_t r = 0; r < count; ++r) sum += glm::dot(glm::dvec3(0.3, 0.5, 0.2), flux[r] * spread[r]);
  return sum;
}

TEST(TexelExchange, LessensTheErrorAndKeepsAllLight) {
  const LightCube cube = sky_cube(16);
  const Context context;
  for (const auto criterion : kCriteria) {
    const MergeTree tree = MergeTree::build(cube, {criterion, true}, context);
    for (const std::size_t count : {std::size_t{7}, std::size_t{30}, std::size_t{200}}) {
      const TexelExchange exchange = exchange_texels(cube, tree, count);
      ASSERT_EQ(exchange.lights.size(), count);
      ASSERT_EQ(exchange.region.size(), cube.count());
      EXPECT_LT(exchange.after, exchange.before);
      EXPECT_NEAR(exchange.after / direction_error(cube, exchange.region, count), 1, 1e-4);  // centres of texels are floats
      EXPECT_GT(exchange.sweeps, 0);
      std::vector<int> size(count, 0);
      for (const std::uint32_t region : exchange.region) ++size.at(region);
      EXPECT_GT(*std::ranges::min_element(size), 0);
      Color sum(0);
      for (const SquareLight& light : exchange.lights) sum += light.solid_angle() * light.radiance;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / cube.integral()[c], 1, 1e-4);
    }
  }
}

// A cut through a bright patch that merging of faces cannot undo: two regions of one light each end up with a half of their own.
TEST(TexelExchange, FindsTheSidesOfTwoSources) {
  LightCube cube;
  cube.size = 8;
  cube.texels.assign(6 * 64, Color(0));
  std::vector<MergeNode> nodes(2 * cube.count() - 2);
  const std::vector<std::size_t> left{8 + 1, 8 + 2, 16 + 1, 16 + 2}, right{40 + 5, 40 + 6, 48 + 5, 48 + 6};
  for (const std::size_t t : left) cube.texels[t] = Color(1);
  for (const std::size_t t : right) cube.texels[t] = Color(1);
  // One region has all but a texel of the first face and the other five; the other that texel alone.
  std::size_t next = cube.count();
  std::int32_t top = 0;
  const std::size_t alone = right[0];
  for (std::size_t t = 1; t < cube.count(); ++t) {
    if (t == alone) continue;
    nodes[next].left = top, nodes[next].right = static_cast<std::int32_t>(t);
    top = static_cast<std::int32_t>(next++);
  }
  ASSERT_EQ(next, nodes.size());
  const TexelExchange exchange = exchange_texels(cube, MergeTree(nodes, cube.count()), 2);
  for (const std::size_t t : right) EXPECT_EQ(exchange.region[t], exchange.region[alone]);
  for (const std::size_t t : left) EXPECT_NE(exchange.region[t], exchange.region[alone]);
}

TEST(TexelExchange, OneTexelARegionStaysWhatItIs) {
  const LightCube cube = sky_cube(4);
  const Context context;
  const TexelExchange exchange = exchange_texels(cube, MergeTree::build(cube, {}, context), cube.count());
  EXPECT_EQ(exchange.before, exchange.after);
  for (std::size_t t = 0; t < cube.count(); ++t) EXPECT_LT(glm::length(exchange.lights[exchange.region[t]].center - cube.center(t)), 1e-6f);
}

TEST(TexelExchange, BlackMapsHaveBlackLights) {
  LightCube cube;
  cube.size = 4;
  cube.texels.assign(6 * 16, Color(0));
  const Context context;
  const TexelExchange exchange = exchange_texels(cube, MergeTree::build(cube, {}, context), 10);
  ASSERT_EQ(exchange.lights.size(), 10u);
  for (const SquareLight& light : exchange.lights) {
    EXPECT_EQ(light.radiance, Color(0));
    EXPECT_TRUE(std::isfinite(light.radius));
  }
}

TEST(MergeTree, BlackMapsMergeAllTheSame) {
  LightCube cube;
  cube.size = 4;
  cube.texels.assign(96, Color(0));
  const Context context;
  for (const auto criterion : kCriteria) {
    const MergeTree tree = MergeTree::build(cube, {criterion, true}, context);
    EXPECT_EQ(tree.cut(6).size(), 6u);
    for (const MergeNode& node : tree.nodes()) {
      EXPECT_TRUE(is_finite(node.light.center) && is_finite(node.light.radiance) && node.light.radius > 0);
      EXPECT_EQ(node.error, 0);
      EXPECT_NEAR(glm::length(node.light.center), 1, 1e-5f);
    }
  }
}

TEST(MergeTree, ForgettingTheAreaChangesTheOrder) {
  const LightCube cube = sky_cube(8);
  const Context context;
  const MergeTree with = MergeTree::build(cube, {MergeOptions::Criterion::paper, true}, context);
  const MergeTree without = MergeTree::build(cube, {MergeOptions::Criterion::paper, false}, context);
  bool differs = false;
  for (std::size_t i = with.texels(); i < with.nodes().size(); ++i) differs |= with.nodes()[i].left != without.nodes()[i].left;
  EXPECT_TRUE(differs);
  // J without the area is the plain squared difference.
  EXPECT_NEAR(without.nodes()[0].error * without.nodes()[0].solid_angle / with.nodes()[0].error, 1, 1e-4f);
}

}  // namespace
}  // namespace sightline::square_lights
