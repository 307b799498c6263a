// How an object hides directions from points around it: tables on concentric spheres, which move with the object.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "base/math/frame.h"
#include "methods/square_lights/distance_table.h"
#include "methods/square_lights/occluder_place.h"
#include "trace/tracer.h"

namespace sightline::square_lights {

struct OccluderFieldOptions {
  int resolution = 64;  ///< rays along an edge of a table's square
  bool zoom = true;     ///< far shells' tables cover just the occluder; off is the paper
  float solid = 0;      ///< radius of a ball about the centre within a solid object (solid_ball.h): rays into it are known to be hidden
};

inline constexpr std::size_t kShellPoints = std::size_t{6} * kShellSize * kShellSize;
inline constexpr std::size_t kFieldTables = kShells * kShellPoints;
/// Unit direction from the centre to the point of a shell that table `i` belongs to.
Vec3 shell_direction(std::size_t i);
/// Scale of each shell's tables: what half the edge of their square stands for on the disk; 1 = the whole disk.
std::array<float, kShells> shell_zoom(const OccluderFieldOptions& options);

/// Distance where a light cannot reach the occluder.
inline constexpr float kBeyondOccluder = 1e3f;

/// The tables around a point, for any number of lights. Each has a frame of its own, turned from that of the point by the least rotation
/// between their axes, which on the disk is a turn about its centre: p in cells of table i is turn * p, counted from the middle.
struct OccluderSamples {
  alignas(32) std::array<std::int32_t, 8> table{};  ///< index into the field's tables
  alignas(32) std::array<float, 8> turn_x{};        ///< cosine, times cells per plane unit
  alignas(32) std::array<float, 8> turn_y{};        ///< sine, times the same
  alignas(32) std::array<float, 8> code_unit{};     ///< plane units per code of a distance, times the table's weight
  alignas(32) std::array<float, 8> cell_unit{};     ///< plane units per cell, times the table's weight
  Frame3 frame;                                     ///< at the point itself; z is towards the centre
  float sin_half = 0, cos_half = 1;                 ///< of half the angle of the bounding cone; sin_half = 2 where it is all around
  float hidden_area = 0;                            ///< at most this much of the disk is hidden
  bool inside = false;                              ///< nearer than the first shell
};

/// A field over bytes that it does not own, in the occluder's own space. kTableSlack bytes after the tables must be readable.
class OccluderField {
 public:
  OccluderField() = default;
  OccluderField(const Vec3& center, float radius, const std::array<float, kShells>& zoom, std::span<const std::int8_t> tables);
  /// Finds how much of its disk each table hides, by which D is bounded; without it the bounding sphere's outline serves.
  void measure(const Context& context);
  /// What measure() found earlier, by table, over memory of the caller.
  void use_hidden(std::span<const float> hidden) { hidden_ = hidden; }
  std::span<const float> hidden() const { return hidden_; }

  const Vec3& center() const { return center_; }
  float radius() const { return radius_; }
  const std::array<float, kShells>& zoom() const { return zoom_; }
  std::span<const std::int8_t> tables() const { return tables_; }
  /// Asks memory for a table that will be looked into soon.
  void prefetch(std::int32_t table) const;
  TableView table(std::size_t i) const { return TableView(tables_.data() + i * kTableCells, kTableCells); }

  OccluderSamples samples(const Vec3& position) const { return samples(occluder_place((position - center_) / radius_)); }
  OccluderSamples samples(const OccluderPlace& place) const;
  /// D of the occluder's outline around unit direction c, in plane units of the map whose axis points at the occluder; kBeyondOccluder
  /// where the light cannot reach its bounding cone. Never so low that Eq. 9 would hide more of the square than the occluder's whole area.
  /// The scalar definition.
  float distance(const OccluderSamples& samples, const Vec3& c, float r) const;
  /// Visible fraction of the square light (c, r) from `position`.
  float visibility(const Vec3& position, const Vec3& c, float r, Coverage coverage = Coverage::parallel) const;

 private:
  Vec3 center_{0};
  float radius_ = 1;
  std::array<float, kShells> zoom_{};
  std::span<const std::int8_t> tables_;
  std::span<const float> hidden_;  ///< by table: hidden part of its square
  std::shared_ptr<const std::vector<float>> measured_;
};

/// Lights as structure of arrays, padded to kLanes.
struct LightLanes {
  std::span<const float> x, y, z, r;  ///< centres in the occluder's space, half diagonals on the sphere
  std::size_t count = 0;              ///< of lights that are asked about
};
/// distance() for all lights on the machine's best vectors; `distances` as long as they are padded.
void occluder_distances(const OccluderField& field, const OccluderSamples& samples, const LightLanes& lights, std::span<float> distances);

/// As many tables as `tables` has room for, from number `first` on.
void bake_occluder_tables(const Tracer& tracer, const Vec3& center, float radius, const OccluderFieldOptions& options, std::size_t first,
                          std::span<std::int8_t> tables, RayCounts& rays, const Context& context);
/// Bytes that the result of a bake takes.
std::uint64_t occluder_field_bytes();
/// All tables of the occluder in `tracer`, whose bounding sphere is (center, radius). Rays that miss the sphere are not traced. Reports
/// progress, stops when cancelled; the same for any number of threads.
AlignedVector<std::int8_t> bake_occluder_field(const Tracer& tracer, const Vec3& center, float radius, const OccluderFieldOptions& options,
                                               RayCounts& rays, const Context& context);

}  // namespace sightline::square_lights
