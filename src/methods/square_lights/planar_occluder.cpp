#include "methods/square_lights/planar_occluder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/math/frame.h"
#include "methods/square_lights/shade_lanes.h"

namespace sightline::square_lights {
namespace {

/// Corners of the convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return {};
  const auto turns_right = [](const Vec2& a, const Vec2& b, const Vec2& c) {
    return double{b.x - a.x} * double{c.y - a.y} - double{b.y - a.y} * double{c.x - a.x} <= 0;
  };
  std::vector<Vec2> hull(2 * points.size());
  std::size_t size = 0;
  for (const Vec2& p : points) {
    while (size >= 2 && turns_right(hull[size - 2], hull[size - 1], p)) --size;
    hull[size++] = p;
  }
  const std::size_t lower = size + 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) {
    while (size >= lower && turns_right(hull[size - 2], hull[size - 1], points[i])) --size;
    hull[size++] = points[i];
  }
  hull.resize(size - 1);
  return hull;
}

}  // namespace

std::optional<PlanarOccluder> PlanarOccluder::fit(std::span<const Vec3> points, float area) {
  if (points.size() < 3) return {};
  // The plane of the first point, the one farthest from it, and the one farthest from their line.
  const Vec3 a = points[0];
  const auto farthest = [&](const auto& measure) {
    return *std::max_element(points.begin(), points.end(), [&](const Vec3& p, const Vec3& q) { return measure(p) < measure(q); });
  };
  const Vec3 b = farthest([&](const Vec3& p) { return length_squared(p - a); });
  const float size = glm::length(b - a);
  const Vec3 c = farthest([&](const Vec3& p) { return length_squared(glm::cross(p - a, b - a)); });
  const Vec3 normal = normalize_or(glm::cross(b - a, c - a), Vec3(0));
  if (normal == Vec3(0) || !(size > 0)) return {};
  for (const Vec3& p : points) {
    if (std::fabs(glm::dot(normal, p - a)) > 1e-4f * size) return {};
  }
  const Frame3 frame = frame_from_normal(normal);
  std::vector<Vec2> flat;
  for (const Vec3& p : points) flat.emplace_back(glm::dot(p - a, frame.tangent), glm::dot(p - a, frame.bitangent));
  const std::vector<Vec2> hull = convex_hull(std::move(flat));
  double twice = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 p = hull[i], q = hull[(i + 1) % hull.size()];
    twice += double{p.x} * double{q.y} - double{p.y} * double{q.x};
  }
  // Holes and dents are open: such a mesh is no polygon.
  if (hull.size() < 3 || std::fabs(0.5 * twice - double{area}) > 1e-3 * double{area}) return {};
  PlanarOccluder result;
  result.normal_ = normal;
  for (const Vec2& p : hull) result.corners_.push_back(a + p.x * frame.tangent + p.y * frame.bitangent);
  return result;
}

float PlanarOccluder::along(const Vec3& position, const Vec3& c) const {
  const float t = glm::dot(normal_, corners_[0] - position) / glm::dot(normal_, c);
  return t > 0 ? t : std::numeric_limits<float>::infinity();
}

void PlanarOccluder::see(const Vec3& position, Seen& seen) const {
  seen.out_.clear();
  const float height = glm::dot(normal_, position - corners_[0]);
  if (height == 0) return;
  const float side = height > 0 ? 1.f : -1.f;
  for (std::size_t i = 0; i < corners_.size(); ++i)
    seen.out_.push_back(side * normalize_or(glm::cross(corners_[i] - position, corners_[(i + 1) % corners_.size()] - position), Vec3(0)));
}

float PlanarOccluder::Seen::distance(const Vec3& c, float most) const {
  if (out_.empty()) return most;
  float outside = -1;
  for (const Vec3& out : out_) outside = std::max(outside, glm::dot(out, c));
  // An angle is no less than its sine. Where the square is hidden to its last corner it does not matter how far within it lies.
  const float least = outside * 0.70710678f;
  if (least >= most || least <= -most) return std::min(least, most);
  return std::min(most, std::asin(std::min(outside, 1.f)) * 0.70710678f);
}

float PlanarOccluder::distance(const Vec3& position, const Vec3& c) const {
  Seen seen;
  see(position, seen);
  return seen.distance(c, kNoOccluder);
}

}  // namespace sightline::square_lights
