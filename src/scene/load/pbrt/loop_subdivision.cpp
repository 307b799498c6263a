#include "scene/load/pbrt/loop_subdivision.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace sightline::pbrt {
namespace {

struct Edge {
  std::uint32_t a = 0, b = 0;         ///< ends
  std::uint32_t left = 0, right = 0;  ///< opposite vertices of its faces
  int faces = 0;
};

/// The edges of a triangle mesh, and for each triangle the edges that face its corners' successors.
struct Topology {
  std::vector<Edge> edges;
  std::vector<UVec3> edges_of;  ///< edge k of a triangle joins its corners k and k + 1
};

Topology connect(const std::vector<UVec3>& triangles, const Place& place) {
  Topology result;
  std::unordered_map<std::uint64_t, std::uint32_t> known;
  known.reserve(triangles.size() * 2);
  result.edges_of.resize(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[i][k], b = triangles[i][(k + 1) % 3], opposite = triangles[i][(k + 2) % 3];
      const std::uint64_t key = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
      const auto [found, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(result.edges.size()));
      if (is_new) result.edges.push_back({a, b, opposite, opposite, 0});
      Edge& edge = result.edges[found->second];
      if (++edge.faces > 2) throw error_at(place, "a subdivision surface has an edge with more than two faces");
      edge.right = opposite;
      result.edges_of[i][k] = found->second;
    }
  }
  return result;
}

/// Sums over the neighbours of each vertex; at a border only its two border neighbours count.
struct Rings {
  std::vector<Vec3> sum;
  std::vector<std::uint32_t> valence;
  std::vector<bool> is_border;
};

Rings sum_neighbours(const std::vector<Vec3>& positions, const Topology& topology) {
  Rings rings{std::vector<Vec3>(positions.size(), Vec3(0)), std::vector<std::uint32_t>(positions.size()),
              std::vector<bool>(positions.size())};
  for (const Edge& edge : topology.edges) {
    if (edge.faces == 1) rings.is_border[edge.a] = rings.is_border[edge.b] = true;
  }
  for (const Edge& edge : topology.edges) {
    for (const auto& [from, to] : {std::pair(edge.a, edge.b), std::pair(edge.b, edge.a)}) {
      if (rings.is_border[from] && edge.faces != 1) continue;
      rings.sum[from] += positions[to];
      ++rings.valence[from];
    }
  }
  return rings;
}

/// Weight of each neighbour in the rule for an inner vertex [Loop1987].
float beta(std::uint32_t valence) { return valence == 3 ? 3.f / 16 : 3.f / (8 * static_cast<float>(valence)); }

/// Weighted mean: 1 - n w of the vertex itself, w of each neighbour.
std::vector<Vec3> smoothed(const std::vector<Vec3>& positions, const Rings& rings, auto&& inner_weight, float border_weight) {
  std::vector<Vec3> result(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const std::uint32_t n = rings.valence[i];
    const float w = n == 0 ? 0 : rings.is_border[i] ? border_weight : inner_weight(n);
    result[i] = (1 - static_cast<float>(n) * w) * positions[i] + w * rings.sum[i];
  }
  return result;
}

void subdivide(std::vector<Vec3>& positions, std::vector<UVec3>& triangles, const Place& place) {
  const Topology topology = connect(triangles, place);
  const Rings rings = sum_neighbours(positions, topology);
  std::vector<Vec3> next = smoothed(positions, rings, beta, 1.f / 8);
  // One new vertex an edge.
  const auto first_new = static_cast<std::uint32_t>(next.size());
  for (const Edge& edge : topology.edges) {
    const Vec3 ends = positions[edge.a] + positions[edge.b];
    next.push_back(edge.faces == 1 ? 0.5f * ends : 0.375f * ends + 0.125f * (positions[edge.left] + positions[edge.right]));
  }
  std::vector<UVec3> finer;
  finer.reserve(4 * triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const UVec3 &t = triangles[i], mid = topology.edges_of[i] + first_new;
    finer.emplace_back(t.x, mid.x, mid.z);
    finer.emplace_back(mid.x, t.y, mid.y);
    finer.emplace_back(mid.z, mid.y, t.z);
    finer.push_back(mid);
  }
  positions = std::move(next);
  triangles = std::move(finer);
}

}  // namespace

MeshArrays subdivide_loop(std::vector<Vec3> positions, std::span<const std::int32_t> indices, int levels, const Place& place) {
  MeshArrays result;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const UVec3 t(indices[i], indices[i + 1], indices[i + 2]);
    if (std::max({t.x, t.y, t.z}) >= positions.size()) throw error_at(place, "an index of a subdivision surface is out of range");
    if (t.x != t.y && t.y != t.z && t.z != t.x) result.triangles.push_back(t);
  }
  for (const Vec3& p : positions) {
    if (!is_finite(p)) throw error_at(place, "a vertex of a subdivision surface is not finite");
  }
  for (int level = 0; level < levels; ++level) subdivide(positions, result.triangles, place);
  // The limit position of an inner vertex, and normals as the mean of the faces, which converge to the limit's as well.
  const Topology topology = connect(result.triangles, place);
  const auto limit_weight = [](std::uint32_t n) { return 1 / (static_cast<float>(n) + 3 / (8 * beta(n))); };
  result.positions = smoothed(positions, sum_neighbours(positions, topology), limit_weight, 1.f / 5);
  result.normals.assign(result.positions.size(), Vec3(0));
  for (const UVec3& t : result.triangles) {
    const Vec3& a = result.positions[t.x];
    const Vec3 face = glm::cross(result.positions[t.y] - a, result.positions[t.z] - a);
    for (int corner = 0; corner < 3; ++corner) result.normals[t[corner]] += face;
  }
  return result;
}

}  // namespace sightline::pbrt
