// All that the method precomputes for a scene, each part kept under a key of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "bake/bake_store.h"
#include "methods/method.h"
#include "methods/square_lights/brdf_table.h"
#include "methods/square_lights/compressed_tables.h"
#include "methods/square_lights/light_cube.h"
#include "methods/square_lights/local_light.h"
#include "methods/square_lights/merge_tree.h"
#include "methods/square_lights/occluder_field.h"
#include "methods/square_lights/planar_occluder.h"
#include "methods/square_lights/settings.h"
#include "methods/square_lights/shading_scene.h"
#include "methods/square_lights/sharp_lobe.h"
#include "methods/square_lights/source_field.h"
#include "methods/square_lights/texel_exchange.h"

namespace sightline::square_lights {

/// What `lights` asks for.
struct LightChoice {
  enum class Kind { count, all, all_tables } kind = Kind::count;
  std::size_t count = 30;
};
/// Throws Error{usage} for anything but a number from 1, "all" and "all-tables".
LightChoice parse_lights(const std::string& text);

/// Distance tables of an object's vertices, raw or compressed.
struct VertexTables {
  std::shared_ptr<const BakeView> held;
  std::span<const std::int8_t> raw;
  std::optional<CompressedTables> compressed;
  bool empty() const { return raw.empty() && !compressed; }
};

/// What is made of a material: a table, and the lobe that is too sharp for it.
struct MaterialTables {
  BrdfTable brdf;
  SharpLobe lobe;  ///< often empty
  std::uint64_t bytes() const { return brdf.bytes(); }
};

/// Something that hides light from other objects.
struct Occluder {
  std::uint32_t object = 0;  ///< of ShadingScene; for pieces of what stands still the static one
  Mat4 world_from_field{1};
  std::shared_ptr<const BakeView> held;
  OccluderField field;
  std::optional<CompressedTables> compressed;
  AlignedVector<std::int8_t> expanded;  ///< the field's bytes where they are stored compressed
};

/// What stands still where something moves: each member an object of its own, in world space, flat convex ones as polygons.
struct StillPieces {
  struct Piece {
    ShadingObject object;  ///< without vertices
    std::optional<PlanarOccluder> plane;
  };
  std::vector<Piece> pieces;
  std::uint64_t bytes() const { return pieces.size() * sizeof(Piece); }
};
/// None where nothing moves.
StillPieces still_pieces(const Scene& scene, const ShadingScene& shading);

/// A local light in world space, and its table where one is wanted.
struct Source {
  LocalLight light;
  Vec3 origin{0};  ///< of the table's space
  std::shared_ptr<const BakeView> held;
  std::optional<SourceField> field;
};

class SquareBake final : public Bake {
 public:
  SquareBake(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context);
  std::uint64_t bytes() const override { return bytes_; }

  const ShadingScene& scene() const { return scene_; }
  const LightCube& cube() const { return cube_; }
  const MergeTree& tree() const { return tree_; }
  /// The squares that the environment is split into; empty where `lights` is no number, or one of wavelets.
  std::span<const SquareLight> squares() const { return squares_ ? std::span(squares_->lights) : std::span<const SquareLight>(); }
  const Mat3& world_from_environment() const { return world_from_environment_; }
  const VertexTables& tables(std::size_t object) const { return tables_[object]; }
  const std::vector<Occluder>& occluders() const { return occluders_; }
  const std::vector<PlanarOccluder>& planes() const { return planes_; }
  /// Null for materials that no vertex has.
  const BrdfTable* brdf(std::uint32_t material) const;
  /// Empty where a material has no lobe too sharp for its table.
  const SharpLobe& lobe(std::uint32_t material) const { return materials_[slot(material)]->lobe; }
  const Bsdf& bsdf(std::uint32_t material) const { return bsdfs_[slot(material)]; }
  /// What texture-dependent colours are divided by: the albedo of the BSDF that the table was made of.
  Color table_albedo(std::uint32_t material) const { return bsdfs_[slot(material)].albedo(); }
  /// By vertex and texel of the cube map, which of 16 points are visible; only with lights=all or basis=haar.
  std::span<const std::uint16_t> texel_masks() const { return masks_; }
  const std::vector<Source>& sources() const { return sources_; }
  std::size_t source_patches() const { return source_patches_; }
  /// Of the vertices of what stands still, which come first: visible part of each patch, 255 = all. Empty without sources or such vertices.
  std::span<const std::uint8_t> patch_coverage() const { return coverage_; }
  const RayCounts& rays() const { return rays_; }

 private:
  std::size_t slot(std::uint32_t material) const { return material == kDefaultMaterial ? bsdfs_.size() - 1 : material; }
  void make_lights(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context);
  void make_tables(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context);
  void make_occluders(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context);
  void add_occluder(const World& world, const ShadingObject& object, const Mat4& world_from_field, std::uint32_t index,
                    const SquareLightsSettings& settings, BakeStore& store, const Context& context);
  void make_materials(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context);
  void make_sources(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context);
  void make_masks(const World& world, const SquareLightsSettings& settings, BakeStore& store, const Context& context);

  ShadingScene scene_;
  LightCube cube_;
  MergeTree tree_;
  std::shared_ptr<const TexelExchange> squares_;
  Mat3 world_from_environment_{1};
  std::vector<VertexTables> tables_;
  std::vector<Occluder> occluders_;
  std::shared_ptr<const StillPieces> pieces_;
  std::vector<PlanarOccluder> planes_;
  std::vector<std::shared_ptr<const MaterialTables>> materials_;  ///< by material, the default one last
  std::vector<Bsdf> bsdfs_;
  std::shared_ptr<const BakeView> masks_held_;
  std::span<const std::uint16_t> masks_;
  std::vector<Source> sources_;
  std::size_t source_patches_ = 0;
  std::shared_ptr<const BakeView> coverage_held_;
  std::span<const std::uint8_t> coverage_;
  RayCounts rays_;
  std::uint64_t bytes_ = 0;
};

/// Bytes that the tables of a scene take, for the memory budget.
std::uint64_t square_bake_bytes(const Scene& scene, const ShadingScene& shading, const StillPieces& pieces,
                                const SquareLightsSettings& settings);

}  // namespace sightline::square_lights
