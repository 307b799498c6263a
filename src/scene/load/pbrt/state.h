// What directives set and AttributeBegin/End save and restore.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "scene/load/pbrt/parameters.h"
#include "scene/load/pbrt/spectrum.h"

namespace sightline::pbrt {

using Mat4d = glm::dmat4;
using Mat3d = glm::dmat3;

/// A slot of the builder's table of materials, area lights or objects; -1 = none.
using Slot = int;
inline constexpr Slot kNoSlot = -1;

/// Default parameters by the directive they are for: "shape", "light", "material", "medium", "texture".
using DefaultParameters = std::map<std::string, std::vector<Parameter>, std::less<>>;

struct GraphicsState {
  Mat4d world_from_object{1};  ///< pbrt's current transformation matrix
  bool reverse_orientation = false;
  bool transforms_at_start = true;  ///< ActiveTransform: false while only the end time is addressed
  Slot material = kNoSlot;
  Slot area_light = kNoSlot;
  std::string inside_medium, outside_medium;
  ColorSpace color_space = ColorSpace::srgb;
  /// Attribute "shape" ... and so on; shared, because a file may nest deeply.
  std::shared_ptr<const DefaultParameters> defaults;
};

}  // namespace sightline::pbrt
