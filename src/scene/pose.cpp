#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/deform.h"
#include "scene/key_segment.h"
#include "scene/scene.h"

namespace sightline {
namespace {

Vec4 cubic_spline(const Track& track, const KeySegment& segment) {
  const std::size_t k = 3 * segment.first;
  const Vec4 p0 = track.values[k + 1];
  if (segment.fraction == 0) return p0;
  return hermite(segment, p0, track.values[k + 2], track.values[k + 3], track.values[k + 4]);
}

/// Spherical interpolation along the shorter arc, since q and -q are the same rotation.
Vec4 slerp(Vec4 a, Vec4 b, float t) {
  float cosine = glm::dot(a, b);
  if (cosine < 0) {
    b = -b;
    cosine = -cosine;
  }
  // Nearly equal: sin(angle) would cancel, and the chord is as good as the arc.
  if (cosine > 0.9995f) return a + t * (b - a);
  const float angle = std::acos(cosine);
  return (std::sin((1 - t) * angle) * a + std::sin(t * angle) * b) / std::sin(angle);
}

Vec4 evaluate(const Track& track, float time_s, bool is_rotation) {
  const KeySegment segment = find_segment(track.times_s, time_s);
  switch (track.interpolation) {
    case Interpolation::step:
      return track.values[segment.first];
    case Interpolation::cubic_spline:
      return cubic_spline(track, segment);
    case Interpolation::linear:
      break;
  }
  const Vec4 a = track.values[segment.first];
  if (segment.fraction == 0) return a;
  const Vec4 b = track.values[segment.first + 1];
  return is_rotation ? slerp(a, b, segment.fraction) : a + segment.fraction * (b - a);
}

/// A track is usable only if it has the values that its keys call for.
bool has_keys(const Track& track) {
  const std::size_t per_key = track.interpolation == Interpolation::cubic_spline ? 3 : 1;
  return !track.times_s.empty() && track.values.size() >= per_key * track.times_s.size();
}

Vec3 transform_direction(const Mat4& m, const Vec3& direction) { return normalize_or(transform_vector(m, direction), direction); }

/// Places one kind of light; sizes follow the scale of the node, one-sided emission keeps its side under a reflection.
struct PlaceLight {
  const Mat4& m;
  float determinant = glm::determinant(Mat3(m));

  void operator()(PointLight& light) const { light.position = transform_point(m, light.position); }
  void operator()(SpotLight& light) const {
    light.position = transform_point(m, light.position);
    light.direction = transform_direction(m, light.direction);
  }
  void operator()(DirectionalLight& light) const { light.direction = transform_direction(m, light.direction); }
  void operator()(RectangleLight& light) const { place_flat(light); }
  void operator()(DiskLight& light) const { place_flat(light); }
  void operator()(SphereLight& light) const {
    light.center = transform_point(m, light.center);
    light.radius *= std::cbrt(std::fabs(determinant));
  }
  template <class FlatLight>
  void place_flat(FlatLight& light) const {
    light.center = transform_point(m, light.center);
    light.half_u = transform_vector(m, light.half_u);
    light.half_v = transform_vector(m, light.half_v);
    if (determinant < 0) light.half_v = -light.half_v;
  }
};

}  // namespace

Mat4 node_matrix(const Node& node, float time_s) {
  if (node.has_matrix && !node.is_animated()) return node.matrix;
  Vec3 translation = node.translation, scale = node.scale;
  glm::quat rotation = node.rotation;
  if (has_keys(node.translation_track)) translation = Vec3(evaluate(node.translation_track, time_s, false));
  if (has_keys(node.scale_track)) scale = Vec3(evaluate(node.scale_track, time_s, false));
  if (has_keys(node.rotation_track)) {
    const Vec4 q = evaluate(node.rotation_track, time_s, true);
    rotation = glm::quat(q.w, q.x, q.y, q.z);
  }
  const float length = glm::length(rotation);
  rotation = length > 0 ? rotation / length : glm::quat(1, 0, 0, 0);
  Mat4 matrix = glm::mat4_cast(rotation);
  for (int axis = 0; axis < 3; ++axis) matrix[axis] *= scale[axis];
  matrix[3] = Vec4(translation, 1);
  return matrix;
}

std::vector<Mat4> node_matrices(const Scene& scene, float time_s) {
  std::vector<Mat4> world(scene.nodes.size());
  // Parents come first, so one sweep composes the hierarchy.
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    world[i] = node_matrix(node, time_s);
    if (node.parent.index < i) world[i] = world[node.parent.index] * world[i];
  }
  return world;
}

std::vector<bool> moving_nodes(const Scene& scene) {
  std::vector<bool> moves(scene.nodes.size());
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const Node& node = scene.nodes[i];
    moves[i] = node.is_animated() || (node.parent.index < i && moves[node.parent.index]);
  }
  return moves;
}

Scene pose(Scene scene, float time_s) {
  const std::vector<Mat4> world = node_matrices(scene, time_s);
  for (Instance& instance : scene.instances) {
    if (instance.node.index < world.size()) instance.world_from_object = world[instance.node.index];
  }
  for (Camera& camera : scene.cameras) {
    if (camera.node.index >= world.size()) continue;
    // A camera has no size: scale along the way must not change what it sees (glTF), though a reflection does.
    camera.world_from_camera = world[camera.node.index];
    for (int axis = 0; axis < 3; ++axis) {
      const float length = glm::length(Vec3(camera.world_from_camera[axis]));
      if (length > 0) camera.world_from_camera[axis] /= length;
    }
  }
  for (Light& light : scene.lights) {
    if (light.node.index >= world.size()) continue;
    std::visit(PlaceLight{world[light.node.index]}, light.shape);
    light.node = {};
  }
  for (Mesh& mesh : scene.meshes) {
    if (!mesh.is_deformable()) continue;
    std::vector<float> weights;
    if (mesh.weights_node.index < scene.nodes.size()) weights = morph_weights(scene.nodes[mesh.weights_node.index], time_s);
    std::vector<Mat4> joints;
    if (mesh.skin.index < scene.skins.size()) joints = joint_matrices(scene.skins[mesh.skin.index], world);
    deform(mesh, weights, joints);
  }
  return scene;
}

}  // namespace sightline
