#include "shade/analytic/polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shade/analytic/polygon_plane.h"

namespace sightline {

namespace {

/// The part of a polygon with z >= 0 [Sutherland1974].
std::vector<Vec3d> clip_to_horizon(std::span<const Vec3d> polygon) {
  std::vector<Vec3d> kept;
  kept.reserve(polygon.size() + 2);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (a.z >= 0) kept.push_back(a);
    if ((a.z < 0) != (b.z < 0)) {
      const Vec3d crossing = a + (b - a) * (a.z / (a.z - b.z));
      kept.emplace_back(crossing.x, crossing.y, 0);
    }
  }
  return kept;
}

}  // namespace

double horizon_form_factor(std::span<const Vec3d> local_polygon, const glm::dmat3& transform) {
  std::vector<Vec3d> visible = clip_to_horizon(local_polygon);
  for (Vec3d& corner : visible) corner = transform * corner;
  double sum = 0;
  for (std::size_t i = 0; i < visible.size(); ++i) {
    // Angle that the edge subtends, times the cosine between the receiver's normal and that of the plane through edge and receiver.
    const Vec3d &a = visible[i], &b = visible[(i + 1) % visible.size()];
    const Vec3d across = glm::cross(b, a);
    const double sine = glm::length(across);
    if (sine > 0) sum += std::atan2(sine, glm::dot(a, b)) * across.z / sine;
  }
  const double form_factor = 0.5 * std::numbers::inv_pi * sum;
  return std::isfinite(form_factor) ? std::clamp(form_factor, -1.0, 1.0) : 0.0;
}

std::vector<Vec3d> local_polygon(std::span<const Vec3> polygon, const Vec3& position, const Frame3& frame) {
  const Vec3d tangent(frame.tangent), bitangent(frame.bitangent), normal(frame.normal);
  std::vector<Vec3d> local;
  local.reserve(polygon.size());
  for (const Vec3& corner : polygon) {
    const Vec3d to_corner = Vec3d(corner) - Vec3d(position);
    local.emplace_back(glm::dot(to_corner, tangent), glm::dot(to_corner, bitangent), glm::dot(to_corner, normal));
  }
  return local;
}

PolygonPlane::PolygonPlane(std::span<const Vec3> polygon) {
  if (polygon.size() < 3) return;
  Vec3d mean(0);
  for (const Vec3& corner : polygon) mean += Vec3d(corner);
  centre = Vec3(mean / static_cast<double>(polygon.size()));
  Vec3d doubled_area(0);
  double reach_squared = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d a = Vec3d(polygon[i]) - Vec3d(centre), b = Vec3d(polygon[(i + 1) % polygon.size()]) - Vec3d(centre);
    doubled_area += glm::cross(a, b);
    reach_squared = std::max(reach_squared, glm::dot(a, a));
  }
  const double length = glm::length(doubled_area);
  if (!(length > 1e-12 * reach_squared) || !std::isfinite(length)) return;
  normal = Vec3(doubled_area / length);
  reach = static_cast<float>(std::sqrt(reach_squared));
  least_height = 1e-6f * reach;
}

std::vector<Vec3> polygon_offsets(std::span<const Vec3> polygon, const PolygonPlane& plane) {
  std::vector<Vec3> offsets;
  offsets.reserve(polygon.size());
  for (const Vec3& corner : polygon) offsets.emplace_back(Vec3d(corner) - Vec3d(plane.centre));
  return offsets;
}

double polygon_irradiance(std::span<const Vec3> polygon, const Vec3& position, const Vec3& normal, EmitterSides sides) {
  const PolygonPlane plane(polygon);
  const double height = glm::dot(Vec3d(position) - Vec3d(plane.centre), Vec3d(plane.normal));
  if (!plane.emits_towards(height, sides)) return 0;
  const double form_factor = horizon_form_factor(local_polygon(polygon, position, frame_from_normal(normal)));
  return std::max(0.0, height > 0 ? form_factor : -form_factor);
}

std::vector<Vec3> disk_polygon(const Vec3& centre, const Vec3& e1, const Vec3& e2, std::size_t corner_count) {
  const std::size_t count = std::max<std::size_t>(corner_count, 3);
  const double step = 2 * std::numbers::pi / static_cast<double>(count);
  const double radius = std::sqrt(step / std::sin(step));
  std::vector<Vec3> corners;
  corners.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = (static_cast<double>(i) + 0.5) * step;
    corners.emplace_back(Vec3d(centre) + radius * (std::cos(angle) * Vec3d(e1) + std::sin(angle) * Vec3d(e2)));
  }
  return corners;
}

std::vector<Vec3> flat_light_polygon(const FlatLight& light, const FlatEmitter& emitter, std::size_t disk_corners) {
  std::vector<Vec3> corners;
  if (emitter.is(FlatEmitter::kDisk))
    corners = disk_polygon(light.origin, light.e1, light.e2, disk_corners);
  else if (emitter.is(FlatEmitter::kTriangle))
    corners = {light.origin, light.origin + light.e1, light.origin + light.e2};
  else
    corners = {light.origin, light.origin + light.e1, light.origin + light.e1 + light.e2, light.origin + light.e2};
  if (glm::dot(glm::cross(light.e1, light.e2), light.normal) < 0) std::reverse(corners.begin(), corners.end());
  return corners;
}

}  // namespace sightline
