// One image with its MIP levels, and texel fetches with wrap modes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "base/math/vec.h"
#include "image/image.h"
#include "scene/texture.h"
#include "texture/texel_codec.h"

namespace sightline {

/// Parallelogram over which a look-up averages: derivatives of (u, v) along the two axes of the pixel.
struct Footprint {
  Vec2 dx{0}, dy{0};
  bool is_point() const { return dx == Vec2(0) && dy == Vec2(0); }
};

/// An image and its levels, in the image's own number type: 8-bit images have 8-bit levels, in the same encoding. Level 0 shares the
/// Image. Levels halve (rounding down, at least 1) under an exact box filter, so that every level keeps the mean. Immutable.
class MipMap {
 public:
  struct Wraps {
    Wrap u = Wrap::repeat, v = Wrap::repeat;
  };

  /// `encoding` applies to the colour channels of integer images; floats and alpha are linear always. Without `with_levels` there is
  /// only level 0. The image must have 1 to 4 channels and as many values as its size says.
  MipMap(std::shared_ptr<const Image> image, ColorEncoding encoding, bool with_levels);

  /// Linear RGBA: grey images spread to RGB, two channels are grey and alpha, without alpha it is 1. (u, v) finite, v = 0 the top row,
  /// texel centres at (i + 0.5) / n. Outside a `black` border every channel is 0.
  Vec4 nearest(const Vec2& uv, Wraps wraps) const;
  Vec4 bilinear(int level, const Vec2& uv, Wraps wraps) const;
  Vec4 trilinear(float level, const Vec2& uv, Wraps wraps) const;
  /// Mean over the footprint: the axes of its ellipse in texels are the singular values of the Jacobian. Up to kProbes trilinear look-ups
  /// of the minor axis' level spread evenly along the major axis; where the ellipse is longer still, the minor axis is widened.
  Vec4 filtered(const Vec2& uv, const Footprint& footprint, Wraps wraps) const;

  static constexpr int kProbes = 8;
  const Vec4& mean() const { return mean_; }
  int level_count() const { return static_cast<int>(levels_.size()); }
  int width(int level) const { return levels_[static_cast<std::size_t>(level)].width; }
  int height(int level) const { return levels_[static_cast<std::size_t>(level)].height; }
  /// Levels and tables, without the shared image.
  std::uint64_t memory_bytes() const;

 private:
  struct Level {
    int width, height;
    Image::Bytes bytes;
    Image::Words words;
    Image::Floats floats;
    const void* texels;  ///< of the vector in use, or of the shared image
  };
  void build_levels(bool keep);
  Vec4 texel(const Level& level, int x, int y) const;
  static int wrapped(int i, int n, Wrap wrap);

  std::shared_ptr<const Image> image_;
  int channels_;
  std::size_t kind_;  ///< index of Image::data
  ByteDecoder bytes_{};
  std::vector<float> srgb_words_;
  std::vector<Level> levels_;
  Vec4 mean_{0};
};

}  // namespace sightline
