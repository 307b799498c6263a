#include "visibility/shadow_map/light_maps.h"

#include <bit>
#include <variant>

#include "base/sample/sobol.h"

namespace sightline {
namespace {

// Bits of a float, the same for both zeros.
std::uint32_t bits_of(float x) { return std::bit_cast<std::uint32_t>(x + 0.f); }

struct MappedLight {
  QuerySemantic semantic;
  Vec3 position;
};

}  // namespace

LightMaps::LightMaps(const Scene& scene, const Bounds& bounds, std::uint32_t resolution) {
  std::vector<MappedLight> lights;
  for (const Light& light : scene.lights) {
    if (const auto* point = std::get_if<PointLight>(&light.shape)) lights.push_back({QuerySemantic::point, point->position});
    if (const auto* spot = std::get_if<SpotLight>(&light.shape)) lights.push_back({QuerySemantic::point, spot->position});
    // Queries hold the direction towards the light, as the light table gives it.
    if (const auto* directional = std::get_if<DirectionalLight>(&light.shape))
      lights.push_back({QuerySemantic::direction, Vec3(0) - normalize_or(directional->direction, Vec3(0, -1, 0))});
  }
  slots_.resize(std::bit_ceil(2 * lights.size() + 1));
  for (const MappedLight& light : lights) {
    if (!is_finite(light.position)) continue;
    Slot& slot = slots_[slot_of(light.semantic, light.position)];
    if (slot.map != kNone) continue;
    slot = {static_cast<std::uint32_t>(maps_.size()), light.semantic, light.position};
    maps_.push_back(light.semantic == QuerySemantic::point ? DepthMap::around(light.position, resolution)
                                                           : DepthMap::along(-light.position, bounds, resolution));
  }
}

std::size_t LightMaps::slot_of(QuerySemantic semantic, const Vec3& p) const {
  std::uint32_t hash = hash32(bits_of(p.x) + static_cast<std::uint32_t>(semantic));
  hash = hash32(hash ^ bits_of(p.y));
  hash = hash32(hash ^ bits_of(p.z));
  for (std::size_t i = hash & (slots_.size() - 1);; i = (i + 1) & (slots_.size() - 1)) {
    const Slot& slot = slots_[i];
    if (slot.map == kNone || (slot.semantic == semantic && slot.position == p)) return i;
  }
}

std::uint32_t LightMaps::find(QuerySemantic semantic, const Vec3& position) const {
  if (semantic != QuerySemantic::point && semantic != QuerySemantic::direction) return kNone;
  return slots_[slot_of(semantic, position)].map;
}

std::uint64_t LightMaps::bytes_when_full() const {
  std::uint64_t bytes = 0;
  for (const DepthMap& map : maps_) bytes += map.bytes_when_full();
  return bytes;
}

}  // namespace sightline
