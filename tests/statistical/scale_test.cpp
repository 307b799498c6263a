// Nothing depends on the unit of length: no epsilon hides in the renderer.
#include <gtest/gtest.h>

#include "scene/builtin/parts.h"
#include "support/studio.h"

namespace sightline::test {
namespace {

Scene ball_on_plane() {
  Scene scene;
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}).build("floor"),
                    builtin::add_diffuse(scene, "floor", Color(0.7f)));
  builtin::add_sphere(scene, "ball", {0, 1, 0}, 1, builtin::add_diffuse(scene, "ball", Color(0.8f, 0.5f, 0.3f)));
  scene.lights.push_back({.name = "point", .shape = PointLight{.position = {2, 4, 3}, .intensity = Color(30)}, .node = {}});
  scene.lights.push_back({.name = "disk",
                          .shape = DiskLight{.center = {-3, 4, 1}, .half_u = {0.5f, 0, 0}, .half_v = {0, 0, 0.5f}, .radiance = Color(20)},
                          .node = {}});
  scene.environment = Environment{};
  scene.environment->scale = Color(0.2f, 0.3f, 0.4f);
  builtin::add_camera(scene, {3, 2.5f, 5}, {0, 0.8f, 0}, 40);
  return scene;
}

std::vector<std::pair<std::string, Scene>> scenes() {
  return {{"cornell", builtin_scene("cornell")}, {"ball on plane", ball_on_plane()}, {"glass", builtin_scene("glass")}};
}

constexpr IVec2 kSize{48, 48};
const Exposure kExposure{.spp = 8, .max_bounces = 3, .filter = PixelFilter::Kind::gaussian};

TEST(Scale, PowersOfTwoGiveTheSameBits) {
  // Multiplying by a power of two rounds nothing, so every comparison comes out alike unless something compares with a fixed length.
  for (const auto& [name, scene] : scenes()) {
    const Picture unit = expose(shot_of(scene, kSize), kExposure);
    for (const float factor : {0x1p-10f, 0x1p13f, 0x1p23f}) {
      const Picture other = expose(shot_of(scaled(scene, factor), kSize), kExposure);
      int different = 0;
      for (std::uint32_t pixel = 0; pixel < kSize.x * kSize.y; ++pixel) different += unit.frame.color(pixel) != other.frame.color(pixel);
      EXPECT_EQ(different, 0) << name << " times " << factor;
    }
  }
}

TEST(Scale, OtherFactorsGiveTheSamePictureButForRounding) {
  for (const auto& [name, scene] : scenes()) {
    const Picture unit = expose(shot_of(scene, kSize), kExposure);
    for (const float factor : {1e-3f, 1e4f, 1e7f}) {
      const Picture other = expose(shot_of(scaled(scene, factor), kSize), kExposure);
      // Coordinates differ by 6e-8 of the scene, which shifts radiance by about as little, unless a path hits the other side of an edge.
      // A path passes about 10 edges within that distance of which hardly any matters: one pixel in a hundred is generous.
      int different = 0;
      for (std::uint32_t pixel = 0; pixel < kSize.x * kSize.y; ++pixel) {
        const Vec3 a = unit.frame.color(pixel), b = other.frame.color(pixel);
        different += glm::length(a - b) > 1e-3f * glm::length(a) + 1e-5f;
      }
      EXPECT_LE(different, kSize.x * kSize.y / 100) << name << " times " << factor;
      EXPECT_NEAR(other.frame.mean_luminance(), unit.frame.mean_luminance(), 1e-3 * unit.frame.mean_luminance()) << name << factor;
    }
  }
}

}  // namespace
}  // namespace sightline::test
