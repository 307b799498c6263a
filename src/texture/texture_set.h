// Textures ready to sample: decoded look-up tables, MIP levels, compiled nodes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/core/context.h"
#include "base/math/vec.h"
#include "scene/scene.h"

namespace sightline {

/// Texture coordinates with their footprint: derivatives of uv along the two axes of the pixel or ray cone (0 = finest level).
struct TexturePoint {
  Vec2 uv{0};
  Vec2 duv_dx{0}, duv_dy{0};
};

/// The textures of one Scene. Immutable, shares pixels with the Scene; MIP levels are built on construction. Copies share everything.
class TextureSet {
 public:
  TextureSet();
  /// Throws Error{input} on textures that use themselves, are nested too deep, or whose images cannot be read.
  TextureSet(const Scene& scene, const Context& context);

  /// Linear RGBA of the texture; an invalid id gives (1,1,1,1).
  Vec4 sample(TextureId texture, const TexturePoint& point) const;
  void sample(TextureId texture, std::span<const TexturePoint> points, std::span<Vec4> values) const;
  Color sample(const ColorParam& param, const TexturePoint& point) const {
    return param.texture.valid() ? param.value * Color(sample(param.texture, point)) : param.value;
  }
  float sample(const FloatParam& param, const TexturePoint& point) const;
  /// Mean over the unit square: for light power and material previews.
  Vec4 mean(TextureId texture) const;
  std::uint64_t memory_bytes() const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace sightline
