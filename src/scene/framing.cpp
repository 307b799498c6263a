#include "scene/scene.h"

namespace sightline {

Camera framing_camera(const Bounds& bounds) {
  constexpr float kFov = 40 * kPi / 180;
  const Vec3 center = bounds.is_empty() ? Vec3(0) : bounds.center();
  float radius = bounds.half_diagonal();
  if (!(radius > 0) || !std::isfinite(radius)) radius = 1;

  // The sphere around the box just touches the narrower side of the picture.
  const Vec3 backwards = glm::normalize(Vec3(1, 0.6f, 1));
  const float distance = radius / std::sin(kFov / 2);
  const Vec3 right = glm::normalize(glm::cross(Vec3(0, 1, 0), backwards));
  const Vec3 up = glm::cross(backwards, right);

  Camera camera;
  camera.name = "framing";
  camera.fov_axis = Camera::FovAxis::shorter;
  camera.fov_rad = kFov;
  camera.focal_distance = distance;
  camera.world_from_camera = Mat4(Vec4(right, 0), Vec4(up, 0), Vec4(backwards, 0), Vec4(center + distance * backwards, 1));
  return camera;
}

}  // namespace sightline
