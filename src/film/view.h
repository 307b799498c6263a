// A camera with a size in pixels: turns pixels and random numbers into primary rays.
#pragma once

#include <cstdint>
#include <span>

#include "base/core/aligned.h"
#include "base/math/vec.h"
#include "film/pixel_filter.h"
#include "scene/camera.h"

namespace sightline {

/// Camera rays as a structure of arrays, as View fills it.
struct CameraRays {
  float *ox, *oy, *oz, *dx, *dy, *dz;
};

/// An affine picture plane: perspective rays start at `position` towards origin + x step_x + y step_y; orthographic ones start there and
/// go along `position`. (x, y) is in pixels from the top left corner.
struct PinholeRays {
  Vec3 origin, step_x, step_y, position;
  bool orthographic;
  std::uint32_t width;
  const float* filter_table;  ///< PixelFilter::table()
};

/// Immutable.
class View {
 public:
  View(const Camera& camera, IVec2 size_px, PixelFilter filter);

  int width() const { return size_px_.x; }
  int height() const { return size_px_.y; }
  std::uint32_t pixel_count() const { return static_cast<std::uint32_t>(size_px_.x) * static_cast<std::uint32_t>(size_px_.y); }
  const Camera& camera() const { return camera_; }
  const PixelFilter& filter() const { return filter_; }
  bool has_lens() const { return camera_.lens_radius > 0; }

  /// Unit directions and origins for `count` pixels (index y * width + x), with offsets `fx`, `fy` in [0,1) through the pixel filter and
  /// lens numbers `lu`, `lv` (ignored by pinholes). Arrays are aligned and padded to kLanes.
  void primary_rays(const std::uint32_t* pixels, const float* fx, const float* fy, const float* lu, const float* lv, std::size_t count,
                    const CameraRays& rays) const;
  /// The scalar definition: origin and unit direction through picture position (x, y) in pixels from the top left corner.
  void ray_through(float x, float y, Vec2 lens, Vec3& origin, Vec3& direction) const;

  /// The picture plane, for loops that make rays themselves; no lens.
  PinholeRays pinhole() const;

  /// Width of a pixel's ray cone: diameter at the lens, and growth per unit length on the axis.
  float cone_width() const { return cone_width_; }
  float cone_spread() const { return cone_spread_; }
  Mat4 world_from_camera() const { return camera_.world_from_camera; }
  /// Projects world points to clip space, for the EXR header (worldToNDC).
  Mat4 ndc_from_world() const;

 private:
  Camera camera_;
  IVec2 size_px_;
  PixelFilter filter_;
  // Picture position (x, y) maps to the image plane point base + x * step_x + y * step_y, in camera space at depth 1 (perspective) or as
  // the ray's origin (orthographic).
  Vec2 plane_origin_, plane_step_;
  Vec3 axis_x_, axis_y_, axis_z_, position_;
  float cone_width_ = 0, cone_spread_ = 0;
};

}  // namespace sightline
