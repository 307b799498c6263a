// Quadrics and bilinear patches as triangles.
#include <algorithm>
#include <cmath>

#include "scene/load/pbrt/geometry.h"

namespace sightline::pbrt {
namespace {

int segments_for(float phi_max_rad, int fineness) {
  return std::clamp(static_cast<int>(std::ceil(static_cast<float>(fineness) * phi_max_rad / (2 * kPi))), 3, fineness);
}

}  // namespace

MeshArrays revolve(const std::vector<ProfilePoint>& profile, float phi_max_rad, int segments) {
  MeshArrays result;
  const auto columns = static_cast<std::uint32_t>(segments) + 1;
  for (const ProfilePoint& p : profile) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(segments);
      const float phi = u * phi_max_rad, cosine = std::cos(phi), sine = std::sin(phi);
      result.positions.emplace_back(p.radius * cosine, p.radius * sine, p.z);
      result.normals.push_back(glm::normalize(Vec3(p.normal_radius * cosine, p.normal_radius * sine, p.normal_z)));
      result.uvs.emplace_back(u, p.v);
    }
  }
  // bake() turns each triangle towards its normals; those at a pole have one corner too many and are left out here.
  for (std::uint32_t row = 0; row + 1 < profile.size(); ++row) {
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = row * columns + i, b = a + 1, c = a + columns, d = c + 1;
      if (profile[row].radius != 0) result.triangles.emplace_back(a, b, profile[row + 1].radius != 0 ? d : c);
      if (profile[row + 1].radius != 0) result.triangles.emplace_back(a, d, c);
    }
  }
  return result;
}

MeshArrays sphere_mesh(float radius, float z_min, float z_max, float phi_max_rad, int fineness) {
  const float low = std::clamp(std::min(z_min, z_max), -radius, radius), high = std::clamp(std::max(z_min, z_max), -radius, radius);
  const float theta_low = std::acos(low / radius), theta_high = std::acos(high / radius);
  const int rows = fineness / 2;
  std::vector<ProfilePoint> profile;
  for (int i = 0; i <= rows; ++i) {
    const float v = static_cast<float>(i) / static_cast<float>(rows);
    const float theta = theta_low + v * (theta_high - theta_low);
    const float sine = theta >= kPi || theta <= 0 ? 0.f : std::sin(theta), cosine = std::cos(theta);
    profile.push_back({radius * cosine, radius * sine, cosine, sine, v});
  }
  return revolve(profile, phi_max_rad, segments_for(phi_max_rad, fineness));
}

MeshArrays disk_mesh(float height, float radius, float inner_radius, float phi_max_rad, int fineness) {
  // Chords cut the circle short: a little more radius keeps the area, hence the power of a light.
  const int segments = segments_for(phi_max_rad, fineness);
  const float step = phi_max_rad / static_cast<float>(segments);
  const float widening = std::sqrt(step / std::sin(step));
  return revolve({{height, inner_radius * widening, 1, 0, 1}, {height, radius * widening, 1, 0, 0}}, phi_max_rad, segments);
}

MeshArrays cylinder_mesh(float radius, float z_min, float z_max, float phi_max_rad, int fineness) {
  return revolve({{z_min, radius, 0, 1, 0}, {z_max, radius, 0, 1, 1}}, phi_max_rad, segments_for(phi_max_rad, fineness));
}

MeshArrays bilinear_patches(const MeshArrays& vertices, const std::vector<std::array<std::uint32_t, 4>>& patches, int steps) {
  MeshArrays result;
  const bool has_normals = vertices.normals.size() == vertices.positions.size();
  const bool has_uvs = vertices.uvs.size() == vertices.positions.size();
  const auto blend = [](const auto& a, const auto& b, const auto& c, const auto& d, float u, float v) {
    return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
  };
  for (const std::array<std::uint32_t, 4>& patch : patches) {
    const Vec3 &a = vertices.positions[patch[0]], &b = vertices.positions[patch[1]];
    const Vec3 &c = vertices.positions[patch[2]], &d = vertices.positions[patch[3]];
    const float size = std::max(glm::distance(a, d), glm::distance(b, c));
    const bool is_parallelogram = glm::length(a + d - b - c) <= 1e-5f * size;
    const int n = is_parallelogram ? 1 : steps;
    const auto first = static_cast<std::uint32_t>(result.positions.size()), columns = static_cast<std::uint32_t>(n) + 1;
    for (int row = 0; row <= n; ++row) {
      for (int column = 0; column <= n; ++column) {
        const float u = static_cast<float>(column) / static_cast<float>(n), v = static_cast<float>(row) / static_cast<float>(n);
        result.positions.push_back(blend(a, b, c, d, u, v));
        const auto of = [&](const auto& values) {
          return blend(values[patch[0]], values[patch[1]], values[patch[2]], values[patch[3]], u, v);
        };
        result.uvs.push_back(has_uvs ? of(vertices.uvs) : Vec2(u, v));
        // Without normals the patch's own, so that the pieces of a bent one do not show.
        const Vec3 du = (1 - v) * (b - a) + v * (d - c), dv = (1 - u) * (c - a) + u * (d - b);
        result.normals.push_back(has_normals ? of(vertices.normals) : glm::cross(du, dv));
      }
    }
    for (std::uint32_t row = 0; row + 1 < columns; ++row) {
      for (std::uint32_t column = 0; column + 1 < columns; ++column) {
        const std::uint32_t i = first + row * columns + column;
        result.triangles.emplace_back(i, i + 1, i + columns + 1);
        result.triangles.emplace_back(i, i + columns + 1, i + columns);
      }
    }
  }
  return result;
}

}  // namespace sightline::pbrt
