#include "methods/bidirectional/camera.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/sample/warp.h"

namespace sightline::bidirectional {
namespace {

constexpr std::size_t kGuideSteps = 512;

}  // namespace

CameraImportance::CameraImportance(const View& view)
    : width_(view.width()),
      height_(view.height()),
      orthographic_(view.camera().projection == Camera::Projection::orthographic),
      lens_radius_(orthographic_ ? 0.f : view.camera().lens_radius),
      focal_distance_(view.camera().focal_distance),
      position_(view.camera().world_from_camera[3]),
      axis_x_(view.camera().world_from_camera[0]),
      axis_y_(view.camera().world_from_camera[1]) {
  const PinholeRays rays = view.pinhole();
  plane_ = {rays.step_x, rays.step_y, rays.origin};
  if (orthographic_) {
    view_direction_ = rays.position;
    determinant_ = std::fabs(glm::dot(Vec3d(view_direction_), glm::cross(Vec3d(plane_.x), Vec3d(plane_.y))));
  }
  if (view.filter().kind() == PixelFilter::Kind::centre) return;
  filter_.assign(view.filter().table(), view.filter().table() + PixelFilter::kEntries + 1);
  for (std::size_t step = 0; step < kGuideSteps; ++step) {
    const float offset = filter_.front() + (filter_.back() - filter_.front()) * static_cast<float>(step) / kGuideSteps;
    const auto above = std::upper_bound(filter_.begin(), filter_.end(), offset);
    filter_guide_.push_back(static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(0, above - filter_.begin() - 1)));
  }
}

Vec3 CameraImportance::lens_point(const Vec2& u) const {
  if (!(lens_radius_ > 0)) return position_;
  const Vec2 p = lens_radius_ * sample_concentric_disk(u);
  return position_ + p.x * axis_x_ + p.y * axis_y_;
}

// All rays through a point of the focal plane meet there: from a point of the lens the film is seen through a plane at that distance.
CameraImportance::Plane CameraImportance::plane_from(const Vec3& lens_point) const {
  if (!(lens_radius_ > 0)) return plane_;
  return {focal_distance_ * plane_.x, focal_distance_ * plane_.y, focal_distance_ * plane_.origin - (lens_point - position_)};
}

// With d = origin + x X + y Y: dw = |det(X, Y, d)| / |d|³ dx dy, and det(X, Y, d) = det(X, Y, origin).
double CameraImportance::pdf(const Vec3& origin, const Vec3& direction) const {
  const double film = static_cast<double>(width_) * height_;
  if (orthographic_) return 1 / (determinant_ * film);
  const Plane plane = plane_from(origin);
  const Vec3d normal = glm::cross(Vec3d(plane.x), Vec3d(plane.y));
  const double determinant = glm::dot(normal, Vec3d(plane.origin));
  // |d| along the unit direction.
  const double length = determinant / glm::dot(normal, Vec3d(direction));
  return length > 0 ? length * length * length / (std::fabs(determinant) * film) : 0.0;
}

std::optional<CameraImportance::Projection> CameraImportance::project(const Vec3& lens_point, const Vec3& point) const {
  Projection p;
  const Plane plane = plane_from(lens_point);
  const Vec3d x(plane.x), y(plane.y), o(plane.origin), normal = glm::cross(x, y);
  if (orthographic_) {
    // point = o + film.x x + film.y y + distance direction.
    const Vec3d rest = Vec3d(point) - o, d(view_direction_);
    const double determinant = glm::dot(normal, d);
    p.distance = static_cast<float>(glm::dot(normal, rest) / determinant);
    p.film = {static_cast<float>(glm::dot(glm::cross(y, d), rest) / determinant),
              static_cast<float>(glm::dot(glm::cross(d, x), rest) / determinant)};
    p.direction = view_direction_;
    p.origin = point - p.distance * view_direction_;
    if (!(p.distance > 0)) return std::nullopt;
  } else {
    const Vec3d towards = Vec3d(point) - Vec3d(lens_point);
    const double scale = glm::dot(normal, towards) / glm::dot(normal, o);  // towards = scale (o + film.x x + film.y y)
    if (!(scale > 0)) return std::nullopt;
    p.film = {static_cast<float>(glm::dot(glm::cross(y, o), towards) / (glm::dot(normal, o) * scale)),
              static_cast<float>(glm::dot(glm::cross(o, x), towards) / (glm::dot(normal, o) * scale))};
    p.distance = static_cast<float>(glm::length(towards));
    p.direction = Vec3(towards / glm::length(towards));
    p.origin = lens_point;
  }
  const float reach = filter_.empty() ? 0.f : filter_.back();
  if (!(p.film.x > -reach && p.film.x < static_cast<float>(width_) + reach && p.film.y > -reach &&
        p.film.y < static_cast<float>(height_) + reach))
    return std::nullopt;
  p.pdf = pdf(p.origin, p.direction);
  return p;
}

float CameraImportance::filter_density(float offset) const {
  if (!(offset >= filter_.front() && offset < filter_.back())) return 0;
  const float share = (offset - filter_.front()) / (filter_.back() - filter_.front());
  std::size_t bin = filter_guide_[std::min(kGuideSteps - 1, static_cast<std::size_t>(share * kGuideSteps))];
  while (bin > 0 && filter_[bin] > offset) --bin;
  while (bin + 2 < filter_.size() && filter_[bin + 1] <= offset) ++bin;
  const float width = filter_[bin + 1] - filter_[bin];
  return width > 0 ? 1 / (static_cast<float>(filter_.size() - 1) * width) : 0.f;
}

int CameraImportance::shares(const Vec2& film, Share* out) const {
  if (filter_.empty()) return 0;
  constexpr int kSide = 4;
  static_assert(kSide * kSide <= kMaxShares);
  // The filter is a product: columns and rows by themselves.
  const float reach = filter_.back();
  const int x0 = static_cast<int>(std::ceil(film.x - 0.5f - reach)), y0 = static_cast<int>(std::ceil(film.y - 0.5f - reach));
  std::array<float, kSide> columns;
  for (int x = 0; x < kSide; ++x) {
    const bool inside = x0 + x >= 0 && x0 + x < width_;
    columns[static_cast<std::size_t>(x)] = inside ? filter_density(film.x - 0.5f - static_cast<float>(x0 + x)) : 0.f;
  }
  int count = 0;
  for (int y = std::max(0, y0); y < std::min(height_, y0 + kSide); ++y) {
    const float row = filter_density(film.y - 0.5f - static_cast<float>(y));
    if (!(row > 0)) continue;
    for (int x = 0; x < kSide; ++x) {
      const float weight = row * columns[static_cast<std::size_t>(x)];
      if (weight > 0) out[count++] = {static_cast<std::uint32_t>(y * width_ + x0 + x), weight};
    }
  }
  return count;
}

}  // namespace sightline::bidirectional
