// The first stage: camera rays of a root tile, what they hit, and the light that needs no fragments.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "film/view.h"
#include "methods/fragments/g_buffer.h"
#include "methods/fragments/sampled_light.h"

namespace sightline {

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

 private:
  static constexpr std::size_t kBatch = 1024;
  static constexpr int kBlock = 4;
  void trace(std::uint32_t sample, PassStatistics& statistics);
  void evaluate_materials();
  void emit();
  void turn_normals();
  void write(std::size_t root, GBuffer& g, Vec3Batch& radiance);

  const World& world_;
  const View& view_;
  std::uint64_t seed_;
  Sampling sampling_;
  SampledLight sampled_;

  std::size_t count_ = 0;
  AlignedVector<std::uint32_t> pixel_, key_, sample_;
  AlignedVector<std::uint8_t> inside_, plain_;
  AlignedVector<float> u0_, u1_, u2_, u3_;
  RayBatch rays_;
  HitBatch hits_;
  SurfaceBatch surfaces_;
  std::vector<Bsdf> bsdf_;
  std::vector<Frame3> frame_;
  std::vector<std::optional<AnalyticBsdf>> form_;
  std::vector<PixelKind> kind_;
  Vec3Batch light_, turned_geometric_, turned_shading_, albedo_;
  AlignedVector<std::uint8_t> back_;
  std::vector<std::uint32_t> to_sample_;
};

}  // namespace sightline
