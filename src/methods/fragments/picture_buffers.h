// The big arrays of a picture, and where they wait for the next one.
#pragma once

#include <array>
#include <mutex>
#include <optional>
#include <utility>

#include "base/core/aligned.h"
#include "methods/fragments/g_buffer.h"
#include "methods/fragments/history.h"
#include "methods/fragments/light_signal.h"

namespace sightline {

/// Each laid out as the GBuffer. What they hold at first is of no meaning.
struct PictureBuffers {
  GBuffer g;
  Vec3Batch radiance;
  LightSignal signal;
  std::array<AlignedVector<float>, 3> pixels;  ///< the signal at every pixel
  AlignedVector<float> smoothed;
  /// With temporal re-use: of the last picture, and of the one at hand.
  PictureHistory last, next;
};

/// Keeps the arrays of one picture. The first touch of new memory takes a tenth of a frame, and animations and moving cameras ask for frame
/// after frame of one size.
class PictureBufferStore {
 public:
  /// Those of the last picture if it had this size, else empty ones.
  PictureBuffers take(int width, int height) const {
    std::optional<PictureBuffers> kept;
    {
      const std::lock_guard lock(mutex_);
      kept.swap(kept_);
    }
    if (kept && kept->g.width == width && kept->g.height == height) return std::move(*kept);
    return {};
  }
  void give(PictureBuffers&& buffers) const {
    // Lists of glossy points may be many times as large, and grow again as fast.
    buffers.g.glossy.clear();
    const std::lock_guard lock(mutex_);
    kept_ = std::move(buffers);
  }

 private:
  mutable std::mutex mutex_;
  mutable std::optional<PictureBuffers> kept_;
};

}  // namespace sightline
