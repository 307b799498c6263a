// What a LightTable holds, for the files that implement it.
#pragma once

#include "shade/light_table.h"
#include "shade/lights/light_emission.h"
#include "shade/lights/light_kernels.h"
#include "shade/lights/light_lists.h"
#include "shade/lights/power_picker.h"

namespace sightline {

struct LightTable::Impl {
  Impl(const Scene& scene, const TextureSet& texture_set, const Bounds& bounds, const Context& context, const Impl* previous)
      : lists(scene, texture_set, bounds, context, previous && previous->lists.environment ? &*previous->lists.environment : nullptr),
        picker(lists.powers),
        textures(texture_set),
        beam(bounds) {
    for (const FlatEmitter& emitter : lists.emitters) has_textures = has_textures || emitter.is(FlatEmitter::kTextured);
  }

  /// A single light needs no random number.
  LightPicker::Pick pick(const Vec3& position, const Vec3& normal, float u) const {
    if (lists.size() == 1) return {0, picker.probability(position, normal, 0), 0};
    return picker.pick(position, normal, u);
  }
  LightSample sample_light(std::uint32_t light, float selection, const Vec3& position, const Vec2& u) const;
  /// Vector code for lanes whose lights are of one kind that has some; returns how many lanes it did.
  std::size_t sample_lanes(const LightLanes& lanes, std::uint32_t least, std::uint32_t greatest, std::span<const float> u0,
                           std::span<const float> u1, std::size_t first, LightSampleBatch& samples) const;
  void sample_chosen(std::span<const std::uint32_t> light, std::span<const float> selection, const Vec3Batch& position,
                     std::span<const float> u0, std::span<const float> u1, std::size_t first, LightSampleBatch& samples) const;
  Color texture_of(const FlatLight& light, const Vec2& u) const {
    const FlatEmitter& emitter = lists.emitters[light.emitter];
    const Vec2 uv = lists.meshes.uv(emitter, light.primitive, flat_parameters(emitter.flags, u));
    return glm::max(Color(textures.sample(emitter.texture, {.uv = uv})), Color(0));
  }

  LightLists lists;
  PowerPicker picker;
  TextureSet textures;
  LightBeam beam;
  bool has_textures = false;
};

}  // namespace sightline
