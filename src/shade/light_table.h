// All lights of a scene, ready to be sampled.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "base/math/bounds.h"
#include "base/sample/alias_table.h"
#include "scene/scene.h"
#include "texture/texture_set.h"

namespace sightline {

struct FlatLight;
struct FlatEmitter;

/// An entry of the table: one point, spot, directional, rectangle, disk or sphere light, one emissive triangle, or the environment.
inline constexpr std::uint32_t kNoLight = 0xffffffffu;

/// A point on a light as seen from a shading point.
struct LightSample {
  Vec3 wi{0, 0, 1};       ///< unit direction towards the light
  float distance = 0;     ///< to the light point; +infinity for directional lights and environments
  Vec3 point{0};          ///< on the light (finite lights)
  Vec3 normal{0};         ///< of the emitting surface; 0 for points, directional lights and environments
  float point_error = 0;  ///< absolute bound on the rounding error of `point`
  Color radiance{0};      ///< arriving, unoccluded; for delta lights intensity / distance² or irradiance
  float pdf = 0;          ///< solid angle, selection included; selection probability alone for delta lights; 0 = no sample
  bool is_delta = false;
  bool is_mesh = false;  ///< on geometry that rays can hit (MIS with BSDF sampling applies)
  std::uint32_t light = kNoLight;
};

/// Many light samples, structure of arrays (padded to kLanes).
struct LightSampleBatch {
  Vec3Batch wi, point, normal, radiance;
  AlignedVector<float> distance, point_error, pdf;
  AlignedVector<std::uint8_t> is_delta, is_mesh;
  AlignedVector<std::uint32_t> light;
  void resize(std::size_t n);
  /// Writes samples from index `first` on. Whole groups of kLanes are kind to the cache: single lanes of twenty arrays that happen to lie a
  /// multiple of 4 KiB apart would throw each other out.
  void set(std::size_t first, std::span<const LightSample> samples);
};

/// Densities of a ray that leaves a light. For lights at infinity the first is that of the direction and the second that of the place
/// across the beam, since there the direction comes first.
struct EmissionPdf {
  float start = 0;  ///< of the point, by area, selection included; selection alone for delta lights; by solid angle at infinity
  float leave = 0;  ///< of the direction, by solid angle; by area across the beam at infinity
};

/// A ray that leaves a light.
struct EmissionSample {
  Vec3 point{0};              ///< on the light; at infinity where the ray enters the scene's bounding sphere
  Vec3 normal{0};             ///< of the emitting surface; 0 for points and lights at infinity
  Vec3 direction{0, 0, 1};    ///< unit, the way light travels
  float point_error = 0;      ///< absolute bound on the rounding error of `point`
  Color radiance{0};          ///< radiance; intensity of points and spots, irradiance of directional lights
  EmissionPdf pdf;            ///< both 0 = no sample
  bool is_delta = false;      ///< a point or a single direction: no ray finds it
  bool is_infinite = false;   ///< directional light or environment
  bool is_mesh = false;       ///< on geometry that rays can hit
  bool is_two_sided = false;  ///< emits on both sides of `normal`
  std::uint32_t light = kNoLight;
};

/// How a light is chosen for a shading point: an interface, so that smarter choices can replace choice by power.
class LightPicker {
 public:
  struct Pick {
    std::uint32_t light = kNoLight;
    float probability = 0;
    float u = 0;  ///< the random number stretched back to [0,1)
  };
  virtual ~LightPicker() = default;
  virtual Pick pick(const Vec3& position, const Vec3& normal, float u) const = 0;
  virtual float probability(const Vec3& position, const Vec3& normal, std::uint32_t light) const = 0;
};

/// Some of a table's lights, chosen by their power: for methods that treat kinds of light in different ways.
struct LightSubset {
  enum Kinds : std::uint32_t { kArea = 1, kPunctual = 2, kEnvironment = 4 };
  std::vector<std::uint32_t> entries;
  AliasTable choice;  ///< over all entries of the table; those left out have weight 0
  bool empty() const { return entries.empty(); }
};

/// Immutable once built. Thread-safe.
class LightTable {
 public:
  /// `bounds` are the scene's (for powers of directional lights and environments).
  /// `previous` (may be null) is the table of an earlier version of the scene: an environment that was merely turned keeps its samplers.
  LightTable(const Scene& scene, const TextureSet& textures, const Bounds& bounds, const Context& context,
             const LightTable* previous = nullptr);
  ~LightTable();

  std::size_t size() const;  ///< entries, environment included
  bool has_environment() const;
  /// Chooses a light by `u_pick` (not read if there is only one) and a point on it by `u`. pdf 0 where the light cannot reach `position`.
  /// `normal` = 0 allowed.
  LightSample sample(const Vec3& position, const Vec3& normal, float u_pick, const Vec2& u) const;
  /// The same for many points; random numbers as arrays (`u_pick` may hold anything if there is only one light). Grows `samples` if needed.
  /// On every SIMD target bit for bit what the single call gives.
  void sample(const Vec3Batch& position, const Vec3Batch& normal, std::span<const float> u_pick, std::span<const float> u0,
              std::span<const float> u1, std::size_t count, LightSampleBatch& samples) const;
  /// Lights of the given kinds (LightSubset::Kinds, or-ed) that have power.
  LightSubset subset(std::uint32_t kinds) const;
  /// The batch call of sample() for lights of a subset alone: densities contain the choice within it.
  void sample(const LightSubset& subset, const Vec3Batch& position, const Vec3Batch& normal, std::span<const float> u_pick,
              std::span<const float> u0, std::span<const float> u1, std::size_t count, LightSampleBatch& samples) const;
  /// Points on lights that the caller chose: entry light[i] for lane i, with its probability. Not for empty tables.
  void sample_entries(std::span<const std::uint32_t> light, std::span<const float> selection, const Vec3Batch& position,
                      std::span<const float> u0, std::span<const float> u1, std::size_t count, LightSampleBatch& samples) const;
  /// A point on one light. `selection` is multiplied into the density.
  LightSample sample_light(std::uint32_t light, float selection, const Vec3& position, const Vec2& u) const;
  /// Entry of an emissive triangle (HitBatch::instance, primitive), or of a sphere with kSphereBit; kNoLight if it does not emit.
  std::uint32_t light_of(std::uint32_t instance, std::uint32_t primitive) const;
  /// Density with which sample() would have produced the point that a ray from `position` along unit `direction` hit on entry `light`.
  float pdf(const Vec3& position, const Vec3& normal, std::uint32_t light, const Vec3& hit_point, const Vec3& hit_normal,
            const Vec3& direction) const;
  /// Radiance emitted by a hit entry towards -direction, at texture point `point`.
  Color emission(std::uint32_t light, const TexturePoint& point, bool front_side) const;
  /// Radiance of the environment from unit `direction` (0 without one) and the density of sampling it.
  Color environment(const Vec3& direction) const;
  /// Radiance from `count` unit directions; grows `radiance` if needed. What the single call gives, but for the last digits of the angles
  /// by which maps of latitude and longitude are read.
  void environment(const Vec3Batch& direction, std::size_t count, Vec3Batch& radiance) const;
  /// Density of sampling it once it has been chosen.
  float environment_density(const Vec3& direction) const;
  float environment_pdf(const Vec3& position, const Vec3& normal, const Vec3& direction) const;
  /// A ray that leaves a light chosen by its power; `u_pick` is not read if there is only one light.
  EmissionSample sample_emission(float u_pick, const Vec2& u_point, const Vec2& u_direction) const;
  /// Densities with which sample_emission() would have produced the ray from `point` of entry `light` along unit `direction`.
  EmissionPdf emission_pdf(std::uint32_t light, const Vec3& point, const Vec3& direction) const;
  std::uint32_t environment_entry() const;  ///< kNoLight without one
  /// Surface of an area light that may be seen from one side, world units²; 0 for others.
  float area(std::uint32_t light) const;
  /// Total power by entry, W, as the picker sees it.
  float power(std::uint32_t light) const;
  /// A rectangle, triangle or disk; null for other lights. (See lights/flat_light.h.)
  const FlatLight* flat(std::uint32_t light) const;
  const FlatEmitter* flat_emitter(std::uint32_t light) const;

 private:
  struct Impl;
  void sample_by(const AliasTable& choice, std::optional<std::uint32_t> only, const Vec3Batch& position, const Vec3Batch& normal,
                 std::span<const float> u_pick, std::span<const float> u0, std::span<const float> u1, std::size_t count,
                 LightSampleBatch& samples) const;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace sightline
