// The emissive triangles of a scene as flat lights; pairs that make a parallelogram are one.
#pragma once

#include <cstdint>
#include <vector>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "base/core/shared_array.h"
#include "scene/scene.h"
#include "shade/lights/flat_light.h"
#include "texture/texture_set.h"

namespace sightline {

/// Emissive triangles of all instances, with what is needed to find a hit triangle's light and a light's texture coordinates.
class MeshLights {
 public:
  /// Appends lights and their powers (luminance, W) for every triangle with an emissive material, or two that follow each other and make
  /// a parallelogram without texture. An instance whose materials all emit and that has no such pairs gets one light a triangle in order
  /// (degenerate ones have power 0), so that the index of a hit is a sum.
  MeshLights() = default;
  MeshLights(const Scene& scene, const TextureSet& textures, const Context& context, AlignedVector<FlatLight>& lights,
             std::vector<FlatEmitter>& emitters, std::vector<float>& powers);

  /// kNoLight where the triangle does not emit.
  std::uint32_t light_of(std::uint32_t instance, std::uint32_t primitive) const;
  /// Texture coordinates of the point a e1 + b e2 of a light.
  Vec2 uv(const FlatEmitter& emitter, std::uint32_t primitive, const Vec2& ab) const;
  std::uint64_t memory_bytes() const;

 private:
  /// Where an instance's lights stand. `index_of` is empty if each triangle has one.
  struct Source {
    std::uint32_t first = kNoLight;
    std::vector<std::uint32_t> index_of;  ///< per primitive: offset from `first`, or kNoLight
    SharedArray<UVec3> triangles;
    SharedArray<Vec2> uvs;
  };
  void add_instance(const Scene& scene, const TextureSet& textures, const Context& context, std::size_t instance,
                    AlignedVector<FlatLight>& lights, std::vector<FlatEmitter>& emitters, std::vector<float>& powers);

  std::vector<Source> sources_;  ///< per instance; empty if nothing emits
};

/// Emission of a material that can be used: finite, not black, of a surface; else black.
Color usable_emission(const Scene& scene, MaterialId material);

}  // namespace sightline
