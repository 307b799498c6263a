#include "film/view.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "base/sample/warp.h"
#include "film/pinhole_rays.h"

namespace sightline {
namespace {

// Half extents of the image plane at depth 1 (perspective) or in world units (orthographic).
Vec2 half_extent(const Camera& camera, IVec2 size) {
  const float half = camera.projection == Camera::Projection::perspective ? std::tan(0.5f * camera.fov_rad) : 0.5f * camera.ortho_height;
  const float aspect = static_cast<float>(size.x) / static_cast<float>(size.y);
  bool vertical = true;
  if (camera.fov_axis == Camera::FovAxis::shorter) vertical = aspect >= 1;
  if (camera.fov_axis == Camera::FovAxis::longer) vertical = aspect < 1;
  return vertical ? Vec2(half * aspect, half) : Vec2(half, half / aspect);
}

}  // namespace

View::View(const Camera& camera, IVec2 size_px, PixelFilter filter) : camera_(camera), size_px_(size_px), filter_(filter) {
  const Vec2 half = half_extent(camera, size_px);
  Vec2 lower = -half, upper = half;
  if (camera.screen_window) {
    // pbrt's window is in units in which the shorter side spans [-1, 1].
    const float unit = std::min(half.x, half.y);
    lower = unit * Vec2(camera.screen_window->x, camera.screen_window->y);
    upper = unit * Vec2(camera.screen_window->z, camera.screen_window->w);
  }
  plane_origin_ = {lower.x, upper.y};
  plane_step_ = {(upper.x - lower.x) / static_cast<float>(size_px.x), (lower.y - upper.y) / static_cast<float>(size_px.y)};
  const Mat4& m = camera.world_from_camera;
  axis_x_ = Vec3(m[0]), axis_y_ = Vec3(m[1]), axis_z_ = Vec3(m[2]), position_ = Vec3(m[3]);
  if (camera.projection == Camera::Projection::perspective)
    cone_spread_ = std::fabs(plane_step_.y);
  else
    cone_width_ = std::fabs(plane_step_.y) * glm::length(axis_y_);
}

void View::ray_through(float x, float y, Vec2 lens, Vec3& origin, Vec3& direction) const {
  const float px = plane_origin_.x + x * plane_step_.x, py = plane_origin_.y + y * plane_step_.y;
  if (camera_.projection == Camera::Projection::orthographic) {
    origin = position_ + px * axis_x_ + py * axis_y_;
    direction = glm::normalize(-axis_z_);
    return;
  }
  origin = position_;
  if (!has_lens()) {
    direction = glm::normalize(px * axis_x_ + py * axis_y_ - axis_z_);
    return;
  }
  // Thin lens: all rays through a point of the focal plane meet there.
  const Vec2 on_lens = camera_.lens_radius * sample_concentric_disk(lens);
  origin = position_ + on_lens.x * axis_x_ + on_lens.y * axis_y_;
  const Vec3 focus = position_ + camera_.focal_distance * (px * axis_x_ + py * axis_y_ - axis_z_);
  direction = glm::normalize(focus - origin);
}

PinholeRays View::pinhole() const {
  const bool orthographic = camera_.projection == Camera::Projection::orthographic;
  PinholeRays rays;
  rays.orthographic = orthographic;
  rays.step_x = plane_step_.x * axis_x_;
  rays.step_y = plane_step_.y * axis_y_;
  rays.origin = plane_origin_.x * axis_x_ + plane_origin_.y * axis_y_ + (orthographic ? position_ : -axis_z_);
  rays.position = orthographic ? glm::normalize(-axis_z_) : position_;
  rays.width = static_cast<std::uint32_t>(size_px_.x);
  rays.filter_table = filter_.table();
  return rays;
}

void View::primary_rays(const std::uint32_t* pixels, const float* fx, const float* fy, const float* lu, const float* lv, std::size_t count,
                        const CameraRays& rays) const {
  if (!has_lens()) {
    pinhole_rays(pinhole(), pixels, fx, fy, count, rays);
    return;
  }
  const std::uint32_t width = static_cast<std::uint32_t>(size_px_.x);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t column = pixels[i] % width, row = pixels[i] / width;
    const float x = static_cast<float>(column) + 0.5f + filter_.offset(fx[i]);
    const float y = static_cast<float>(row) + 0.5f + filter_.offset(fy[i]);
    Vec3 origin, direction;
    ray_through(x, y, Vec2(lu[i], lv[i]), origin, direction);
    rays.ox[i] = origin.x, rays.oy[i] = origin.y, rays.oz[i] = origin.z;
    rays.dx[i] = direction.x, rays.dy[i] = direction.y, rays.dz[i] = direction.z;
  }
}

Mat4 View::ndc_from_world() const {
  const Vec2 corner = plane_origin_ + plane_step_ * Vec2(size_px_);
  const float near_z = 0.01f, far_z = 1e4f;
  const Mat4 projection =
      camera_.projection == Camera::Projection::perspective
          ? glm::frustum(plane_origin_.x * near_z, corner.x * near_z, corner.y * near_z, plane_origin_.y * near_z, near_z, far_z)
          : glm::ortho(plane_origin_.x, corner.x, corner.y, plane_origin_.y, near_z, far_z);
  return projection * glm::inverse(camera_.world_from_camera);
}

}  // namespace sightline
