#include "methods/square_lights/solid_ball.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <vector>

namespace sightline::square_lights {
namespace {

using DVec3 = glm::dvec3;

// Less than the distance to the surface by what coordinates and rays may be off.
constexpr double kClearance = 0.999;

/// Vertices by place: the first of those that are equal.
std::vector<std::uint32_t> weld(std::span<const Vec3> positions) {
  struct Hash {
    std::size_t operator()(const std::array<std::uint32_t, 3>& bits) const {
      std::uint64_t h = 0;
      for (const std::uint32_t b : bits) h = (h ^ b) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
      return static_cast<std::size_t>(h);
    }
  };
  std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, Hash> known;
  known.reserve(positions.size());
  std::vector<std::uint32_t> first(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const Vec3 p = positions[i] + 0.f;  // no negative zero
    std::array<std::uint32_t, 3> bits;
    std::memcpy(bits.data(), &p, sizeof bits);
    first[i] = known.try_emplace(bits, i).first->second;
  }
  return first;
}

/// Whether each edge is passed as often one way as the other: then the surface has no border, and surrounds points a whole number of times.
bool is_closed(std::span<const Vec3> positions, std::span<const UVec3> triangles) {
  const std::vector<std::uint32_t> first = weld(positions);
  std::vector<std::pair<std::uint64_t, int>> edges;
  edges.reserve(3 * triangles.size());
  for (const UVec3& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = first[t[k]], b = first[t[(k + 1) % 3]];
      if (a != b) edges.emplace_back(std::uint64_t{std::min(a, b)} << 32 | std::max(a, b), a < b ? 1 : -1);
    }
  }
  std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < edges.size();) {
    const std::uint64_t edge = edges[i].first;
    int sum = 0;
    for (; i < edges.size() && edges[i].first == edge; ++i) sum += edges[i].second;
    if (sum != 0) return false;
  }
  return !edges.empty();
}

/// Solid angle of a triangle around the origin, with the sign of its winding [VanOosterom1983, Eq. 8].
double solid_angle(const DVec3& a, const DVec3& b, const DVec3& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double denominator = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return 2 * std::atan2(glm::dot(a, glm::cross(b, c)), denominator);
}

/// Squared distance of a triangle from the origin: that of its plane where the foot lies within, else that of its edges.
double distance2(const DVec3& a, const DVec3& b, const DVec3& c) {
  const auto edge = [](const DVec3& p, const DVec3& q) {
    const DVec3 d = q - p;
    const double length2 = glm::dot(d, d), t = length2 > 0 ? std::clamp(-glm::dot(p, d) / length2, 0.0, 1.0) : 0.0;
    const DVec3 nearest = p + t * d;
    return glm::dot(nearest, nearest);
  };
  const double to_edges = std::min({edge(a, b), edge(b, c), edge(c, a)});
  const DVec3 normal = glm::cross(b - a, c - a);
  const double length2 = glm::dot(normal, normal);
  if (!(length2 > 0)) return to_edges;
  const double height = glm::dot(normal, a);
  const DVec3 foot = normal * (height / length2);
  const auto inside = [&](const DVec3& p, const DVec3& q) { return glm::dot(normal, glm::cross(q - p, foot - p)) >= 0; };
  return inside(a, b) && inside(b, c) && inside(c, a) ? height * height / length2 : to_edges;
}

bool is_opaque(const Scene& scene, MaterialId id) {
  if (!id.valid()) return true;
  const Material& material = scene.materials[id.index];
  return material.alpha_mode == AlphaMode::opaque && !std::holds_alternative<InterfaceMaterial>(material.model);
}
bool is_opaque(const Scene& scene, const Instance& instance) {
  if (instance.material_override.valid()) return is_opaque(scene, instance.material_override);
  const std::vector<MaterialId>& palette = scene.meshes[instance.mesh.index].materials;
  return std::all_of(palette.begin(), palette.end(), [&](MaterialId id) { return is_opaque(scene, id); });
}

}  // namespace

float solid_ball(std::span<const Vec3> positions, std::span<const UVec3> triangles, const Vec3& center) {
  if (!std::all_of(positions.begin(), positions.end(), [](const Vec3& p) { return is_finite(p); })) return 0;
  double angle = 0, least2 = std::numeric_limits<double>::infinity();
  for (const UVec3& t : triangles) {
    const DVec3 a(positions[t.x] - center), b(positions[t.y] - center), c(positions[t.z] - center);
    angle += solid_angle(a, b, c);
    least2 = std::min(least2, distance2(a, b, c));
  }
  if (std::fabs(angle) < 2 * std::numbers::pi || !std::isfinite(least2) || !is_closed(positions, triangles)) return 0;
  return static_cast<float>(kClearance * std::sqrt(least2));
}

float solid_ball(const Scene& scene, const ShadingObject& object, const Vec3& center) {
  float greatest = 0;
  for (std::size_t m = 0; m < object.members.size(); ++m) {
    const std::uint32_t index = object.members[m];
    if (index & kSphereBit) {
      const Sphere& sphere = scene.spheres[index & ~kSphereBit];
      if (is_opaque(scene, sphere.material))
        greatest = std::max(greatest, static_cast<float>(kClearance) * (sphere.radius - glm::length(sphere.center - center)));
      continue;
    }
    const Instance& instance = scene.instances[index];
    const Mesh& mesh = scene.meshes[instance.mesh.index];
    if (mesh.is_deformable() || !is_opaque(scene, instance)) continue;
    std::vector<Vec3> positions;
    positions.reserve(mesh.positions.size());
    for (const Vec3& p : mesh.positions) positions.push_back(transform_point(object.object_from_member[m], p));
    greatest = std::max(greatest, solid_ball(positions, mesh.triangles.span(), center));
  }
  return greatest;
}

}  // namespace sightline::square_lights
