// Form factors of polygons against closed forms of radiative heat transfer, cuts, sums and limits.
#include "shade/analytic/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

const Vec3 kStraightUp{0, 0, 1};

/// From a point to a parallel a x b rectangle at distance c, one corner straight above the point.
double corner_form_factor(double a, double b, double c) {
  const double x = a / c, y = b / c, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * std::numbers::pi);
}

/// A ceiling over [x0, x1] x [y0, y1] that emits downwards.
std::vector<Vec3> ceiling(float x0, float x1, float y0, float y1, float z) { return {{x0, y0, z}, {x0, y1, z}, {x1, y1, z}, {x1, y0, z}}; }
/// A wall at x over y and z that emits towards smaller x.
std::vector<Vec3> wall(float x, float y0, float y1, float z0, float z1) { return {{x, y0, z0}, {x, y0, z1}, {x, y1, z1}, {x, y1, z0}}; }

/// Midpoint sum over a parallelogram, horizon included.
double summed(const Vec3d& corner, const Vec3d& e1, const Vec3d& e2, const Vec3d& position, const Vec3d& normal, int steps) {
  const Vec3d area = glm::cross(e1, e2);
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const Vec3d d = corner + (i + 0.5) / steps * e1 + (j + 0.5) / steps * e2 - position;
      const double squared = glm::dot(d, d);
      sum += std::max(0.0, glm::dot(d, normal)) * std::max(0.0, -glm::dot(d, area)) / (squared * squared);
    }
  }
  return sum / (std::numbers::pi * steps * steps);
}

TEST(PolygonIrradiance, ParallelRectangleOverItsCornerIsTheClosedForm) {
  for (const float a : {0.01f, 0.5f, 3.f, 200.f})
    for (const float b : {0.1f, 1.f, 50.f})
      EXPECT_NEAR(polygon_irradiance(ceiling(0, a, 0, b, 1.5f), Vec3(0), kStraightUp), corner_form_factor(a, b, 1.5), 1e-7);
}

TEST(PolygonIrradiance, PerpendicularRectangleIsTheClosedForm) {
  // Wall of width b and height a, at distance c in front of the point, from its corner on.
  for (const float a : {0.2f, 1.f, 30.f}) {
    for (const float b : {0.3f, 2.f}) {
      const double c = 0.75, x = a / b, y = c / b, r = std::sqrt(x * x + y * y);
      const double truth = (std::atan(1 / y) - y / r * std::atan(1 / r)) / (2 * std::numbers::pi);
      EXPECT_NEAR(polygon_irradiance(wall(0.75f, 0, b, 0, a), Vec3(0), kStraightUp), truth, 1e-7);
    }
  }
}

TEST(PolygonIrradiance, WhatIsBelowTheHorizonCountsNothing) {
  const double above = polygon_irradiance(wall(0.75f, -1, 2, 0, 1), Vec3(0), kStraightUp);
  EXPECT_NEAR(polygon_irradiance(wall(0.75f, -1, 2, -5, 1), Vec3(0), kStraightUp), above, 1e-7);
  EXPECT_EQ(polygon_irradiance(wall(0.75f, -1, 2, -5, -1), Vec3(0), kStraightUp), 0);
  // A floor that only touches the horizon, seen from within its plane, and one below.
  EXPECT_EQ(polygon_irradiance(ceiling(1, 2, 0, 1, 0), Vec3(0), kStraightUp), 0);
  EXPECT_EQ(polygon_irradiance(ceiling(-1, 2, -1, 1, -1), Vec3(0), kStraightUp, EmitterSides::two), 0);
}

TEST(PolygonIrradiance, TiltedAndCutRectanglesAgreeWithSums) {
  const Vec3d corner(-0.4, 0.7, -0.5), e1(1.1, 0.3, 0.2), e2(-0.2, 0.4, 1.6);
  const std::vector<Vec3> polygon{corner, corner + e1, corner + e1 + e2, corner + e2};
  for (const Vec3d& n : {Vec3d(0, 0, 1), Vec3d(0.6, 0, 0.8), Vec3d(-0.48, 0.6, 0.64), Vec3d(0, 1, 0), Vec3d(0, -0.6, 0.8)}) {
    for (const Vec3d& p : {Vec3d(0), Vec3d(0.3, -1, 0.4), Vec3d(-2, 2, 0.1)}) {
      const double both = summed(corner, e1, e2, p, n, 400) + summed(corner, e2, e1, p, n, 400);
      EXPECT_NEAR(polygon_irradiance(polygon, Vec3(p), Vec3(n), EmitterSides::two), both, 2e-5);
    }
  }
}

TEST(PolygonIrradiance, EmissionIsOneSidedOrTwo) {
  std::vector<Vec3> polygon = ceiling(-1, 1, -1, 1, 2);
  const double truth = 4 * corner_form_factor(1, 1, 2);
  EXPECT_NEAR(polygon_irradiance(polygon, Vec3(0), kStraightUp), truth, 1e-7);
  std::reverse(polygon.begin(), polygon.end());
  EXPECT_EQ(polygon_irradiance(polygon, Vec3(0), kStraightUp), 0);
  EXPECT_NEAR(polygon_irradiance(polygon, Vec3(0), kStraightUp, EmitterSides::two), truth, 1e-7);
}

TEST(PolygonIrradiance, PartsAddUpToTheWhole) {
  const std::vector<Vec3> pentagon{{1, -1, -0.4f}, {1, -1.2f, 0.5f}, {1, 0.1f, 1.4f}, {1, 1.1f, 0.6f}, {1, 0.8f, -0.6f}};
  const std::vector<Vec3> left{pentagon[0], pentagon[1], pentagon[2]}, right{pentagon[0], pentagon[2], pentagon[3], pentagon[4]};
  for (const Vec3& n : {kStraightUp, Vec3(0.8f, 0, 0.6f), Vec3(-0.6f, 0.64f, 0.48f)}) {
    const double whole = polygon_irradiance(pentagon, Vec3(0.2f, 0.1f, 0), n);
    EXPECT_GT(whole, 0.001);
    EXPECT_NEAR(polygon_irradiance(left, Vec3(0.2f, 0.1f, 0), n) + polygon_irradiance(right, Vec3(0.2f, 0.1f, 0), n), whole, 1e-6);
  }
}

TEST(PolygonIrradiance, SkyFilledByTheEmitterGivesOne) {
  EXPECT_NEAR(polygon_irradiance(ceiling(-1e5f, 1e5f, -1e5f, 1e5f, 1), Vec3(0), kStraightUp), 1, 1e-6);
}

TEST(PolygonIrradiance, DegeneratePolygonsAreDark) {
  const std::vector<Vec3> line{{1, 0, 0}, {1, 0, 1}, {1, 0, 2}}, point(3, Vec3(1, 0, 1)), none;
  for (const auto& polygon : {line, point, none}) EXPECT_EQ(polygon_irradiance(polygon, Vec3(0), kStraightUp, EmitterSides::two), 0);
}

TEST(DiskPolygon, ParallelDiskIsTheClosedFormToWithinItsBound) {
  // Point at distance `aside` from the axis of a disk of radius 1 that lies `height` above.
  const auto truth = [](double height, double aside) {
    const double sum = 1 + height * height + aside * aside;
    return 0.5 * (1 - (sum - 2) / std::sqrt(sum * sum - 4 * aside * aside));
  };
  const auto worst = [&](std::size_t corners, double least_distance) {
    const std::vector<Vec3> disk = disk_polygon({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, corners);
    double error = 0;
    for (const double height : {0.03, 0.1, 0.3, 1.0, 5.0}) {
      for (double aside = 0; aside < 3; aside += 0.05) {
        if (std::hypot(aside - 1, height) < least_distance) continue;
        for (const double turn : {0.0, 0.5 / static_cast<double>(corners), 0.3 / static_cast<double>(corners)}) {
          const double phi = 2 * std::numbers::pi * turn;
          const Vec3 position(aside * std::cos(phi), aside * std::sin(phi), -height);
          error = std::max(error, std::fabs(polygon_irradiance(disk, position, kStraightUp) - truth(height, aside)));
        }
      }
    }
    return error;
  };
  EXPECT_LT(worst(64, 0.1), 1e-4);
  EXPECT_LT(worst(16, 0.33), 1e-3);
}

TEST(FlatLightPolygon, NormalIsTheEmittingSide) {
  FlatLight light;
  light.origin = {0, 0, 2}, light.e1 = {1, 0, 0}, light.e2 = {0, 1, 0}, light.normal = {0, 0, -1};
  for (const std::uint32_t flags :
       {0u, static_cast<std::uint32_t>(FlatEmitter::kTriangle), static_cast<std::uint32_t>(FlatEmitter::kDisk)}) {
    FlatEmitter emitter;
    emitter.flags = flags;
    light.normal.z = -1;
    EXPECT_GT(polygon_irradiance(flat_light_polygon(light, emitter), Vec3(0.2f, 0.3f, 0), kStraightUp), 0.01);
    light.normal.z = 1;
    EXPECT_EQ(polygon_irradiance(flat_light_polygon(light, emitter), Vec3(0.2f, 0.3f, 0), kStraightUp), 0);
  }
}

}  // namespace
}  // namespace sightline
