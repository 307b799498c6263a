// Images and texture nodes as scene files describe them; sampling them is the business of src/texture.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include "base/math/vec.h"
#include "image/image.h"
#include "scene/ids.h"

namespace sightline {

enum class ColorEncoding { srgb, linear };
enum class Wrap { repeat, clamp, mirror, black };
enum class TextureFilter { nearest, linear, trilinear };  ///< trilinear: MIP mapped with the ray footprint

/// A picture as stored: 8-bit images stay 8-bit and are decoded on look-up.
struct ImageAsset {
  std::string name;                    ///< file it came from, for messages
  std::shared_ptr<const Image> image;  ///< never null once loaded
};

/// Affine map of texture coordinates: uv' = matrix * uv + offset (KHR_texture_transform, pbrt's uscale/vscale).
struct UvTransform {
  glm::mat2 matrix{1};
  Vec2 offset{0};
};

struct ImageTexture {
  ImageId image;
  ColorEncoding encoding = ColorEncoding::srgb;
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  TextureFilter filter = TextureFilter::trilinear;
  UvTransform uv;
  float scale = 1;
  bool invert = false;  ///< 1 - value (pbrt)
};
struct ConstantTexture {
  Vec4 value{1};
};
struct CheckerboardTexture {
  TextureId even, odd;  ///< colours of the two fields
  UvTransform uv;       ///< after it, fields are unit squares
};
struct ScaleTexture {
  TextureId texture, factor;
};
struct MixTexture {
  TextureId first, second, amount;  ///< (1 - amount) first + amount second
};

struct Texture {
  std::string name;
  std::variant<ConstantTexture, ImageTexture, CheckerboardTexture, ScaleTexture, MixTexture> node;
};

/// A material parameter: a constant, times a texture if one is set. Scalars take the texture's channel `channel`
/// (0..3 = r, g, b, a; kLuminance = their mean).
struct ColorParam {
  Color value{1};
  TextureId texture;
  ColorParam() = default;
  ColorParam(Color v) : value(v) {}
  ColorParam(float v) : value(v) {}
};
struct FloatParam {
  static constexpr int kMean = -1;
  float value = 1;
  TextureId texture;
  int channel = kMean;
  FloatParam() = default;
  FloatParam(float v) : value(v) {}
};

}  // namespace sightline
