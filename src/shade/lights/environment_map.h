// Directions to pixels of an environment picture and back.
#pragma once

#include <memory>

#include "base/core/context.h"
#include "base/math/vec.h"
#include "scene/light.h"

namespace sightline {

/// The mappings between the unit square of the picture (v = 0 the top row) and directions in the environment's own frame:
///   latlong     +Y is the top row, -Z the centre column, +X to its right (u = 3/4);
///   angular     -Z is the centre, the distance from it proportional to the angle, +X right, +Y up; corners show nothing [Debevec1998];
///   octahedral  equal areas [Clarberg2008]: +Z is the centre, -Z the corners, +X right (u = 1), +Y down (v = 1), as pbrt-v4 has it;
///   cube        six faces below one another as in shade/cube_map.h, each a sixth of the picture's height.
Vec2 environment_uv(EnvironmentMapping mapping, const Vec3& direction);
/// Unit direction; for `angular` outside the inscribed disk the zero vector.
Vec3 environment_direction(EnvironmentMapping mapping, const Vec2& uv);

/// A picture that lights from infinitely far, in its own frame, read bilinearly between texel centres; that of a cube is constant over
/// each texel.
class EnvironmentMap {
 public:
  /// 8- and 16-bit pictures are taken as sRGB. Negative and non-finite values become 0, with one warning. Throws Error{input}
  /// where a cube is not six times as high as wide.
  EnvironmentMap(std::shared_ptr<const Image> image, EnvironmentMapping mapping, const Context& context);

  Color radiance(const Vec3& direction) const {
    if (mapping_ == EnvironmentMapping::cube) {
      const IVec2 place = cube_texel(direction);
      return texel(place.x, place.y);
    }
    return radiance_uv(environment_uv(mapping_, direction));
  }
  /// Of a cube: the texel that a direction falls into.
  IVec2 cube_texel(const Vec3& direction) const;
  Color radiance_uv(const Vec2& uv) const;
  /// Stored colour; coordinates one beyond the edges are taken where the mapping continues there.
  Color texel(int x, int y) const;
  int width() const { return image_->width; }
  int height() const { return image_->height; }
  EnvironmentMapping mapping() const { return mapping_; }
  /// Interleaved floats, row by row.
  const float* values() const { return values_; }
  int channels() const { return channels_; }

 private:
  std::shared_ptr<const Image> image_;  ///< floats
  EnvironmentMapping mapping_;
  const float* values_;
  int channels_;
};

}  // namespace sightline
