// Mesh primitives become triangle meshes.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "scene/load/gltf/import.h"

namespace sightline::gltf {

/// A primitive on a node.
struct PlacedPart {
  MeshId mesh;
  bool skinned = false;  ///< stands in world space
};

/// Reads meshes when a node first uses them. Arrays of one accessor are decoded once and shared between primitives.
class MeshImporter {
 public:
  /// `material_uv_sets`: the texture coordinate set of each material.
  MeshImporter(Import& import, std::span<const std::uint64_t> material_uv_sets) : import_(import), material_uv_sets_(material_uv_sets) {}

  /// The scene meshes of the glTF mesh that `reference` on a node points to: one for each primitive that has triangles. Nodes share them,
  /// except for those that bend: these are the node's own. `skin`: of the node, if it has one.
  std::vector<PlacedPart> place(const JsonView& reference, NodeId node, std::optional<SkinId> skin);
  /// One warning for each thing that was left out on the way.
  void warn_of_losses() const;

 private:
  struct Positions {
    SharedArray<Vec3> array;              ///< non-finite ones replaced
    std::vector<std::uint8_t> is_broken;  ///< 1 where the file had no finite position; empty if all are fine
  };
  struct Normals {
    SharedArray<Vec3> array;
    bool has_broken = false;  ///< zero vectors where the file had none
  };
  struct Triangles {
    SharedArray<UVec3> array;
    Bounds bounds;
  };

  /// A primitive that has been read.
  struct Part {
    Mesh mesh;
    std::shared_ptr<const Deformation> deformation;  ///< null: it does not bend
    std::uint32_t largest_joint = 0;
    MeshId shared;  ///< where it stands in the scene, once a node uses it as it is
  };

  std::vector<Part>& parts(std::size_t gltf_mesh);
  void add_primitive(const JsonView& primitive, const std::string& name, std::vector<Part>& parts);
  void add_bent(const Part& part, NodeId node, std::optional<SkinId> skin, const JsonView& reference);
  void choose_material(const JsonView& primitive, Mesh& mesh, std::uint64_t& uv_set);
  const Triangles& triangles(const JsonView& primitive, std::uint64_t mode, std::size_t position_accessor, const Positions& positions);
  const Positions& positions(std::size_t accessor);
  const Normals& normals(std::size_t accessor);
  SharedArray<Vec2> uvs(std::size_t accessor);
  SharedArray<Vec4> tangents(std::size_t accessor);
  void check_count(std::size_t count, const Mesh& mesh, const JsonView& attribute) const;

  Import& import_;
  std::span<const std::uint64_t> material_uv_sets_;
  std::map<std::size_t, std::vector<Part>> parts_;
  std::map<std::size_t, Positions> positions_;
  std::map<std::size_t, Normals> normals_;
  std::map<std::size_t, SharedArray<Vec2>> uvs_;
  std::map<std::size_t, SharedArray<Vec4>> tangents_;
  std::map<std::tuple<std::size_t, std::size_t, std::uint64_t>, Triangles> triangles_;
  std::size_t lines_and_points_ = 0, without_positions_ = 0, without_joints_ = 0, coloured_ = 0, without_uvs_ = 0, broken_normals_ = 0;
};

}  // namespace sightline::gltf
