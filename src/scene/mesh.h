// Triangle meshes, spheres and their placement in the scene.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/core/shared_array.h"
#include "base/math/bounds.h"
#include "base/math/vec.h"
#include "scene/deformation.h"
#include "scene/ids.h"

namespace sightline {

/// A bounded piece of a mesh that is generated or read on demand. Indices are local to the chunk.
struct MeshChunk {
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  MaterialId material;  ///< invalid: the mesh's material
};

/// Restartable pull iterator over the chunks of a mesh that may be larger than memory. Counts and bounds are known beforehand.
/// next() is called by one thread at a time.
class MeshSource {
 public:
  virtual ~MeshSource() = default;
  virtual std::uint64_t vertex_count() const = 0;
  virtual std::uint64_t triangle_count() const = 0;
  virtual Bounds bounds() const = 0;
  /// Starts again at the first chunk.
  virtual void restart() = 0;
  /// Fills `chunk` (its storage is reused) with at most ~2^16 triangles; false at the end.
  virtual bool next(MeshChunk& chunk) = 0;
};

/// Triangles in object space. Optional attributes are empty or have one element a vertex.
struct Mesh {
  std::string name;
  SharedArray<Vec3> positions;
  SharedArray<Vec3> normals;     ///< unit shading normals
  SharedArray<Vec2> uvs;         ///< v = 0 is the top row of the image
  SharedArray<Vec4> tangents;    ///< xyz tangent, w = ±1 handedness of the bitangent (glTF)
  SharedArray<UVec3> triangles;  ///< vertex indices, counter-clockwise seen from the front
  /// Material of each triangle: indices into `materials`; empty = all use materials[0].
  SharedArray<std::uint16_t> triangle_materials;
  std::vector<MaterialId> materials;   ///< palette; empty = the default material (Lambert 0.7)
  Bounds bounds;                       ///< of `positions` or of the source
  std::shared_ptr<MeshSource> source;  ///< set instead of arrays while the mesh has not been materialised

  /// Set where the vertices change with time: posing the scene replaces positions, normals, tangents and bounds by deformed ones. Such a
  /// mesh is used by the instances of one node only. With a skin the vertices are in world space, and the instance's transform is 1.
  std::shared_ptr<const Deformation> deformation;
  SkinId skin;
  NodeId weights_node;  ///< node with the weights of the morph targets

  bool is_deformable() const { return deformation != nullptr; }
  MaterialId material_of(std::size_t triangle) const {
    if (materials.empty()) return {};
    return materials[triangle_materials.empty() ? 0 : triangle_materials[triangle]];
  }
  std::uint64_t triangle_count() const { return source ? source->triangle_count() : triangles.size(); }
};

/// A placement of a mesh.
struct Instance {
  std::string name;
  MeshId mesh;
  Mat4 world_from_object{1};
  MaterialId material_override;  ///< valid: replaces every material of the mesh
  NodeId node;                   ///< valid: world_from_object follows this node when the scene is posed
};

/// An analytic sphere in world space (pbrt's shape, test scenes). Loaders tessellate spheres under non-uniform scale or that are partial.
struct Sphere {
  std::string name;
  Vec3 center{0};
  float radius = 1;
  Mat4 world_from_object{1};  ///< for texture coordinates only (rotation of the poles)
  bool reverse_orientation = false;
  MaterialId material;
};

}  // namespace sightline
