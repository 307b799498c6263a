// Camera rays of one tile, and the light of the vertices that they fall between.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "film/frame.h"
#include "film/view.h"
#include "methods/method.h"
#include "methods/square_lights/frame_shading.h"

namespace sightline::square_lights {

/// Buffers of one thread.
class SquareKernel {
 public:
  /// `radiance` has four floats a vertex, of the frame to be drawn; empty where pixels are shaded by themselves.
  SquareKernel(const World& world, const View& view, const SquareBake& bake, const FrameShading& shading, std::span<const float> radiance,
               std::uint64_t seed);

  void render_tile(const Tile& tile, SampleRange samples, Frame& frame, PassStatistics& statistics);
  const ShadingCounts& counts() const { return scratch_.counts; }

 private:
  void trace(const Tile& tile, std::uint32_t sample, PassStatistics& statistics);
  void color_background();
  Color vertex_color(std::size_t i, const Vec3& position) const;
  Color surface_color(std::size_t i);
  void write_aovs(Frame& frame, std::size_t i);

  const World& world_;
  const View& view_;
  const SquareBake& bake_;
  const FrameShading& shading_;
  std::span<const float> radiance_;
  std::uint64_t seed_;
  bool simple_;  ///< nothing but vertex colours is needed of a hit

  std::size_t count_ = 0;
  AlignedVector<std::uint32_t> pixel_, key_, index_;
  AlignedVector<std::uint8_t> inside_;
  AlignedVector<float> u0_, u1_, u2_, u3_;
  RayBatch rays_;
  HitBatch hits_;
  SurfaceBatch surfaces_;
  Vec3Batch color_;
  AlignedVector<std::uint32_t> missed_;  ///< rays that hit nothing, their directions and what they see
  Vec3Batch missed_direction_, missed_color_;
  FrameShading::Scratch scratch_;
};

}  // namespace sightline::square_lights
