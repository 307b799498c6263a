// From samples on fragments to a value at every pixel by interpolation.
#pragma once

#include <span>

#include "methods/fragments/g_buffer.h"
#include "methods/fragments/light_signal.h"

namespace sightline {

struct UpsampleOptions {
  enum class Kind {
    rbf,        ///< radial basis functions whose variance adapts to the levels of their samples [Koa2017, Eqs. 4-9]
    rbf_fixed,  ///< the same with C = 1 and distances in widths of the texel's fragment
    multipass,  ///< level by level, bilinear [Nichols2010]
    quad4,      ///< radial basis functions over the corners of the texel's quadrant; of probes: continuous patches (upsample_patch.h)
  };
  Kind kind = Kind::rbf;
  int copy_levels = 2;  ///< fragments up to this level are not interpolated: each pixel takes its quadrant's value
  bool interpolate_probes =
      false;  ///< the four quadrant samples are samples of their own; else their mean is the fragment's, at its centre
};

/// Writes the signal of every pixel of `tile` to out[c][(y - tile.y0) * kRootSize + (x - tile.x0)], c < signal.channels, 64-byte aligned.
/// Reads fragments of neighbouring tiles; the same bits whatever thread does which tile, and whatever the SIMD target up to rounding.
void upsample(const GBuffer& g, const LightSignal& signal, const UpsampleOptions& options, const RootTile& tile,
              std::span<float* const> out);

}  // namespace sightline
