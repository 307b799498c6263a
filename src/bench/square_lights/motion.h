// What moves from frame to frame: functions of the frame alone.
#pragma once

#include "base/math/bounds.h"
#include "scene/camera.h"

namespace sightline {

/// A turn about an axis.
Mat3 turned_about(const Vec3& axis, float angle_rad);
/// Camera carried about the vertical line through `center`, looking the same way relative to it.
Camera orbited(const Camera& camera, const Vec3& center, float angle_rad);
/// Camera moved by a rotation about the origin.
Camera rotated(const Camera& camera, const Mat3& rotation);

/// Degrees a frame of the environment and of the camera in the measurements of speed.
inline constexpr float kLightStepDeg = 3, kCameraStepDeg = 2;

}  // namespace sightline
