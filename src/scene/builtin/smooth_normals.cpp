#include "scene/builtin/smooth_normals.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "scene/materialize.h"

namespace sightline::builtin {
namespace {

/// Sum over the triangles at each vertex of their unit normals, weighted by their angles there.
std::vector<Vec3> corner_sums(const Mesh& mesh) {
  std::vector<Vec3> sums(mesh.positions.size(), Vec3(0));
  for (const UVec3& t : mesh.triangles) {
    const Vec3d p[3] = {Vec3d(mesh.positions[t.x]), Vec3d(mesh.positions[t.y]), Vec3d(mesh.positions[t.z])};
    const Vec3d area_normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double length = glm::length(area_normal);
    if (!(length > 0)) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const Vec3d a = p[(corner + 1) % 3] - p[corner], b = p[(corner + 2) % 3] - p[corner];
      const double angle_rad = std::atan2(length, glm::dot(a, b));
      sums[t[corner]] += Vec3(angle_rad / length * area_normal);
    }
  }
  return sums;
}

/// Vertices of one position whose normals are close, and the sum that they share.
struct Cluster {
  Vec3 sum;
  std::vector<std::uint32_t> members;
};

/// Puts each vertex of a group to the nearest cluster within the crease angle. Clusters lie apart by about that angle, so there are but
/// few of them however large the group.
void share_sums(std::span<const std::uint32_t> group, std::span<Vec3> sums) {
  const float least_cosine = std::cos(kCreaseAngleRad);
  std::vector<Cluster> clusters;
  for (const std::uint32_t vertex : group) {
    const Vec3 direction = normalize_or(sums[vertex], Vec3(0));
    if (direction == Vec3(0)) continue;
    Cluster* best = nullptr;
    float best_cosine = least_cosine;
    for (Cluster& cluster : clusters) {
      const float cosine = glm::dot(normalize_or(cluster.sum, Vec3(0)), direction);
      if (cosine <= best_cosine) continue;
      best = &cluster;
      best_cosine = cosine;
    }
    if (best == nullptr) best = &clusters.emplace_back(Cluster{Vec3(0), {}});
    best->sum += sums[vertex];
    best->members.push_back(vertex);
  }
  for (const Cluster& cluster : clusters) {
    for (const std::uint32_t vertex : cluster.members) sums[vertex] = cluster.sum;
  }
}

}  // namespace

void add_smooth_normals(Mesh& mesh) {
  std::vector<Vec3> sums = corner_sums(mesh);

  // Vertices at equal positions become neighbours.
  std::vector<std::uint32_t> order(sums.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t v) {
    const Vec3& p = mesh.positions[v];
    return std::tuple(p.x, p.y, p.z, v);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && mesh.positions[order[end]] == mesh.positions[order[begin]]) ++end;
    if (end - begin > 1) share_sums(std::span(order).subspan(begin, end - begin), sums);
    begin = end;
  }

  mesh.normals = SharedArray<Vec3>::make(sums.size(), [&](std::span<Vec3> normals) {
    std::transform(sums.begin(), sums.end(), normals.begin(), [](const Vec3& sum) { return normalize_or(sum, Vec3(0, 1, 0)); });
  });
}

void add_smooth_normals(Scene& scene, const Context& context) {
  require_memory(context, 2 * scene_bytes(scene), "smooth normals");
  for (Mesh& mesh : scene.meshes) {
    context.check_cancelled();
    if (!mesh.source && mesh.normals.empty()) add_smooth_normals(mesh);
  }
}

}  // namespace sightline::builtin
