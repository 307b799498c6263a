// The first stage: camera rays of a root tile, what they hit, and the light that needs no fragments.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "film/view.h"
#include "methods/fragments/g_buffer.h"
#include "methods/fragments/sampled_light.h"

namespace sightline {

/// A camera ray of a pixel at a place of its own.
struct CameraPlace {
  std::uint32_t pixel, sample;  ///< `sample` chooses a point of the lens
  std::uint32_t key;            ///< of its random numbers
  float u, v;                   ///< in [0, 1), through the view's pixel filter
};

/// Buffers of one thread.
class CameraPass {
 public:
  enum class Sampling {
    all,      ///< every pixel is lit by sampling, as the reference does it
    glossy,   ///< those with more than Lambert's law
    general,  ///< only those without an analytic form
  };
  CameraPass(const World& world, const View& view, std::uint64_t seed, int light_samples, Sampling sampling, Visibility* visibility);

  /// Traces sample `sample` of the pixels of root tile `index`; writes their part of `g`, and to `radiance` (laid out as `g`) emission and
  /// sampled light.
  void render(std::size_t index, std::uint32_t sample, GBuffer& g, Vec3Batch& radiance, PassStatistics& statistics);

  /// The same for places that fill root tile `index` of `g` block by block; what is left of the tile becomes background.
  void render(std::span<const CameraPlace> places, std::size_t index, std::uint32_t scope, GBuffer& g, Vec3Batch& radiance,
              PassStatistics& statistics);

  /// Pixels are done in blocks of 4 x 4: where in a root tile a block starts, and where in a block a lane is.
  static constexpr int kBlock = 4;
  static constexpr int block_x(int block) { return block % (kRootSize / kBlock) * kBlock; }
  static constexpr int block_y(int block) { return block / (kRootSize / kBlock) * kBlock; }
  static constexpr int lane_x(int lane) { return lane % kBlock; }
  static constexpr int lane_y(int lane) { return lane / kBlock; }

 private:
  static constexpr std::size_t kBatch = 1024;
  void begin(std::size_t index, std::uint32_t scope, GBuffer& g);
  void place(std::uint32_t sample);
  void finish(std::uint32_t sample, std::size_t root, GBuffer& g, Vec3Batch& radiance, PassStatistics& statistics);
  void trace(PassStatistics& statistics);
  void evaluate_materials();
  void emit();
  void write(std::size_t root, GBuffer& g, Vec3Batch& radiance);
  void write_lobes(std::size_t root, GBuffer& g);

  const World& world_;
  const View& view_;
  std::uint64_t seed_;
  Sampling sampling_;
  bool has_mixes_ = false;
  SampledLight sampled_;

  std::size_t count_ = 0;
  AlignedVector<std::uint32_t> pixel_, key_, sample_;
  std::array<std::size_t, kBatch / kLanes> block_at_{};  ///< where in the GBuffer each block starts
  AlignedVector<std::uint8_t> inside_, plain_;
  AlignedVector<float> u0_, u1_, u2_, u3_;
  RayBatch rays_;
  HitBatch hits_;
  SurfaceBatch surfaces_;
  std::vector<Bsdf> bsdf_;
  std::vector<Frame3> frame_;
  std::vector<std::optional<AnalyticBsdf>> form_;
  std::vector<PixelKind> kind_;
  Vec3Batch light_;
  AlignedVector<std::uint8_t> back_;
  std::vector<std::uint32_t> to_sample_;
};

}  // namespace sightline
