// Lights that are not the emission of a mesh's material.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "base/math/vec.h"
#include "scene/ids.h"
#include "scene/texture.h"

namespace sightline {

struct PointLight {
  Vec3 position{0};
  Color intensity{1};  ///< W/sr
};
struct SpotLight {
  Vec3 position{0};
  Vec3 direction{0, 0, -1};  ///< unit
  Color intensity{1};        ///< W/sr on the axis
  float inner_angle_rad = 0, outer_angle_rad = kPi / 4;
  /// Falloff between the cones: glTF squares a linear ramp of the cosine, pbrt uses smoothstep.
  enum class Falloff { gltf, pbrt } falloff = Falloff::gltf;
};
struct DirectionalLight {
  Vec3 direction{0, -1, 0};  ///< unit, the way light travels
  Color irradiance{1};       ///< W/m² on a surface that faces the light
};
/// One-sided rectangle: corners center ± half_u ± half_v, emits along normalize(cross(half_u, half_v)).
struct RectangleLight {
  Vec3 center{0}, half_u{0.5f, 0, 0}, half_v{0, 0.5f, 0};
  Color radiance{1};  ///< W/(sr·m²)
};
/// One-sided disk with semi-axes half_u, half_v.
struct DiskLight {
  Vec3 center{0}, half_u{0.5f, 0, 0}, half_v{0, 0.5f, 0};
  Color radiance{1};
};
struct SphereLight {
  Vec3 center{0};
  float radius = 1;
  Color radiance{1};
};

/// A light. Rectangles, disks and spheres given here are *not* geometry: camera and bounce rays pass through them, only light sampling
/// sees them (--light-area; a visible emitter is a mesh or Sphere with an emissive material).
struct Light {
  std::string name;
  std::variant<PointLight, SpotLight, DirectionalLight, RectangleLight, DiskLight, SphereLight> shape;
  NodeId node;  ///< valid: `shape` is in this node's space and follows it when the scene is posed
};

/// cube: six square faces of n x n texels below one another (n x 6n), in the order and orientation of shade/cube_map.h; radiance is
/// constant over a texel. The others are read bilinearly.
enum class EnvironmentMapping { latlong, angular, octahedral, cube };

/// Light from infinitely far, from an image or constant.
struct Environment {
  std::shared_ptr<const Image> image;  ///< null: constant `scale`
  std::string name;
  EnvironmentMapping mapping = EnvironmentMapping::latlong;
  Color scale{1};                       ///< multiplies the image; the radiance where there is none
  glm::mat3 world_from_environment{1};  ///< rotation (or reflection) of the image's own frame
};

}  // namespace sightline
