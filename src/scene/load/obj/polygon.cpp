#include "scene/load/obj/polygon.h"

#include <cmath>
#include <numeric>

namespace sightline::obj {
namespace {

using Point = glm::dvec2;

/// Ears cost quadratic time; a polygon with more corners than this is a fan whatever its shape, so that no file can make us hang.
constexpr std::size_t kMaxEarCorners = 1024;

double cross(const Point& a, const Point& b, const Point& c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// The polygon seen along its mean normal (Newell's formula), counter-clockwise.
std::vector<Point> project(std::span<const Vec3> corners) {
  Vec3d normal(0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a(corners[i] - corners[0]), b(corners[(i + 1) % corners.size()] - corners[0]);
    normal += glm::cross(a, b);
  }
  const Vec3d size = glm::abs(normal);
  // Dropping the largest component keeps the shape up to an affine map; the order of the two others keeps its winding.
  int axis = size.x > size.y ? 0 : 1;
  if (size.z > size[axis]) axis = 2;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double sign = normal[axis] < 0 ? -1 : 1;
  std::vector<Point> points;
  points.reserve(corners.size());
  for (const Vec3& c : corners) points.emplace_back(sign * c[u], c[v]);
  return points;
}

bool is_convex(const std::vector<Point>& p) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (cross(p[i], p[(i + 1) % p.size()], p[(i + 2) % p.size()]) < 0) return false;
  }
  return true;
}

bool is_ear(const std::vector<Point>& p, const std::vector<std::uint32_t>& left, std::size_t i) {
  const std::size_t n = left.size();
  const std::uint32_t a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
  if (cross(p[a], p[b], p[c]) <= 0) return false;
  for (const std::uint32_t k : left) {
    if (k == a || k == b || k == c || p[k] == p[a] || p[k] == p[b] || p[k] == p[c]) continue;
    if (cross(p[a], p[b], p[k]) >= 0 && cross(p[b], p[c], p[k]) >= 0 && cross(p[c], p[a], p[k]) >= 0) return false;
  }
  return true;
}

}  // namespace

void triangulate(std::span<const Vec3> corners, std::vector<UVec3>& triangles) {
  const auto n = static_cast<std::uint32_t>(corners.size());
  const auto fan = [&] {
    for (std::uint32_t i = 2; i < n; ++i) triangles.push_back({0, i - 1, i});
  };
  if (n <= 3 || n > kMaxEarCorners) return fan();
  const std::vector<Point> points = project(corners);
  if (is_convex(points)) return fan();
  std::vector<std::uint32_t> left(n);
  std::iota(left.begin(), left.end(), 0u);
  std::size_t i = 0;
  for (std::size_t tried = 0; left.size() > 3;) {
    // No ear in a whole round: the polygon is degenerate or crosses itself. Any corner will do.
    if (tried < left.size() && !is_ear(points, left, i)) {
      i = (i + 1) % left.size();
      ++tried;
      continue;
    }
    const std::size_t count = left.size();
    triangles.push_back({left[(i + count - 1) % count], left[i], left[(i + 1) % count]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
    i %= left.size();
    tried = 0;
  }
  triangles.push_back({left[0], left[1], left[2]});
}

}  // namespace sightline::obj
