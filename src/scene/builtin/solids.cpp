#include "scene/builtin/solids.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "scene/builtin/seeded.h"
#include "scene/builtin/smooth_normals.h"

namespace sightline::builtin {
namespace {

/// Scales to bounding radius 1 and adds what is derived.
Mesh finished(std::string name, std::vector<Vec3> positions, const std::vector<UVec3>& triangles) {
  float farthest = 0;
  for (const Vec3& p : positions) farthest = std::max(farthest, length_squared(p));
  const float scale = 1 / std::sqrt(farthest);
  Mesh mesh;
  for (Vec3& p : positions) {
    p *= scale;
    mesh.bounds.add(p);
  }
  mesh.name = std::move(name);
  mesh.positions = SharedArray<Vec3>(positions);
  mesh.triangles = SharedArray<UVec3>(triangles);
  add_smooth_normals(mesh);
  return mesh;
}

/// A surface that closes in both parameters (angles from 0 to 2 pi) as a grid without seams. `aspect`: how much longer it is along u than
/// along v. It faces along du x dv.
Mesh closed_grid(std::string name, std::uint64_t vertex_count, double aspect, const std::function<Vec3(float, float)>& point) {
  const auto across =
      std::max<std::uint64_t>(8, static_cast<std::uint64_t>(std::lround(std::sqrt(static_cast<double>(vertex_count) / aspect))));
  const std::uint64_t along = std::max<std::uint64_t>(8, (vertex_count + across / 2) / across);
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  positions.reserve(along * across);
  triangles.reserve(2 * along * across);
  const auto angle_rad = [](std::uint64_t i, std::uint64_t n) { return 2 * kPi * static_cast<float>(i) / static_cast<float>(n); };
  const auto at = [&](std::uint64_t i, std::uint64_t j) { return static_cast<std::uint32_t>(i % along * across + j % across); };
  for (std::uint64_t i = 0; i < along; ++i) {
    for (std::uint64_t j = 0; j < across; ++j) {
      positions.push_back(point(angle_rad(i, along), angle_rad(j, across)));
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return finished(std::move(name), std::move(positions), triangles);
}

/// The unit ball from an octahedron whose faces are cut into `cuts`² triangles: 4 cuts² + 2 vertices.
void octahedral_ball(int cuts, std::vector<Vec3>& positions, std::vector<UVec3>& triangles) {
  // Rings from +Y to -Y; ring r has 4 min(r, 2 cuts - r) vertices, a pole 1.
  const auto ring_size = [&](int ring) { return std::max(1, 4 * std::min(ring, 2 * cuts - ring)); };
  std::vector<std::uint32_t> first;
  for (int ring = 0; ring <= 2 * cuts; ++ring) {
    first.push_back(static_cast<std::uint32_t>(positions.size()));
    const int quarter = std::min(ring, 2 * cuts - ring);
    for (int k = 0; k < ring_size(ring); ++k) {
      // Along the edge of the square |x| + |z| = quarter, counter-clockwise seen from above: from +X over -Z.
      const int side = quarter > 0 ? k / quarter : 0, step = quarter > 0 ? k % quarter : 0;
      const auto a = static_cast<float>(quarter - step), b = static_cast<float>(step);
      const Vec2 corners[4] = {{a, -b}, {-b, -a}, {-a, b}, {b, a}};
      const Vec2 xz = quarter > 0 ? corners[side] : Vec2(0);
      positions.push_back(glm::normalize(Vec3(xz.x, static_cast<float>(cuts - ring), xz.y)));
    }
  }
  const auto at = [&](int ring, int side, int k) {
    const int size = ring_size(ring), quarter = std::min(ring, 2 * cuts - ring);
    return first[static_cast<std::size_t>(ring)] + static_cast<std::uint32_t>((side * quarter + k) % size);
  };
  // Between two rings, each of the four sides is a strip; the longer ring has one edge more than the shorter.
  for (int ring = 0; ring < 2 * cuts; ++ring) {
    const bool upper = ring < cuts;
    const int outer = upper ? ring + 1 : ring, inner = upper ? ring : ring + 1;
    const int edges = std::min(outer, 2 * cuts - outer);
    for (int side = 0; side < 4; ++side) {
      for (int k = 0; k < edges; ++k) {
        const std::uint32_t a = at(outer, side, k), b = at(outer, side, k + 1), c = at(inner, side, k);
        triangles.push_back(upper ? UVec3(a, b, c) : UVec3(a, c, b));
        if (k + 1 == edges) continue;
        const std::uint32_t d = at(inner, side, k + 1);
        triangles.push_back(upper ? UVec3(c, b, d) : UVec3(c, d, b));
      }
    }
  }
}

}  // namespace

Mesh torus_knot(std::uint64_t vertex_count, std::uint64_t seed) {
  constexpr int kWindings[3][2] = {{2, 3}, {3, 2}, {2, 5}};
  const auto& winding = kWindings[Seeded(seed, 1).below(3)];
  const auto p = static_cast<float>(winding[0]), q = static_cast<float>(winding[1]);
  const auto curve = [=](float t) {
    const float r = 1 + 0.42f * std::cos(q * t);
    return Vec3(r * std::cos(p * t), 0.42f * std::sin(q * t), r * std::sin(p * t));
  };
  const float tube = q > 3 ? 0.13f : 0.19f;
  return closed_grid("torus knot", vertex_count, 12, [=](float u, float v) {
    constexpr float kStep = 0.01f;
    const Vec3 before = curve(u - kStep), here = curve(u), after = curve(u + kStep);
    const Vec3 tangent = glm::normalize(after - before);
    // The curve bends everywhere, so that it has a side to which it bends.
    const Vec3 bend = after + before - 2.f * here;
    const Vec3 normal = glm::normalize(bend - glm::dot(bend, tangent) * tangent), binormal = glm::cross(normal, tangent);
    return here + tube * (std::cos(v) * normal + std::sin(v) * binormal);
  });
}

Mesh bumpy_ball(std::uint64_t vertex_count, std::uint64_t seed) {
  Seeded random(seed, 2);
  const float frequency = random.uniform(5, 8);
  const Vec3 phase = kPi * random.in_ball();
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  const double cuts = std::sqrt(static_cast<double>(std::max<std::uint64_t>(vertex_count, 6) - 2) / 4);
  octahedral_ball(std::max(4, static_cast<int>(std::lround(cuts))), positions, triangles);
  for (Vec3& d : positions) {
    const Vec3 wave = glm::sin(frequency * d + phase);
    d *= 1 + 0.22f * wave.x * wave.y + 0.14f * wave.z;
  }
  return finished("bumpy ball", std::move(positions), triangles);
}

Mesh gear(std::uint64_t vertex_count, std::uint64_t seed) {
  const auto teeth = static_cast<float>(9 + Seeded(seed, 3).below(6));
  const auto flattened = [](float x, float power) { return std::copysign(std::pow(std::fabs(x), power), x); };
  return closed_grid("gear", vertex_count, 4, [=](float u, float v) {
    // A ring with a rounded rectangle as its section; outside, a wave with flat tops and grooves pushes it out.
    const float out = flattened(std::cos(v), 0.35f), up = flattened(std::sin(v), 0.35f);
    const float tooth = std::tanh(2.2f * std::sin(teeth * u));
    const float radius = 0.68f + 0.2f * out + (out > 0 ? 0.1f * out * tooth : 0.f);
    return Vec3(radius * std::cos(u), 0.24f * up, -radius * std::sin(u));
  });
}

}  // namespace sightline::builtin
