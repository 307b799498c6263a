// Texture nodes compiled to straight-line programs.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "scene/texture.h"
#include "texture/mip_map.h"
#include "texture/texture_set.h"

namespace sightline {

/// One step: a node whose operands are results of earlier steps (registers).
struct TextureStep {
  struct Constant {
    Vec4 value;
  };
  struct Lookup {
    const MipMap* map;
    TextureFilter filter;
    MipMap::Wraps wraps;
    UvTransform uv;
    float scale;
    bool invert;
  };
  struct Checkerboard {
    std::uint32_t even, odd;
    UvTransform uv;
  };
  struct Scale {
    std::uint32_t texture, factor;
  };
  struct Mix {
    std::uint32_t first, second, amount;
  };
  std::variant<Constant, Lookup, Checkerboard, Scale, Mix> node;
};

/// A texture as a list of steps in which every node of its graph stands once, after its operands; the last is the value. So a graph that
/// uses a node many times costs one evaluation of it, and no evaluation recurses.
class TextureProgram {
 public:
  static constexpr std::size_t kMaxNodes = 63;
  static constexpr std::size_t kMaxSteps = kMaxNodes + 1;  ///< one more for the white of missing operands

  /// `maps` holds for every texture its MIP map, null for other nodes. Throws Error{input} on a cycle, an operand that does not exist, or
  /// more than kMaxNodes nodes.
  static TextureProgram compile(std::span<const Texture> textures, std::span<const std::shared_ptr<const MipMap>> maps, TextureId root);

  Vec4 evaluate(const TexturePoint& point) const;
  /// Mean over the unit square: exact for images that repeat and for checkerboards, a product or mix of means for nodes above them.
  Vec4 mean() const;
  std::uint64_t memory_bytes() const { return steps_.size() * sizeof(TextureStep); }

 private:
  std::vector<TextureStep> steps_;
};

}  // namespace sightline
