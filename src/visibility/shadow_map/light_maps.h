// The depth maps of a scene's lights, and which of them serves the light end of a query.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"
#include "visibility/query_batch.h"
#include "visibility/shadow_map/depth_map.h"

namespace sightline {

/// One map for each distinct point, spot or directional light. Lights are told apart by the bits of their position or direction, which
/// queries of QuerySemantic::point and direction carry.
class LightMaps {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  LightMaps(const Scene& scene, const Bounds& bounds, std::uint32_t resolution);

  const std::vector<DepthMap>& maps() const { return maps_; }
  /// The map for a light end, or kNone: areas, environments, and lights that are not the scene's.
  std::uint32_t find(QuerySemantic semantic, const Vec3& position) const;
  std::uint64_t bytes_when_full() const;

 private:
  struct Slot {
    std::uint32_t map = kNone;
    QuerySemantic semantic{};
    Vec3 position{0};
  };
  /// The slot that holds the light, or the empty one where it belongs.
  std::size_t slot_of(QuerySemantic semantic, const Vec3& position) const;

  std::vector<DepthMap> maps_;
  std::vector<Slot> slots_;  ///< open addressing, a power of two, at most half full
};

}  // namespace sightline
