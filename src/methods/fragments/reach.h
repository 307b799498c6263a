// Which pixels a light can reach if nothing is in between, and squares of them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/core/aligned.h"
#include "methods/fragments/area_light.h"
#include "methods/fragments/fragment.h"
#include "methods/fragments/g_buffer.h"

namespace sightline {

/// reached[i] for elements first + [0, count) of `g`: 1 unless the whole light lies below the geometric or the shading normal's horizon, or
/// the point behind the light. The definition is AreaLight::out_of_reach.
void reached_pixels(const GBuffer& g, std::size_t first, std::size_t count, const AreaLight& light, std::uint8_t* reached);

/// cut[i] = 1 where a facet of a smooth surface sees only a part of the light: the two normals differ and some of the light lies below the
/// geometric one's horizon.
void cut_pixels(const GBuffer& g, std::size_t first, std::size_t count, const AreaLight& light, std::uint8_t* cut);

/// One light over one root tile, as a pyramid.
class ReachPyramid {
 public:
  ReachPyramid();
  void build(const GBuffer& g, const RootTile& tile, const AreaLight& light);
  enum class Reach : std::uint8_t { none = 1, all = 2, mixed = 3 };
  /// Of the pixels of a fragment of the tile that are in the picture.
  Reach of(const Fragment& f) const {
    const int m = f.level;
    const auto x = static_cast<std::size_t>((f.x & (kRootSize - 1)) >> m), y = static_cast<std::size_t>((f.y & (kRootSize - 1)) >> m);
    return static_cast<Reach>(levels_[static_cast<std::size_t>(m)][(y << (kRootLevel - m)) + x]);
  }

 private:
  std::array<AlignedVector<std::uint8_t>, kRootLevel + 1> levels_;
};

}  // namespace sightline
