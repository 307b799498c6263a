// One frame: lights and occluders where they are now, and the light that vertices or points between them send to the camera.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "film/view.h"
#include "methods/square_lights/error_bound.h"
#include "methods/square_lights/near_lanes.h"
#include "methods/square_lights/shade_lanes.h"
#include "methods/square_lights/square_bake.h"
#include "methods/square_lights/texel_visibility.h"

namespace sightline::square_lights {

/// What shading counted.
struct ShadingCounts {
  std::uint64_t receivers = 0, lights = 0, occluder_tests = 0;
  ShadingCounts& operator+=(const ShadingCounts& o) {
    receivers += o.receivers, lights += o.lights, occluder_tests += o.occluder_tests;
    return *this;
  }
};

/// Immutable once built: the frame's transforms applied to lights, occluders sorted to the receivers and lights that they matter to.
class FrameShading {
 public:
  /// Transforms are those of the scene that `bake` was made for.
  FrameShading(const SquareBake& bake, const SquareLightsSettings& settings, const View& view);

  /// What an occluder may hide from a receiver.
  struct Meeting {
    NearLights near;
    OccluderSamples samples;
  };
  /// Buffers of one thread.
  struct Scratch {
    AlignedVector<float> visible, distance, other, gradient_x, gradient_y;
    ActiveLights active;
    OccluderPlaces places;
    std::vector<Meeting> meetings;  ///< by occluder of the receiver
    LightSet local, turned;         ///< lights listed for one receiver, in world space, and in another
    CutRefiner refiner;
    PlanarOccluder::Seen plane;
    std::vector<PatchLight> patches;
    std::vector<float> patch_distance;
    std::vector<Color> transport;
    std::vector<float> wavelets;
    AlignedVector<std::int8_t> expanded[3];
    std::uint32_t expanded_vertex[3] = {~0u, ~0u, ~0u};
    ShadingCounts counts;
  };
  /// Asks memory for what shade_vertex(i) will read first, while others are shaded.
  void prefetch_vertex(std::uint32_t i) const;
  /// Radiance towards the camera of vertex `i` (of all objects).
  Color shade_vertex(std::uint32_t i, Scratch& scratch) const;
  /// The same at a point within a triangle, by interpolated distances; position and frame in world space.
  Color shade_point(const VertexHit& hit, std::uint32_t object, std::uint32_t material, const Vec3& position, const Frame3& frame,
                    const Vec3& wo, Scratch& scratch) const;
  std::size_t light_count() const { return world_lights_.count; }

 private:
  /// How a receiver's material reflects: a table, and what is too sharp for one.
  struct Reflection {
    const BrdfTable& table;
    const SharpLobe& lobe;
  };
  /// An occluder as a receiver object meets it.
  struct Use {
    const Occluder* occluder = nullptr;
    Mat3 turn{1};              ///< of directions from the receiver's space to the field's
    AlignedVector<float> may;  ///< by light, padded: 1 if any vertex of the receiver may lose some of it, else 0
  };
  struct Receiver {
    Mat4 world_from_object{1}, object_from_world{1};
    LightSet lights;  ///< all, in the object's space
    Vec3 eye{0};      ///< in the object's space, or the direction to the camera
    std::vector<Use> occluders;
    OccluderLanes around;  ///< the same
    bool planes = false;
  };

  void tables_of(std::uint32_t object, const VertexHit& hit, int count, ReceiverTables& tables, Scratch& scratch) const;
  Color lit(const Receiver& receiver, const ReceiverTables& tables, const Vec3& position, const Frame3& frame, const Vec3& wo,
            const Reflection& reflection, Scratch& scratch) const;
  Color lit_locally(std::uint32_t object, const VertexHit& hit, const ReceiverTables& tables, const Vec3& position, const Frame3& frame,
                    const Vec3& wo, const Reflection& reflection, Scratch& scratch) const;
  // For lights listed in scratch.local, with how far away they are in scratch.patch_distance.
  void see_listed(std::uint32_t object, const ReceiverTables& tables, Scratch& scratch) const;
  void hide_listed(std::uint32_t object, const Vec3& world, Scratch& scratch) const;
  Color shade_listed(std::uint32_t object, const Frame3& frame, const Vec3& wo, const Reflection& reflection, Scratch& scratch) const;
  Color reflect(const Frame3& frame, const Vec3& wo, const Reflection& reflection, const LightSet& lights, Scratch& scratch) const;
  Color lit_from_afar(std::uint32_t object, const ReceiverTables& tables, const Vec3& position, const Frame3& frame, const Vec3& wo,
                      const Reflection& reflection, Scratch& scratch) const;
  Color lit_split(std::uint32_t object, const ReceiverTables& tables, const Vec3& position, const Frame3& frame, const Vec3& wo,
                  const Reflection& reflection, Scratch& scratch) const;
  void hide(const Receiver& receiver, const Vec3& position, const Vec3& normal, Scratch& scratch) const;
  Color by_texels(std::uint32_t i, std::uint32_t object, Scratch& scratch) const;
  Vec3 towards_eye(const Receiver& receiver, const Vec3& position) const;
  std::uint32_t object_of(std::uint32_t vertex) const;

  const SquareBake& bake_;
  const SquareLightsSettings& settings_;
  bool orthographic_ = false;
  float plane_scale_ = 0.70710678f;
  Coverage coverage_ = Coverage::parallel;
  LightSet world_lights_;
  ReachLanes reach_;
  std::vector<std::int32_t> cut_;  ///< where lights are split at each receiver: what to start from
  std::vector<Receiver> receivers_;
  std::vector<std::uint32_t> object_of_vertex_;  ///< first vertex of each object, in order
  // lights=all and basis=haar
  TexelDirections directions_;
  std::vector<float> texel_solid_angle_;
  std::array<std::vector<std::pair<std::uint32_t, float>>, 3> terms_;
};

}  // namespace sightline::square_lights
