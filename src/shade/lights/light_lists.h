// The lights of a scene sorted by kind, with their powers: what a LightTable samples from.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "base/math/bounds.h"
#include "scene/scene.h"
#include "shade/lights/environment_light.h"
#include "shade/lights/flat_light.h"
#include "shade/lights/mesh_lights.h"
#include "shade/lights/punctual_light.h"
#include "shade/lights/sphere_sampling.h"
#include "texture/texture_set.h"

namespace sightline {

/// Entries are numbered through: rectangles, triangles, disks (all flat); points, directional lights, spots (all punctual); spheres; the
/// environment. Vector code relies on the order: it handles what comes before the disks, and what comes before the spots.
struct LightLists {
  /// `previous` (may be null): the environment of an earlier version of the scene, whose tables are taken over if it was merely turned.
  LightLists(const Scene& scene, const TextureSet& textures, const Bounds& bounds, const Context& context,
             const EnvironmentLight* previous = nullptr);

  AlignedVector<FlatLight> flats;
  std::vector<FlatEmitter> emitters;
  MeshLights meshes;
  std::vector<PunctualLight> punctuals;
  std::vector<SphereEmitter> spheres;
  std::vector<std::uint32_t> light_of_sphere;  ///< per Scene::spheres entry; kNoLight if it does not emit
  std::vector<Sphere> scene_spheres;           ///< for texture coordinates
  std::optional<EnvironmentLight> environment;
  std::vector<float> powers;  ///< W, luminance, per entry

  std::uint32_t disk_begin = 0, punctual_begin = 0, directional_begin = 0, spot_begin = 0, sphere_begin = 0, environment_index = kNoLight;
  std::uint32_t size() const { return static_cast<std::uint32_t>(powers.size()); }
  /// Whether vector code can take any choice of lights together.
  bool is_all_one_kind() const { return disk_begin == size() || (punctual_begin == 0 && spot_begin == size()); }
};

}  // namespace sightline
