#include "scene/load/pbrt/merge_meshes.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace sightline::pbrt {
namespace {

Mesh join(const std::vector<Mesh*>& parts) {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uvs;
  std::vector<UVec3> triangles;
  std::vector<std::uint16_t> triangle_materials;
  Mesh result;
  for (const Mesh* const part : parts) {
    const UVec3 offset(static_cast<std::uint32_t>(positions.size()));
    positions.insert(positions.end(), part->positions.begin(), part->positions.end());
    normals.insert(normals.end(), part->normals.begin(), part->normals.end());
    uvs.insert(uvs.end(), part->uvs.begin(), part->uvs.end());
    const auto found = std::find(result.materials.begin(), result.materials.end(), part->materials.front());
    const auto index = static_cast<std::uint16_t>(found - result.materials.begin());
    if (found == result.materials.end()) result.materials.push_back(part->materials.front());
    for (const UVec3& t : part->triangles) triangles.push_back(t + offset);
    triangle_materials.insert(triangle_materials.end(), part->triangles.size(), index);
    result.bounds.add(part->bounds);
  }
  result.positions = positions;
  result.normals = normals;
  result.uvs = uvs;
  result.triangles = triangles;
  if (result.materials.size() > 1) result.triangle_materials = triangle_materials;
  return result;
}

}  // namespace

std::vector<Mesh> merge_meshes(std::vector<Mesh> parts) {
  // A mesh has each attribute for all vertices or for none, 16 bits for the palette and 32 for vertices.
  constexpr std::size_t kMostParts = std::numeric_limits<std::uint16_t>::max();
  constexpr std::size_t kMostVertices = std::numeric_limits<std::uint32_t>::max();
  struct Group {
    std::vector<Mesh*> parts;
    std::size_t vertices = 0;
  };
  std::map<std::pair<bool, bool>, std::vector<Group>> groups;
  for (Mesh& part : parts) {
    std::vector<Group>& alike = groups[{part.normals.empty(), part.uvs.empty()}];
    if (alike.empty() || alike.back().parts.size() == kMostParts || alike.back().vertices + part.positions.size() >= kMostVertices) {
      alike.emplace_back();
    }
    alike.back().parts.push_back(&part);
    alike.back().vertices += part.positions.size();
  }
  std::vector<Mesh> result;
  for (const auto& [attributes, alike] : groups) {
    for (const Group& group : alike) result.push_back(group.parts.size() == 1 ? std::move(*group.parts.front()) : join(group.parts));
  }
  return result;
}

}  // namespace sightline::pbrt
