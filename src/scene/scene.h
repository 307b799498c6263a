// What a file said: plain data, without method, tracer or threads.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/animation.h"
#include "scene/camera.h"
#include "scene/light.h"
#include "scene/material.h"
#include "scene/mesh.h"

namespace sightline {

/// What a scene file says about how to render it; the command line overrides each.
struct RenderHints {
  std::optional<IVec2> size_px;
  std::optional<int> max_bounces;  ///< indirect bounces
  std::optional<int> spp;
  std::string output;
};

/// A scene as a value: copying is cheap (big arrays are shared), editing a copy leaves the original alone.
struct Scene {
  std::string name;
  std::vector<ImageAsset> images;
  std::vector<Texture> textures;
  std::vector<Medium> media;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Sphere> spheres;
  std::vector<Light> lights;
  std::optional<Environment> environment;
  std::vector<Camera> cameras;
  std::vector<Node> nodes;
  std::vector<Skin> skins;
  RenderHints hints;
  /// What the loaders dropped or could not honour, one line each; also sent to the log when found.
  std::vector<std::string> warnings;
  std::uint64_t dropped_triangles = 0;  ///< degenerate or with non-finite vertices
  float animation_duration_s = 0;
  /// Box that framing looks at, where it is not all geometry (builtin:ground frames its content).
  std::optional<Bounds> framing;
};

/// World-space box of all instances and spheres.
Bounds scene_bounds(const Scene& scene);
/// Number of triangles with instances counted each time.
std::uint64_t instanced_triangle_count(const Scene& scene);
/// Bytes of the mesh arrays and images (shared ones once).
std::uint64_t scene_bytes(const Scene& scene);
/// Parent-from-node matrix at time_s (clamped to the tracks' ends).
Mat4 node_matrix(const Node& node, float time_s);
/// World-from-node matrices of all nodes at time_s (clamped to the tracks' ends).
std::vector<Mat4> node_matrices(const Scene& scene, float time_s);
/// For each node whether it or one of its ancestors is animated.
std::vector<bool> moving_nodes(const Scene& scene);
/// Weights of the morph targets of a node's mesh at time_s; as many as the node has.
std::vector<float> morph_weights(const Node& node, float time_s);
/// The scene with every instance, camera and light that hangs on a node placed and every deformable mesh bent as at time_s. Lights are then
/// in world space and leave their node, so another time is posed from the original scene.
Scene pose(Scene scene, float time_s);
/// A camera that frames `bounds` as docs/conventions.md says: from direction (1, 0.6, 1), 40° on the narrower axis.
Camera framing_camera(const Bounds& bounds);
/// Stable hash of everything that can change a picture: names, warnings and the output's name do not count. A mesh source counts by its
/// name, counts and box.
std::uint64_t scene_hash(const Scene& scene);

}  // namespace sightline
