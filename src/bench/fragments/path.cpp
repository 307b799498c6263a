#include "bench/fragments/path.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace sightline {

float path_scale(const BuiltView& view) {
  constexpr float kCourtHalfDiagonal = 20;
  return view.name == "sponza-court" ? 1 : view.world->bounds().half_diagonal() / kCourtHalfDiagonal;
}

CourtWalk court_walk(int frame, int frames) {
  constexpr float kLength = 8, kSway = 0.5f, kLightReach = 6, kTurn = 0.2f;
  const float t = static_cast<float>(frame) / static_cast<float>(std::max(1, frames - 1));
  const float around = 2 * kPi * t;
  CourtWalk walk;
  walk.forward = kLength * t;
  walk.side = kSway * std::sin(2 * around);
  walk.turn_rad = kTurn * std::sin(around);
  walk.light_x = kLightReach * std::sin(around);
  return walk;
}

Camera walked(const Camera& camera, const CourtWalk& walk, float scale) {
  const Mat4& m = camera.world_from_camera;
  const Vec3 back(m[2]);
  // Along the ground, unless the camera looks straight up or down.
  const Vec3 flat(-back.x, 0, -back.z);
  const Vec3 forward = glm::length(flat) > 1e-3f * glm::length(back) ? glm::normalize(flat) : Vec3(0);
  const Vec3 right(-forward.z, 0, forward.x);
  const float c = std::cos(walk.turn_rad), s = std::sin(walk.turn_rad);
  const auto turned = [&](const Vec4& v) { return Vec4(c * v.x + s * v.z, v.y, c * v.z - s * v.x, v.w); };
  Camera moved = camera;
  for (int axis = 0; axis < 3; ++axis) moved.world_from_camera[axis] = turned(m[axis]);
  moved.world_from_camera[3] = m[3] + Vec4(scale * (walk.forward * forward + walk.side * right + Vec3(0, walk.up, 0)), 0);
  return moved;
}

bool move_lights(Scene& scene, const CourtWalk& walk, float scale) {
  bool any = false;
  for (Light& light : scene.lights) {
    if (auto* rectangle = std::get_if<RectangleLight>(&light.shape)) rectangle->center.x += scale * walk.light_x, any = true;
  }
  return any;
}

}  // namespace sightline
