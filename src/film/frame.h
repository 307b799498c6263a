// The picture while it is being made: exact sums a pixel and layer, and how far each tile has come.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "film/aov.h"
#include "film/exact_sum.h"
#include "image/image.h"

namespace sightline {

/// Samples [begin, end) of every pixel, as absolute indices.
struct SampleRange {
  std::uint32_t begin = 0, end = 0;
  std::uint32_t count() const { return end - begin; }
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

/// Where a sample was not finite, and what replays just that one.
struct BadSample {
  std::uint32_t pixel = 0, sample = 0;
};

/// Rectangle of pixels that one task renders.
struct Tile {
  std::uint32_t index = 0;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int pixel_count() const { return (x1 - x0) * (y1 - y0); }
};

/// Consecutive samples of 16 pixels, sample by sample: value c of sample first_sample + s in pixel lane l is channel[c][16 s + l], 64-byte
/// aligned. Lanes that are not `inside` are dropped.
struct PixelBlock {
  const std::uint32_t* pixel;
  const std::uint8_t* inside;
  std::uint32_t first_sample, count;
  std::array<const float*, 3> channel;
};

/// Tiles are the unit of completion: a tile has all samples [range().begin, range().begin + done(tile)) or it would not say so. Different
/// tiles may be written by different threads at the same time; everything else is for one thread.
class Frame {
 public:
  static constexpr int kTileSize = 32;
  /// What is kept of colours: exact sums, or, of a picture with one sample a pixel to which nothing will ever be added, the samples
  /// themselves: a quarter of the memory, and the very same colours. Such a frame has neither a light image nor a file form and cannot be
  /// merged; one with the layer `variance` keeps sums all the same.
  enum class Colors { summed, single };

  Frame(int width, int height, AovSet aovs, std::uint32_t first_sample = 0, Colors colors = Colors::summed);

  int width() const { return width_; }
  int height() const { return height_; }
  AovSet aovs() const { return aovs_; }
  bool has_single_colors() const { return !single_.empty(); }
  std::uint32_t first_sample() const { return first_sample_; }
  std::size_t tile_count() const { return samples_done_.size(); }
  Tile tile(std::size_t index) const;
  /// Samples a pixel that the tile holds.
  std::uint32_t samples_done(std::size_t tile) const { return samples_done_[tile]; }
  void set_samples_done(std::size_t tile, std::uint32_t count) { samples_done_[tile] = count; }
  /// Least over all tiles.
  std::uint32_t samples_done() const;

  /// Adds one sample's radiance; a non-finite one is dropped and counted. `sample` is for the report only.
  void add_color(std::uint32_t pixel, std::uint32_t sample, const Color& radiance);
  /// The same for the samples of a block.
  void add_color(const PixelBlock& block);
  /// Adds one sample's value to a layer other than colour, if the frame has it.
  void add(Aov aov, std::uint32_t pixel, const Vec3& value);
  /// The same for the samples of a block.
  void add(Aov aov, const PixelBlock& block);

  /// The light image: light that arrives at pixels from elsewhere than their own samples. Kept apart from the samples' sums, since while
  /// tiles have different numbers of samples it is the mean over all of them that it belongs to. Layers colour, direct and indirect.
  void enable_light_image();
  bool has_light_image() const { return !light_image_[0].empty(); }
  /// Adds to the light image what one path carried to a pixel of any tile; a non-finite value is dropped and counted. For one thread, while
  /// no other adds anything; enable_light_image() comes first.
  void splat(std::uint32_t pixel, std::uint32_t sample, const Color& value, bool direct);
  /// Samples a pixel, mean over all tiles.
  double mean_samples_done() const;

  /// Means.
  Color color(std::uint32_t pixel) const;
  Vec3 value(Aov aov, std::uint32_t pixel) const;
  ColorImage color_image() const&;
  /// Of a frame that is no longer needed: its single colours are handed over.
  ColorImage color_image() &&;
  /// All layers and the sample count as channels; no metadata.
  LayeredImage to_layered_image() const;
  /// Relative standard error of the picture's mean luminance per pixel, root mean square over pixels with the mean clamped from below by a
  /// hundredth of the picture's mean; needs Aov::variance; nothing before two samples.
  std::optional<double> estimated_error() const;
  double mean_luminance() const;
  std::uint64_t nonfinite_samples() const { return nonfinite_.load(); }
  std::uint64_t saturated_samples() const { return saturated_.load(); }
  std::optional<BadSample> first_bad_sample() const;
  std::uint64_t memory_bytes() const;

  /// Adds the samples of `other` (same size, layers and seed; disjoint samples). Bit for bit what one run would have summed.
  void merge(const Frame& other);

  /// Raw sums for files; channel-major within a pixel. (See frame_file.h.) None of single colours.
  std::span<const ExactSum> sums(Aov aov) const { return sums_[static_cast<std::size_t>(aov)]; }
  std::span<ExactSum> sums(Aov aov) { return sums_[static_cast<std::size_t>(aov)]; }
  std::span<const ExactSum> light_image_sums(Aov aov) const { return light_image_[static_cast<std::size_t>(aov)]; }
  std::span<ExactSum> light_image_sums(Aov aov) { return light_image_[static_cast<std::size_t>(aov)]; }
  std::span<const std::uint32_t> samples_per_tile() const { return samples_done_; }

  Frame(Frame&& other) noexcept;
  Frame& operator=(Frame&& other) noexcept;

 private:
  bool add_exactly(Aov aov, const PixelBlock& block);
  bool set_single(const PixelBlock& block);
  std::uint32_t tile_of_pixel(std::uint32_t pixel) const;
  Vec3 value(Aov aov, std::uint32_t pixel, double light_image_samples) const;
  void count_bad_sample(std::uint32_t pixel, std::uint32_t sample);

  int width_ = 0, height_ = 0, tiles_x_ = 0;
  AovSet aovs_;
  std::uint32_t first_sample_ = 0;
  std::array<std::vector<ExactSum>, kAovCount> sums_, light_image_;
  std::vector<Color> single_;  ///< Colors::single: by pixel
  std::vector<std::uint32_t> samples_done_;
  std::atomic<std::uint64_t> nonfinite_{0}, saturated_{0}, bad_sample_{~std::uint64_t{0}};
};

}  // namespace sightline
