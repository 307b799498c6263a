#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>

#include "methods/square_lights/texel_visibility.h"
#include "scene/scene.h"
#include "texture/texture_set.h"

namespace sightline::square_lights {
namespace {

/// One big triangle in the plane x = 1, and nothing else.
std::unique_ptr<Tracer> wall(const Context& context) {
  static Scene scene = [] {
    Scene s;
    Mesh mesh;
    mesh.positions = std::vector<Vec3>{{1, -1e4f, -1e4f}, {1, 1e4f, -1e4f}, {1, 0, 1e4f}};
    mesh.triangles = std::vector<UVec3>{{0, 1, 2}};
    for (const Vec3& p : mesh.positions) mesh.bounds.add(p);
    s.meshes.push_back(mesh);
    s.instances.push_back({.mesh = MeshId(std::size_t{0})});
    return s;
  }();
  return make_brute_tracer(scene, TextureSet(), {}, context);
}

TEST(TexelVisibility, PointsCoverTheSphere) {
  const TexelDirections directions = texel_directions(8, Mat3(1));
  double sum = 0;
  for (std::size_t i = 0; i < directions.texels * kTexelPoints; ++i) sum += double{directions.solid_angle[i]};
  EXPECT_NEAR(sum, 4 * double{kPi}, 1e-4);
}

TEST(TexelVisibility, BitsSayWhatRaysMeet) {
  Context context;
  const TexelDirections directions = texel_directions(8, Mat3(1));
  const std::array<Vec3, 1> position{Vec3(0)}, up{Vec3(0, 1, 0)};
  const std::array<float, 1> error{0};
  RayCounts rays;
  const auto masks = trace_texels(*wall(context), position, up, up, error, directions, rays, context);
  for (std::size_t t = 0; t < directions.texels; ++t) {
    for (std::size_t k = 0; k < kTexelPoints; ++k) {
      const std::size_t at = t * kTexelPoints + k;
      const Vec3 d(directions.direction.x[at], directions.direction.y[at], directions.direction.z[at]);
      // Far along the wall the triangle ends; those few are not judged.
      if (d.x > 0 && d.x < 0.01f) continue;
      EXPECT_EQ((masks[t] >> k & 1) != 0, d.y > 0 && d.x <= 0) << t << ' ' << k;
    }
  }
  EXPECT_EQ(rays.occlusion, directions.texels * kTexelPoints / 2);
}

TEST(TexelVisibility, TransportOfLambertAddsUpToTheVisibleShareOfTheHemisphere) {
  Context context;
  const TexelDirections directions = texel_directions(16, Mat3(1));
  const std::array<Vec3, 1> position{Vec3(0)}, up{Vec3(0, 1, 0)};
  const std::array<float, 1> error{0};
  RayCounts rays;
  const auto masks = trace_texels(*wall(context), position, up, up, error, directions, rays, context);
  std::vector<Color> transport(directions.texels);
  texel_transport(masks, directions, Bsdf(Lambert(Color(0.8f))), frame_from_normal({0, 1, 0}), {0, 1, 0}, transport);
  LightCube cube;
  cube.size = 16, cube.texels.assign(directions.texels, Color(1));
  double sum = 0;
  for (std::size_t t = 0; t < transport.size(); ++t) sum += double{cube.solid_angle(t)} * double{transport[t].x};
  EXPECT_NEAR(sum, 0.8 * 0.5, 2e-3);
}

}  // namespace
}  // namespace sightline::square_lights
