#include "scene/deform.h"

#include <algorithm>

#include "scene/key_segment.h"

namespace sightline {
namespace {

/// Adds the displacements of all targets; `displacements` picks one array of a target.
template <class T, class Displacements>
void add_targets(std::span<T> values, const Deformation& deformation, std::span<const float> weights, const Displacements& displacements) {
  for (std::size_t k = 0; k < std::min(weights.size(), deformation.targets.size()); ++k) {
    const SharedArray<Vec3>& array = displacements(deformation.targets[k]);
    if (weights[k] == 0 || array.size() != values.size()) continue;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Vec3 d = weights[k] * array[i];
      values[i].x += d.x;
      values[i].y += d.y;
      values[i].z += d.z;
    }
  }
}

Mat4 blended(const Deformation& d, std::size_t vertex, std::span<const Mat4> world_from_rest) {
  Mat4 sum(0);
  for (std::size_t k = vertex * d.influences; k < (vertex + 1) * d.influences; ++k) {
    const float weight = d.joint_weights[k];
    if (weight != 0) sum += weight * world_from_rest[d.joints[k]];
  }
  return sum;
}

/// Cross products of the columns: the inverse transpose times the determinant. It needs no inverse, and turns normals round exactly where
/// the winding of the triangles turns round.
Mat3 cofactors(const Mat4& m) {
  const Vec3 x(m[0]), y(m[1]), z(m[2]);
  return {glm::cross(y, z), glm::cross(z, x), glm::cross(x, y)};
}

}  // namespace

std::vector<Mat4> joint_matrices(const Skin& skin, std::span<const Mat4> world_from_node) {
  std::vector<Mat4> matrices(skin.joints.size(), Mat4(1));
  for (std::size_t j = 0; j < matrices.size(); ++j) {
    if (skin.joints[j].index < world_from_node.size()) matrices[j] = world_from_node[skin.joints[j].index];
    if (j < skin.joint_from_rest.size()) matrices[j] = matrices[j] * skin.joint_from_rest[j];
  }
  return matrices;
}

void deform(Mesh& mesh, std::span<const float> target_weights, std::span<const Mat4> world_from_rest) {
  const Deformation& d = *mesh.deformation;
  const std::size_t count = d.positions.size();
  const bool skinned = !world_from_rest.empty() && d.influences > 0;
  const bool has_normals = d.normals.size() == count, has_tangents = d.tangents.size() == count;

  std::vector<Vec3> normals(d.normals.begin(), d.normals.end());
  std::vector<Vec4> tangents(d.tangents.begin(), d.tangents.end());
  add_targets(std::span(normals), d, target_weights, [](const MorphTarget& t) -> const auto& { return t.normals; });
  add_targets(std::span(tangents), d, target_weights, [](const MorphTarget& t) -> const auto& { return t.tangents; });

  Bounds bounds;
  mesh.positions = SharedArray<Vec3>::make(count, [&](std::span<Vec3> positions) {
    std::copy(d.positions.begin(), d.positions.end(), positions.begin());
    add_targets(positions, d, target_weights, [](const MorphTarget& t) -> const auto& { return t.positions; });
    for (std::size_t i = 0; i < count; ++i) {
      if (skinned) {
        const Mat4 world = blended(d, i, world_from_rest);
        positions[i] = transform_point(world, positions[i]);
        if (has_normals) normals[i] = cofactors(world) * normals[i];
        if (has_tangents) tangents[i] = Vec4(transform_vector(world, Vec3(tangents[i])), tangents[i].w);
      }
      if (!is_finite(positions[i])) positions[i] = d.positions[i];
      if (has_normals) normals[i] = normalize_or(normals[i], d.normals[i]);
      if (has_tangents) tangents[i] = Vec4(normalize_or(Vec3(tangents[i]), Vec3(d.tangents[i])), tangents[i].w);
    }
    // Over the triangles, as the loaders have it: vertices that none of them uses do not show.
    for (const UVec3& t : mesh.triangles) {
      for (int corner = 0; corner < 3; ++corner) bounds.add(positions[t[corner]]);
    }
  });
  mesh.normals = SharedArray<Vec3>(normals);
  mesh.tangents = SharedArray<Vec4>(tangents);
  mesh.bounds = bounds;
}

std::vector<float> morph_weights(const Node& node, float time_s) {
  const WeightsTrack& track = node.weights_track;
  const std::size_t count = node.weights.size();
  const bool cubic = track.interpolation == Interpolation::cubic_spline;
  if (track.times_s.empty() || track.values.size() < (cubic ? 3 : 1) * count * track.times_s.size()) return node.weights;
  const KeySegment segment = find_segment(track.times_s, time_s);
  std::vector<float> weights(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (cubic) {
      // Within a key: all in-tangents, then all values, then all out-tangents.
      const float* key = &track.values[3 * segment.first * count];
      weights[i] = key[count + i];
      if (segment.fraction != 0) weights[i] = hermite(segment, weights[i], key[2 * count + i], key[3 * count + i], key[4 * count + i]);
    } else {
      const float* key = &track.values[segment.first * count];
      weights[i] = key[i];
      if (segment.fraction != 0 && track.interpolation == Interpolation::linear) {
        weights[i] += segment.fraction * (key[count + i] - key[i]);
      }
    }
  }
  return weights;
}

}  // namespace sightline
