#include "scene/builtin/subdivide.h"

#include <unordered_map>
#include <vector>

#include "base/core/error.h"
#include "scene/materialize.h"

namespace sightline::builtin {
namespace {

std::uint64_t vertex_count(const Scene& scene) {
  std::uint64_t count = 0;
  for (const Mesh& mesh : scene.meshes) count += mesh.positions.size();
  return count;
}

template <class T>
std::vector<T> vector_of(const SharedArray<T>& array) {
  return {array.begin(), array.end()};
}

Mesh split(const Mesh& mesh) {
  std::vector<Vec3> positions = vector_of(mesh.positions), normals = vector_of(mesh.normals);
  std::vector<Vec2> uvs = vector_of(mesh.uvs);
  std::vector<Vec4> tangents = vector_of(mesh.tangents);
  std::unordered_map<std::uint64_t, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const std::uint64_t key = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    const auto [entry, is_new] = middles.try_emplace(key, static_cast<std::uint32_t>(positions.size()));
    if (is_new) {
      positions.push_back(0.5f * positions[a] + 0.5f * positions[b]);
      if (!normals.empty()) normals.push_back(normalize_or(normals[a] + normals[b], normals[a]));
      if (!uvs.empty()) uvs.push_back(0.5f * (uvs[a] + uvs[b]));
      if (!tangents.empty())
        tangents.push_back(Vec4(normalize_or(Vec3(tangents[a]) + Vec3(tangents[b]), Vec3(tangents[a])), tangents[a].w));
    }
    return entry->second;
  };
  std::vector<UVec3> triangles;
  std::vector<std::uint16_t> materials;
  triangles.reserve(4 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const UVec3 t = mesh.triangles[i];
    const std::uint32_t ab = middle(t.x, t.y), bc = middle(t.y, t.z), ca = middle(t.z, t.x);
    triangles.insert(triangles.end(), {{t.x, ab, ca}, {ab, t.y, bc}, {ca, bc, t.z}, {ab, bc, ca}});
    if (!mesh.triangle_materials.empty()) materials.insert(materials.end(), 4, mesh.triangle_materials[i]);
  }
  Mesh result = mesh;
  result.positions = SharedArray<Vec3>(positions);
  result.normals = SharedArray<Vec3>(normals);
  result.uvs = SharedArray<Vec2>(uvs);
  result.tangents = SharedArray<Vec4>(tangents);
  result.triangles = SharedArray<UVec3>(triangles);
  result.triangle_materials = SharedArray<std::uint16_t>(materials);
  return result;
}

}  // namespace

void subdivide(Scene& scene, std::uint64_t min_vertices, const Context& context) {
  for (std::uint64_t before = 0, now = vertex_count(scene); now < min_vertices && now != before; now = vertex_count(scene)) {
    before = now;
    // Four times the triangles, and while it lasts about twice their arrays.
    require_memory(context, 8 * scene_bytes(scene), "a subdivided scene");
    for (Mesh& mesh : scene.meshes) {
      context.check_cancelled();
      if (!mesh.source) mesh = split(mesh);
    }
  }
}

}  // namespace sightline::builtin
