#include "bench/square_lights/motion.h"

#include <glm/gtc/matrix_transform.hpp>

namespace sightline {

Mat3 turned_about(const Vec3& axis, float angle_rad) { return Mat3(glm::rotate(Mat4(1), angle_rad, glm::normalize(axis))); }

Camera orbited(const Camera& camera, const Vec3& center, float angle_rad) {
  Camera moved = camera;
  const Mat4 to = glm::translate(Mat4(1), center), from = glm::translate(Mat4(1), -center);
  moved.world_from_camera = to * Mat4(turned_about(Vec3(0, 1, 0), angle_rad)) * from * camera.world_from_camera;
  return moved;
}

Camera rotated(const Camera& camera, const Mat3& rotation) {
  Camera moved = camera;
  moved.world_from_camera = Mat4(rotation) * camera.world_from_camera;
  return moved;
}

}  // namespace sightline
