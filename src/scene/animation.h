// Node hierarchy and rigid animation.
#pragma once

#include <string>
#include <vector>

#include "base/core/shared_array.h"
#include "base/math/vec.h"
#include "scene/ids.h"

#include <glm/gtc/quaternion.hpp>

namespace sightline {

enum class Interpolation { step, linear, cubic_spline };

/// Key frames of one property. Cubic splines store (in-tangent, value, out-tangent) per key.
struct Track {
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times_s;  ///< increasing
  std::vector<Vec4> values;    ///< xyz, or a quaternion as xyzw
};

/// Key frames of the weights of morph targets: as many values a key as there are targets (cubic splines: in-tangents, values,
/// out-tangents).
struct WeightsTrack {
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times_s;  ///< increasing
  std::vector<float> values;
};

/// A joint of the hierarchy: local transform as matrix, or as translation-rotation-scale once animated.
struct Node {
  std::string name;
  NodeId parent;  ///< always an earlier node, or invalid
  bool has_matrix = false;
  Mat4 matrix{1};
  Vec3 translation{0};
  glm::quat rotation{1, 0, 0, 0};
  Vec3 scale{1};
  Track translation_track, rotation_track, scale_track;  ///< empty times = not animated
  std::vector<float> weights;                            ///< of the morph targets of the mesh that hangs here, where it has some
  WeightsTrack weights_track;
  /// Whether the transform changes.
  bool is_animated() const { return !translation_track.times_s.empty() || !rotation_track.times_s.empty() || !scale_track.times_s.empty(); }
};

}  // namespace sightline
