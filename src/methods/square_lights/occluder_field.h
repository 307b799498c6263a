// How an object hides directions from points around it: tables on concentric spheres, which move with the object.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "base/math/frame.h"
#include "methods/square_lights/distance_table.h"
#include "trace/tracer.h"

namespace sightline::square_lights {

struct OccluderFieldOptions {
  int resolution = 64;  ///< rays along an edge of a table's square
  bool zoom = true;     ///< far shells' tables cover just the occluder; off is the paper
};

/// The sampling of the space around an occluder [Zhou2005].
inline constexpr int kShells = 16, kShellSize = 32;
inline constexpr float kInnerShell = 0.4f, kOuterShell = 6;  ///< in bounding radii
inline constexpr std::size_t kShellPoints = std::size_t{6} * kShellSize * kShellSize;
inline constexpr std::size_t kFieldTables = kShells * kShellPoints;
/// Radius of shell k in bounding radii: logarithmic, so that the occluder's angle changes alike from each to the next.
float shell_radius(int k);

/// Eight tables around a point and their weights, for any number of lights.
struct OccluderSamples {
  std::array<std::size_t, 8> table{};  ///< index into the field's tables
  std::array<float, 8> weight{};       ///< sums to 1
  std::array<Vec3, 8> axis{};          ///< z of each table's frame: from the sample point to the centre
  std::array<float, 8> zoom{};         ///< p is divided by it before the look-up, D multiplied after
  Vec3 axis_here{0, 0, 1};             ///< from the point itself to the centre
  float far_scale = 1;                 ///< beyond the last shell: how much smaller the occluder looks than from there
  float half_angle = 0;                ///< of the occluder's bounding cone
  bool inside = false;                 ///< nearer than the first shell
};

/// A field over bytes that it does not own, in the occluder's own space.
class OccluderField {
 public:
  OccluderField() = default;
  OccluderField(const Vec3& center, float radius, const std::array<float, kShells>& zoom, std::span<const std::int8_t> tables)
      : center_(center), radius_(radius), zoom_(zoom), tables_(tables) {}

  const Vec3& center() const { return center_; }
  float radius() const { return radius_; }
  const std::array<float, kShells>& zoom() const { return zoom_; }
  std::span<const std::int8_t> tables() const { return tables_; }
  TableView table(std::size_t i) const { return TableView(tables_.data() + i * kTableCells, kTableCells); }

  OccluderSamples samples(const Vec3& position) const;
  /// D of the occluder's outline around unit direction c, in plane units of the map whose axis points at the occluder; +1e3 where the light
  /// cannot reach its bounding cone. The scalar definition.
  float distance(const OccluderSamples& samples, const Vec3& c, float r) const;
  /// Visible fraction of the square light (c, r) from `position`.
  float visibility(const Vec3& position, const Vec3& c, float r, Coverage coverage = Coverage::parallel) const;

 private:
  Vec3 center_{0};
  float radius_ = 1;
  std::array<float, kShells> zoom_{};
  std::span<const std::int8_t> tables_;
};

/// Lights as structure of arrays, padded to kLanes with radius 0.
struct LightLanes {
  std::span<const float> x, y, z, r;  ///< centres in the occluder's space, half diagonals on the sphere
};
/// distance() for all lights on the machine's best vectors.
void occluder_distances(const OccluderField& field, const OccluderSamples& samples, const LightLanes& lights, std::span<float> distances);

/// Scale of each shell's tables: what their square covers, 1 = the whole disk.
std::array<float, kShells> shell_zoom(const OccluderFieldOptions& options);
std::uint64_t occluder_field_bytes();
/// All tables of the occluder in `tracer`, whose bounding sphere is (center, radius). Rays that miss the sphere are not traced. Reports
/// progress, stops when cancelled; the same for any number of threads.
AlignedVector<std::int8_t> bake_occluder_field(const Tracer& tracer, const Vec3& center, float radius, const OccluderFieldOptions& options,
                                               RayCounts& rays, const Context& context);

}  // namespace sightline::square_lights
