// Skins, morph targets, and what else bends a mesh.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "scene/load/gltf/import.h"
#include "scene/load/gltf/nodes.h"

namespace sightline::gltf {

/// Number of morph targets of a glTF mesh: that of its first primitive, since all have as many.
std::size_t morph_target_count(const JsonView& mesh);
/// Weights of the targets of a node's mesh: the node's own, else the mesh's, else zeros; empty where there are none.
std::vector<float> default_weights(Import& import, const JsonView& node);

/// Targets and joints of a primitive, without the arrays at rest.
struct PrimitiveDeformation {
  Deformation deformation;
  std::uint32_t largest_joint = 0;  ///< of those with a weight
  bool bends() const { return !deformation.targets.empty() || deformation.influences > 0; }
};
PrimitiveDeformation read_deformation(Import& import, const JsonView& primitive, std::size_t vertex_count);
/// Keeps only the given vertices.
void keep_vertices(Deformation& deformation, std::span<const std::uint32_t> kept);

/// Reads skins when a node first uses them.
class SkinImporter {
 public:
  SkinImporter(Import& import, const NodeMap& nodes) : import_(import), nodes_(nodes) {}

  /// The skin that `reference` points to; nothing if one of its joints is not in the scene that is shown.
  std::optional<SkinId> skin(const JsonView& reference);
  void warn_of_losses() const;

 private:
  std::optional<SkinId> read(const JsonView& json);

  Import& import_;
  const NodeMap& nodes_;
  std::map<std::size_t, std::optional<SkinId>> skins_;
  std::size_t jointless_ = 0;
};

}  // namespace sightline::gltf
