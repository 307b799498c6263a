// Derivatives of rays against finite differences.
#include "methods/visibility_cache/ray_differential.h"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/methods_visibility_cache/eye_scenes.h"

namespace sightline {
namespace {

using namespace test;

std::vector<Camera> cameras() {
  Camera pinhole = camera_at({1, 2, 3}, {-2, 0.5f, 1}, 0.9f);
  Camera lens = pinhole;
  lens.lens_radius = 0.2f, lens.focal_distance = 3;
  Camera orthographic = pinhole;
  orthographic.projection = Camera::Projection::orthographic;
  // pbrt scales and mirrors whole worlds.
  Camera scaled = pinhole, scaled_lens = lens;
  for (Camera* camera : {&scaled, &scaled_lens}) {
    for (int axis = 0; axis < 3; ++axis) camera->world_from_camera[axis] *= axis == 0 ? -2.f : 2.f;
  }
  return {pinhole, lens, orthographic, scaled, scaled_lens};
}

TEST(CameraDifferential, IsTheDerivativeOfCameraRays) {
  int which = 0;
  for (const Camera& camera : cameras()) {
    SCOPED_TRACE(which++);
    const View view(camera, {40, 30}, PixelFilter(PixelFilter::Kind::centre));
    const CameraDifferential differential(view, 4);
    for (const Vec2& at : {Vec2(20, 15), Vec2(0.5f, 0.5f), Vec2(33, 21)}) {
      // The lens in polar form: its disk mapping is piecewise, but from centre to rim along an axis it is linear.
      Vec3 origin, direction;
      view.ray_through(at.x, at.y, {0.75f, 0.5f}, origin, direction);
      const auto moved = [&](const Vec2& by, float lens, Vec3& dp, Vec3& dd) {
        Vec3 o, d;
        view.ray_through(at.x + by.x, at.y + by.y, {0.75f + lens, 0.5f}, o, d);
        dp = o - origin, dd = d - direction;
      };
      Vec3 dp, dd;
      const RayDifferential pixel = differential.pixel(direction);
      const float h = 0.25f, spacing = 0.5f;
      moved({h, 0}, 0, dp, dd);
      EXPECT_LT(glm::length(dp / h * spacing - pixel.dp_dx), 1e-4f);
      EXPECT_LT(glm::length(dd / h * spacing - pixel.dd_dx), 0.02f * glm::length(pixel.dd_dx) + 1e-5f);
      moved({0, h}, 0, dp, dd);
      EXPECT_LT(glm::length(dp / h * spacing - pixel.dp_dy), 1e-4f);
      EXPECT_LT(glm::length(dd / h * spacing - pixel.dd_dy), 0.02f * glm::length(pixel.dd_dy) + 1e-5f);
      float area = pixel.cross_section(direction, 2.5f);
      if (differential.has_lens()) {
        const RayDifferential lens = differential.lens(direction);
        moved({0, 0}, 0.01f, dp, dd);
        // A step of 1/2 in the unit square goes from the centre to the rim.
        const float scale = 0.5f / 0.01f * std::sqrt(kPi / 4);
        EXPECT_LT(glm::length(scale * dp - lens.dp_dx), 0.01f * glm::length(lens.dp_dx));
        EXPECT_LT(glm::length(scale * dd - lens.dd_dx), 0.02f * glm::length(lens.dd_dx));
        area += lens.cross_section(direction, 2.5f);
      }
      EXPECT_NEAR(differential.cross_section(direction, 2.5f), area, 1e-4f * area);
    }
  }
}

// A surface z = curvature (x² + y²) / 2 at the origin, turned; rays near one another meet it.
struct Patch {
  float curvature;
  Vec3 normal_at(const Vec3& p) const { return glm::normalize(Vec3{-curvature * p.x, -curvature * p.y, 1}); }
};

TEST(RayDifferential, FollowsMirrorsAndGlassToFirstOrder) {
  std::mt19937 random(41);
  for (int k = 0; k < 200; ++k) {
    const Patch patch{random_point(random, 1).x};
    Vec3 direction = random_direction(random);
    if (std::fabs(direction.z) < 0.3f) continue;
    const float eta = k % 2 == 0 ? 1.5f : 1 / 1.5f;
    const RayDifferential start{random_point(random, 0.3f), random_point(random, 0.3f), random_point(random, 0.3f),
                                random_point(random, 0.3f)};
    // Unit directions change across themselves.
    RayDifferential before = start;
    for (Vec3* dd : {&before.dd_dx, &before.dd_dy}) *dd -= direction * glm::dot(direction, *dd);
    constexpr float t = 2;
    const Vec3 origin = -t * direction;

    SurfaceDetail detail;
    detail.dp_du = {2, 1, 0}, detail.dp_dv = {0.5f, 3, 0};
    detail.dn_du = -patch.curvature * detail.dp_du, detail.dn_dv = -patch.curvature * detail.dp_dv;
    const RayDifferential at_hit = before.transferred(direction, t, {0, 0, 1});
    const NormalChange change = normal_change(detail, at_hit);
    const Vec3 normal{0, 0, 1};
    const auto bend = [&](const Vec3& d, const Vec3& n, bool mirror) {
      const float side = glm::dot(d, n) < 0 ? 1.f : -1.f;
      return mirror ? glm::reflect(d, n) : glm::refract(d, side * n, 1 / eta);
    };
    for (const bool mirror : {true, false}) {
      const Vec3 out = bend(direction, normal, mirror);
      if (length_squared(out) == 0 || (!mirror && std::fabs(out.z) < 0.3f)) continue;
      const RayDifferential after =
          mirror ? reflected(at_hit, direction, normal, change) : refracted(at_hit, direction, out, normal, eta, change);
      // A ray one small step along x, met with the tangent plane: the patch leaves it by a second-order amount only.
      constexpr float h = 2e-3f;
      const Vec3 o = origin + h * before.dp_dx, d = glm::normalize(direction + h * before.dd_dx);
      const Vec3 hit = o - d * (o.z / d.z);
      const Vec3 measured = (bend(d, patch.normal_at(hit), mirror) - out) / h;
      EXPECT_LT(glm::length(after.dp_dx - hit / h), 0.02f) << k;
      EXPECT_LT(glm::length(after.dd_dx - measured), 0.02f + 0.02f * glm::length(measured)) << k << " " << mirror;
    }
  }
}

}  // namespace
}  // namespace sightline
