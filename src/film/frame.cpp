#include "film/frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "base/core/error.h"
#include "film/block_sum.h"

namespace sightline {
namespace {

/// ExactSum::to_double(), bit for bit, without the library's conversion of 128 bits.
double to_double(const ExactSum& sum) {
  const bool negative = sum.value < 0;
  __extension__ typedef unsigned __int128 UInt128;
  const UInt128 magnitude = negative ? -static_cast<UInt128>(sum.value) : static_cast<UInt128>(sum.value);
  const auto high = static_cast<std::uint64_t>(magnitude >> 64), low = static_cast<std::uint64_t>(magnitude);
  double result = 0;
  if (high == 0) {
    result = static_cast<double>(low) * 0x1p-64;
  } else {
    // The leading 64 bits; the last of them remembers whether any follow, so that rounding sees the whole number.
    const int rest = 64 - std::countl_zero(high);
    const std::uint64_t top = static_cast<std::uint64_t>(magnitude >> rest) | ((low << (64 - rest)) != 0 ? 1u : 0u);
    result = std::ldexp(static_cast<double>(top), rest - 64);
  }
  return negative ? -result : result;
}

}  // namespace

Frame::Frame(int width, int height, AovSet aovs, std::uint32_t first_sample, Colors colors)
    : width_(width), height_(height), tiles_x_((width + kTileSize - 1) / kTileSize), aovs_(aovs), first_sample_(first_sample) {
  const std::size_t pixel_count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (colors == Colors::single && !aovs.has(Aov::variance)) single_.resize(pixel_count, Color(0));
  for (const AovInfo& info : aov_table()) {
    if (info.id == Aov::color && has_single_colors()) continue;
    if (aovs.has(info.id)) sums_[static_cast<std::size_t>(info.id)].resize(pixel_count * info.channels.size());
  }
  samples_done_.resize(static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>((height + kTileSize - 1) / kTileSize), 0);
}

Frame::Frame(Frame&& other) noexcept { *this = std::move(other); }

Frame& Frame::operator=(Frame&& other) noexcept {
  width_ = other.width_, height_ = other.height_, tiles_x_ = other.tiles_x_;
  aovs_ = other.aovs_, first_sample_ = other.first_sample_;
  sums_ = std::move(other.sums_);
  light_image_ = std::move(other.light_image_);
  single_ = std::move(other.single_);
  samples_done_ = std::move(other.samples_done_);
  nonfinite_ = other.nonfinite_.load(), saturated_ = other.saturated_.load(), bad_sample_ = other.bad_sample_.load();
  return *this;
}

Tile Frame::tile(std::size_t index) const {
  const int tx = static_cast<int>(index) % tiles_x_, ty = static_cast<int>(index) / tiles_x_;
  Tile tile{static_cast<std::uint32_t>(index), tx * kTileSize, ty * kTileSize, (tx + 1) * kTileSize, (ty + 1) * kTileSize};
  tile.x1 = std::min(tile.x1, width_), tile.y1 = std::min(tile.y1, height_);
  return tile;
}

std::uint32_t Frame::tile_of_pixel(std::uint32_t pixel) const {
  const int x = static_cast<int>(pixel) % width_, y = static_cast<int>(pixel) / width_;
  return static_cast<std::uint32_t>(y / kTileSize * tiles_x_ + x / kTileSize);
}

std::uint32_t Frame::samples_done() const {
  return samples_done_.empty() ? 0 : *std::min_element(samples_done_.begin(), samples_done_.end());
}

void Frame::count_bad_sample(std::uint32_t pixel, std::uint32_t sample) {
  nonfinite_.fetch_add(1, std::memory_order_relaxed);
  // Keep the smallest (pixel, sample), so that the report does not depend on threads.
  const std::uint64_t code = (std::uint64_t{pixel} << 32) | sample;
  std::uint64_t seen = bad_sample_.load(std::memory_order_relaxed);
  while (code < seen && !bad_sample_.compare_exchange_weak(seen, code)) {
  }
}

void Frame::add_color(std::uint32_t pixel, std::uint32_t sample, const Color& radiance) {
  if (!is_finite(radiance)) {
    count_bad_sample(pixel, sample);
    return;
  }
  if (has_single_colors()) {
    bool kept = true;
    for (int c = 0; c < 3; ++c) {
      ExactSum sum;
      kept &= sum.add(radiance[c]);
      single_[pixel][c] = static_cast<float>(to_double(sum));
    }
    if (!kept) saturated_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  ExactSum* sum = &sums_[0][std::size_t{3} * pixel];
  bool in_range = sum[0].add(radiance.x);
  in_range &= sum[1].add(radiance.y);
  in_range &= sum[2].add(radiance.z);
  if (!in_range) saturated_.fetch_add(1, std::memory_order_relaxed);
  if (aovs_.has(Aov::variance)) {
    const float y = luminance(radiance);
    sums_[static_cast<std::size_t>(Aov::variance)][pixel].add(y * y);
  }
}

void Frame::add(Aov aov, std::uint32_t pixel, const Vec3& value) {
  std::vector<ExactSum>& sums = sums_[static_cast<std::size_t>(aov)];
  if (sums.empty() || !is_finite(value)) return;
  const std::size_t channels = aov_info(aov).channels.size();
  for (std::size_t c = 0; c < channels; ++c) sums[pixel * channels + c].add(value[static_cast<int>(c)]);
}

// Adds the samples of a block with integers of 64 bits; false where only single additions are exact.
bool Frame::add_exactly(Aov aov, const PixelBlock& block) {
  if (block.count > kMaxBlockSamples) return false;
  const std::size_t channels = aov_info(aov).channels.size();
  alignas(kCacheLine) std::array<std::array<std::int64_t, kLanes>, 3> block_sums;
  for (std::size_t c = 0; c < channels; ++c) {
    if (!sum_block(block.channel[c], block.count, block_sums[c].data())) return false;
  }
  std::vector<ExactSum>& sums = sums_[static_cast<std::size_t>(aov)];
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (!block.inside[lane]) continue;
    // Black pixels are many, and their sums need not be touched.
    std::int64_t any = 0;
    for (std::size_t c = 0; c < channels; ++c) any |= block_sums[c][lane];
    if (any == 0) continue;
    for (std::size_t c = 0; c < channels; ++c)
      sums[channels * block.pixel[lane] + c].value += Int128(block_sums[c][lane]) * (Int128(1) << (64 - kBlockSumBits));
  }
  return true;
}

// Stores one sample a pixel; false where a value is not one that sums would keep as it is.
bool Frame::set_single(const PixelBlock& block) {
  constexpr float kLeastKept = 0x1p-40f, kLimit = 0x1p40f;
  if (block.count != 1) return false;
  bool good = true;
  for (const float* values : block.channel) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float size = std::fabs(values[lane]);
      good &= size == 0 || (size >= kLeastKept && size < kLimit);
    }
  }
  if (!good) return false;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (!block.inside[lane]) continue;
    // Sums know no negative zero.
    single_[block.pixel[lane]] = Color(block.channel[0][lane], block.channel[1][lane], block.channel[2][lane]) + 0.f;
  }
  return true;
}

void Frame::add_color(const PixelBlock& block) {
  if (has_single_colors() && set_single(block)) return;
  if (!has_single_colors() && !aovs_.has(Aov::variance) && add_exactly(Aov::color, block)) return;
  for (std::size_t i = 0; i < kLanes * block.count; ++i) {
    const std::size_t lane = i % kLanes;
    if (!block.inside[lane]) continue;
    add_color(block.pixel[lane], block.first_sample + static_cast<std::uint32_t>(i / kLanes),
              {block.channel[0][i], block.channel[1][i], block.channel[2][i]});
  }
}

void Frame::add(Aov aov, const PixelBlock& block) {
  if (!aovs_.has(aov) || add_exactly(aov, block)) return;
  for (std::size_t i = 0; i < kLanes * block.count; ++i) {
    const std::size_t lane = i % kLanes;
    if (block.inside[lane]) add(aov, block.pixel[lane], {block.channel[0][i], block.channel[1][i], block.channel[2][i]});
  }
}

void Frame::enable_light_image() {
  if (has_single_colors()) throw Error(ErrorCode::bug, "a picture of single samples has no light image");
  for (const Aov aov : kLightImageLayers) light_image_[static_cast<std::size_t>(aov)].resize(sums(aov).size());
}

void Frame::splat(std::uint32_t pixel, std::uint32_t sample, const Color& value, bool direct) {
  if (!is_finite(value)) {
    count_bad_sample(pixel, sample);
    return;
  }
  for (const Aov aov : {Aov::color, direct ? Aov::direct : Aov::indirect}) {
    const std::span<ExactSum> sums = light_image_sums(aov);
    if (sums.empty()) continue;
    bool in_range = true;
    for (int c = 0; c < 3; ++c) in_range &= sums[std::size_t{3} * pixel + static_cast<std::size_t>(c)].add(value[c]);
    if (!in_range && aov == Aov::color) saturated_.fetch_add(1, std::memory_order_relaxed);
  }
  // Rare arrivals: their number varies as they do, and the variance of their sum is the sum of their squares.
  if (aovs_.has(Aov::variance)) {
    const float y = luminance(value);
    sums_[static_cast<std::size_t>(Aov::variance)][pixel].add(y * y);
  }
}

double Frame::mean_samples_done() const {
  double sum = 0;
  for (std::size_t i = 0; i < samples_done_.size(); ++i) sum += static_cast<double>(samples_done_[i]) * tile(i).pixel_count();
  return sum / (static_cast<double>(width_) * height_);
}

Vec3 Frame::value(Aov aov, std::uint32_t pixel) const { return value(aov, pixel, has_light_image() ? mean_samples_done() : 0); }

Vec3 Frame::value(Aov aov, std::uint32_t pixel, double light_image_samples) const {
  const std::vector<ExactSum>& sums = sums_[static_cast<std::size_t>(aov)];
  const std::vector<ExactSum>& arrived = light_image_[static_cast<std::size_t>(aov)];
  const std::uint32_t samples = samples_done_[tile_of_pixel(pixel)];
  Vec3 result(0);
  if (aov == Aov::color && has_single_colors() && samples > 0) return single_[pixel];
  if (sums.empty() || samples == 0) return result;
  const std::size_t channels = aov_info(aov).channels.size();
  for (std::size_t c = 0; c < channels; ++c) {
    double mean = to_double(sums[pixel * channels + c]) / samples;
    if (!arrived.empty()) mean += arrived[pixel * channels + c].to_double() / light_image_samples;
    result[static_cast<int>(c)] = static_cast<float>(mean);
  }
  return result;
}

Color Frame::color(std::uint32_t pixel) const { return value(Aov::color, pixel); }

ColorImage Frame::color_image() && {
  if (!has_single_colors() || samples_done() == 0) return std::as_const(*this).color_image();
  ColorImage image;
  image.width = width_, image.height = height_;
  image.pixels = std::move(single_);
  return image;
}

ColorImage Frame::color_image() const& {
  ColorImage image(width_, height_);
  if (has_light_image()) {
    const double mean = mean_samples_done();
    for (std::uint32_t pixel = 0; pixel < image.pixels.size(); ++pixel) image.pixels[pixel] = value(Aov::color, pixel, mean);
    return image;
  }
  // value() for tile after tile.
  const ExactSum* const sums = sums_[static_cast<std::size_t>(Aov::color)].data();
  for (std::size_t index = 0; index < tile_count(); ++index) {
    const Tile t = tile(index);
    const std::uint32_t samples = samples_done_[index];
    for (int y = t.y0; samples > 0 && y < t.y1; ++y) {
      for (int x = t.x0; x < t.x1; ++x) {
        const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
        if (has_single_colors()) {
          image.pixels[pixel] = single_[pixel];
          continue;
        }
        for (int c = 0; c < 3; ++c)
          image.pixels[pixel][c] = static_cast<float>(to_double(sums[3 * pixel + static_cast<std::size_t>(c)]) / samples);
      }
    }
  }
  return image;
}

LayeredImage Frame::to_layered_image() const {
  LayeredImage image;
  const double mean = mean_samples_done();
  image.width = width_, image.height = height_;
  const std::size_t pixel_count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  for (const AovInfo& info : aov_table()) {
    if (!aovs_.has(info.id)) continue;
    const std::size_t first = image.channels.size();
    for (const std::string_view channel : info.channels)
      image.channels.push_back({channel_name(info, channel), info.half, std::vector<float>(pixel_count)});
    for (std::uint32_t pixel = 0; pixel < pixel_count; ++pixel) {
      const Vec3 v = value(info.id, pixel, mean);
      for (std::size_t c = 0; c < info.channels.size(); ++c) image.channels[first + c].values[pixel] = v[static_cast<int>(c)];
    }
  }
  Channel samples{"samples.N", false, std::vector<float>(pixel_count)};
  for (std::uint32_t pixel = 0; pixel < pixel_count; ++pixel)
    samples.values[pixel] = static_cast<float>(samples_done_[tile_of_pixel(pixel)]);
  image.channels.push_back(std::move(samples));
  return image;
}

double Frame::mean_luminance() const {
  double sum = 0;
  const std::size_t pixel_count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  const double mean = mean_samples_done();
  for (std::uint32_t pixel = 0; pixel < pixel_count; ++pixel) sum += luminance(value(Aov::color, pixel, mean));
  return pixel_count ? sum / static_cast<double>(pixel_count) : 0;
}

std::optional<double> Frame::estimated_error() const {
  if (!aovs_.has(Aov::variance)) return std::nullopt;
  const double floor_luminance = std::max(1e-12, 0.01 * mean_luminance());
  const double mean_samples = mean_samples_done();
  double sum = 0;
  std::size_t counted = 0;
  const std::size_t pixel_count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  for (std::uint32_t pixel = 0; pixel < pixel_count; ++pixel) {
    const double n = samples_done_[tile_of_pixel(pixel)];
    if (n < 2) return std::nullopt;
    // The mean of the samples alone: what arrived in the light image has no mean square of its own to be subtracted.
    const ExactSum* sums = &sums_[0][std::size_t{3} * pixel];
    const double own = 0.2126 * sums[0].to_double() + 0.7152 * sums[1].to_double() + 0.0722 * sums[2].to_double();
    const double mean_own = has_light_image() ? own / n : static_cast<double>(luminance(value(Aov::color, pixel, 0)));
    const double squares = sums_[static_cast<std::size_t>(Aov::variance)][pixel].to_double() / n;
    const double variance = std::max(0.0, squares - mean_own * mean_own) / (n - 1);
    const double mean = luminance(value(Aov::color, pixel, mean_samples));
    const double scale = std::max(mean, floor_luminance);
    sum += variance / (scale * scale);
    ++counted;
  }
  return counted ? std::optional(std::sqrt(sum / static_cast<double>(counted))) : std::nullopt;
}

std::optional<BadSample> Frame::first_bad_sample() const {
  const std::uint64_t code = bad_sample_.load();
  if (code == ~std::uint64_t{0}) return std::nullopt;
  return BadSample{static_cast<std::uint32_t>(code >> 32), static_cast<std::uint32_t>(code)};
}

std::uint64_t Frame::memory_bytes() const {
  std::uint64_t bytes = samples_done_.size() * sizeof(std::uint32_t) + single_.size() * sizeof(Color);
  for (const auto& sums : sums_) bytes += sums.size() * sizeof(ExactSum);
  for (const auto& sums : light_image_) bytes += sums.size() * sizeof(ExactSum);
  return bytes;
}

void Frame::merge(const Frame& other) {
  if (other.width_ != width_ || other.height_ != height_ || other.aovs_.bits() != aovs_.bits())
    throw input_error("frames differ in size or layers and cannot be merged");
  if (has_single_colors() || other.has_single_colors()) throw Error(ErrorCode::bug, "pictures of single samples cannot be merged");
  if (other.has_light_image()) enable_light_image();
  for (std::size_t layer = 0; layer < kAovCount; ++layer) {
    for (std::size_t i = 0; i < other.light_image_[layer].size(); ++i) light_image_[layer][i].value += other.light_image_[layer][i].value;
    for (std::size_t i = 0; i < sums_[layer].size(); ++i) sums_[layer][i].value += other.sums_[layer][i].value;
  }
  for (std::size_t tile = 0; tile < samples_done_.size(); ++tile) samples_done_[tile] += other.samples_done_[tile];
  first_sample_ = std::min(first_sample_, other.first_sample_);
  nonfinite_ += other.nonfinite_.load();
  saturated_ += other.saturated_.load();
  bad_sample_ = std::min(bad_sample_.load(), other.bad_sample_.load());
}

}  // namespace sightline
