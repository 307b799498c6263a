// What one picture leaves to the next while nothing but the camera moves: how much of each light the points of its surfaces see.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/core/aligned.h"
#include "film/view.h"
#include "methods/fragments/fragment.h"
#include "methods/fragments/g_buffer.h"
#include "methods/fragments/light_signal.h"
#include "methods/fragments/settings.h"

namespace sightline {

/// Where in a picture a point of the world was seen.
class PictureProjection {
 public:
  PictureProjection() = default;
  explicit PictureProjection(const PinholeRays& rays);
  /// In pixels from the top left corner; false behind the camera.
  bool project(const Vec3& point, float& x, float& y) const;

 private:
  Mat3 picture_from_world_{1};
  Vec3 origin_{0};
  bool orthographic_ = false;
};

/// Arrays are laid out as the GBuffer.
struct PictureHistory {
  struct Surface {
    Vec3 position, normal;  ///< geometric
  };
  struct Share {
    float value;  ///< of the light, before smoothing
    float rays;   ///< that stand behind it; 0 = not known
  };
  /// What a square of 8 x 8 pixels sees of a light.
  enum Block : std::uint8_t { kMixed, kDark, kLit };
  static constexpr int kBlock = LightSignal::kBlock;
  struct Light {
    AlignedVector<Share> shares;
    AlignedVector<std::uint8_t> blocks;
  };

  /// What the pictures must have in common: else nothing is taken over.
  struct Identity {
    std::shared_ptr<const void> shadows;  ///< World::shadows()
    FragmentsSettings settings;
    std::uint64_t seed = 0;
    int light_samples = 0, width = 0, height = 0;
    friend bool operator==(const Identity&, const Identity&) = default;
  } identity;
  std::uint32_t pictures = 0;  ///< in a row, up to this one
  PictureProjection projection;
  int width = 0, height = 0, stride = 0;
  AlignedVector<Surface> surfaces;
  std::vector<Light> lights;

  /// Makes room for a picture; what is in it is of no meaning.
  void resize(const GBuffer& g, std::size_t light_count);
  void keep_surfaces(const GBuffer& g, const RootTile& tile);
  /// `share` is the signal at every pixel, signal.rays what stands behind it.
  void keep_shares(const GBuffer& g, const RootTile& tile, std::size_t light, const LightSignal& signal, const AlignedVector<float>& share);
};

/// What the last picture knows about this one, for one light. Shares are functions of places on surfaces, and those stand still: what is
/// taken over is wrong by noise and interpolation alone, and every picture asks some of it anew.
class PriorShares {
 public:
  /// `history` must live as long as this.
  PriorShares(const PictureHistory& history, std::size_t light) : history_(&history), light_(&history.lights[light]) {}

  struct Value {
    float share = 0;
    float rays = 0;    ///< that stand behind it; 0 = nothing is known
    float spread = 0;  ///< between the pixels that it lies between
    bool saturated() const { return spread == 0 && (share == 0 || share == 1); }
  };
  Value at(const GBuffer& g, std::size_t pixel) const;
  /// Whether this picture asks anew at a pixel whatever is known.
  bool is_due(std::size_t pixel) const;

  enum class Verdict : std::uint8_t {
    open,   ///< has to be tested
    dark,   ///< sees nothing
    lit,    ///< sees all of the light
    split,  ///< its quadrants differ
  };
  /// `masks` are filled for `split` alone: as many of `rays` points as the quadrants' shares.
  Verdict of(const GBuffer& g, const Fragment& f, int rays, ProbeMasks& masks) const;

 private:
  PictureHistory::Block block_at(const GBuffer& g, std::size_t pixel) const;
  Verdict of_blocks(const GBuffer& g, const Fragment& f) const;

  const PictureHistory* history_;
  const PictureHistory::Light* light_;
};

}  // namespace sightline
