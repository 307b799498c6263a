// What refinement leaves behind for one light: samples of the signal on fragments of many sizes, to be interpolated to pixels.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "base/core/aligned.h"
#include "base/core/huge_pages.h"
#include "methods/fragments/g_buffer.h"

namespace sightline {

/// Laid out as the GBuffer (same stride and rows). The signal has one channel (the visible share of the light, in [0, 1]) or three
/// (irradiance / pi, RGB).
///
/// `level[i]` is the level m of the stable fragment that covers pixel i: a square of w = 2^m pixels whose corner is a multiple of w. A
/// fragment of level m >= 1 has four samples, one a quadrant, taken at (or for) the quadrant's centre; each stands in `value` at its
/// quadrant's top left pixel: (x0, y0), (x0 + w/2, y0), (x0, y0 + w/2), (x0 + w/2, y0 + w/2). A fragment of level 0 has its pixel's value.
/// What else `value` holds is of no meaning. Fragments without light (culled, or dark) are stable ones with samples 0.
///
/// Additional samples are pixels whose flags have kExtra: their own value, taken with all rays, stands in `extra`. Of a fragment of level 3
/// or more these are (x0, y0), (x0 + w/2, y0) and (x0, y0 + w/2). They do not change `level`.
///
/// Pixels with kUnlit belong to fragments that the light cannot reach whatever lies between (behind it, or turned away). Their irradiance
/// is 0, a sample as good as any; their visible share is not known, so with one channel they are no samples for others.
struct LightSignal {
  enum Flags : std::uint8_t { kExtra = 1, kUnlit = 2 };
  int channels = 1;
  int stride = 0, rows = 0;
  AlignedVector<std::uint8_t> level, flags;
  /// Rays that stand behind a pixel. Empty: nobody wants to know.
  AlignedVector<std::uint8_t> rays;
  std::array<AlignedVector<float>, 3> value, extra;
  /// By block of 8 x 8 pixels: the last round of refinement along borders that changed it, from 1 on; 0 = none.
  AlignedVector<std::uint8_t> round;
  static constexpr int kBlock = 8;

  std::uint8_t& round_at(int x, int y) { return round[block_of(x, y)]; }
  std::uint8_t round_at(int x, int y) const { return round[block_of(x, y)]; }

  void resize(const GBuffer& g, int channel_count) {
    channels = channel_count, stride = g.stride, rows = g.rows;
    const std::size_t n = static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows);
    level.resize(n), flags.resize(n), round.resize(n / (kBlock * kBlock));
    for (int c = 0; c < channels; ++c) {
      for (AlignedVector<float>* array : {&value[static_cast<std::size_t>(c)], &extra[static_cast<std::size_t>(c)]})
        reserve_in_large_pages(*array, n), array->resize(n);
    }
  }

 private:
  std::size_t block_of(int x, int y) const {
    return static_cast<std::size_t>(y / kBlock) * static_cast<std::size_t>(stride / kBlock) + static_cast<std::size_t>(x / kBlock);
  }
};

}  // namespace sightline
