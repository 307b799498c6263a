// Cameras as scene files describe them.
#pragma once

#include <optional>
#include <string>

#include "base/math/vec.h"
#include "scene/ids.h"

namespace sightline {

/// Looks along -Z of its own space, +X right, +Y up.
struct Camera {
  enum class Projection { perspective, orthographic };
  /// Which axis `fov_rad` (or `ortho_height`) spans: pbrt's field of view is for the shorter side.
  enum class FovAxis { vertical, shorter, longer };

  std::string name;
  Projection projection = Projection::perspective;
  Mat4 world_from_camera{1};  ///< may mirror (pbrt's left-handed worlds)
  FovAxis fov_axis = FovAxis::vertical;
  float fov_rad = 0.9f;
  float ortho_height = 2;                        ///< world units spanned by the picture's height (or by fov_axis)
  float lens_radius = 0, focal_distance = 1e6f;  ///< thin lens; 0 = pinhole
  /// Part of the image plane that is rendered, in units of the half field: (-1,-1)-(1,1) = all (pbrt screenwindow); empty = from fov.
  std::optional<Vec4> screen_window;
  NodeId node;
};

}  // namespace sightline
