// Sampling an environment in proportion to its radiance.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "base/math/vec.h"
#include "base/sample/alias_table.h"
#include "scene/light.h"
#include "shade/lights/environment_map.h"

namespace sightline {

/// An Environment, ready: radiance by direction, and a sampler whose density is that of the radiance as it is read (bilinear; of a
/// cube map constant), averaged over the cells of a grid. A row of cells is chosen by an alias table, then a cell in the row by another,
/// then a point within: two small tables keep enough bits of the random numbers for the point, which one table of all cells would not.
class EnvironmentLight {
 public:
  /// `previous` (may be null) lends its tables if the picture is the same and merely turned.
  EnvironmentLight(const Environment& environment, const Context& context, const EnvironmentLight* previous = nullptr);

  /// From unit `direction` in world space.
  Color radiance(const Vec3& direction) const;
  /// From many directions (see LightTable::environment).
  void radiance(const Vec3Batch& direction, std::size_t count, Vec3Batch& colors) const;
  /// A unit direction in world space; the zero vector where the picture has none. Density: pdf(direction).
  Vec3 sample(const Vec2& u) const;
  float pdf(const Vec3& direction) const;
  /// Both at once, the very same values.
  struct Evaluation {
    Color radiance;
    float pdf;
  };
  Evaluation evaluate(const Vec3& direction) const;
  /// Integral of the radiance's luminance over all directions.
  double total_luminance() const { return total_luminance_; }
  std::uint64_t memory_bytes() const;

  /// Pictures with more pixels share cells: importance does not need their resolution. Texels of a cube map never do.
  static constexpr std::uint32_t kMaxCells = 1u << 21;

 private:
  struct Cell {
    std::uint32_t x, y;
  };
  void turn(const Environment& environment);
  void build(const Context& context);
  Cell cell_of(const Vec2& uv) const;
  float pdf_at(const Vec2& uv, const Vec3& local) const;
  bool is_cube() const { return map_->mapping() == EnvironmentMapping::cube; }
  Cell cube_cell(const Vec3& local) const;
  float cube_pdf(Cell cell, const Vec3& local) const;
  /// Borders of a cell in the unit square, lower then upper.
  float column_border(std::uint32_t column) const;
  float row_border(std::uint32_t row) const;

  std::shared_ptr<const Image> picture_;  ///< as it was given
  EnvironmentMapping mapping_ = EnvironmentMapping::latlong;
  Color scale_;
  std::optional<EnvironmentMap> map_;
  Mat3 world_from_local_, local_from_world_;
  std::uint32_t block_ = 1;  ///< pixels along a side of a cell
  std::uint32_t columns_ = 0, rows_ = 0;
  AliasTable row_table_;
  std::vector<AliasTable> column_tables_;  ///< one a row
  std::vector<float> row_cosines_;         ///< latlong: cosine of the polar angle at the borders of rows
  double total_luminance_ = 0;
};

}  // namespace sightline
