#include "texture/mip_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace sightline {
namespace {

/// Box filter from n to m <= n samples: each output covers [i n/m, (i + 1) n/m), at most three inputs when m = floor(n / 2).
struct BoxTaps {
  int first;
  int count;
  std::array<float, 3> weight;
};

std::vector<BoxTaps> box_taps(int n, int m) {
  std::vector<BoxTaps> taps(static_cast<std::size_t>(m));
  const double ratio = static_cast<double>(n) / m;
  for (int i = 0; i < m; ++i) {
    const double begin = i * ratio, end = (i + 1) * ratio;
    BoxTaps& tap = taps[static_cast<std::size_t>(i)];
    tap = {std::min(static_cast<int>(begin), n - 1), 0, {}};
    for (int k = 0; k < 3 && tap.first + k < n; ++k) {
      const double overlap = std::min<double>(end, tap.first + k + 1) - std::max<double>(begin, tap.first + k);
      if (overlap <= 1e-9) break;
      tap.weight[static_cast<std::size_t>(k)] = static_cast<float>(overlap / ratio);
      tap.count = k + 1;
    }
  }
  return taps;
}

/// `source` (width x height x channels, linear) box-filtered to half its size.
template <class Fetch>
std::vector<float> halved(int width, int height, int channels, int new_width, int new_height, Fetch&& source) {
  const std::vector<BoxTaps> columns = box_taps(width, new_width), rows = box_taps(height, new_height);
  std::vector<float> result(static_cast<std::size_t>(new_width) * static_cast<std::size_t>(new_height) *
                            static_cast<std::size_t>(channels));
  std::size_t at = 0;
  for (const BoxTaps& row : rows) {
    for (const BoxTaps& column : columns) {
      for (int c = 0; c < channels; ++c) {
        float sum = 0;
        for (int j = 0; j < row.count; ++j) {
          for (int i = 0; i < column.count; ++i) {
            const std::size_t texel =
                static_cast<std::size_t>(row.first + j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column.first + i);
            sum += row.weight[static_cast<std::size_t>(j)] * column.weight[static_cast<std::size_t>(i)] *
                   source(texel * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c), c);
          }
        }
        result[at++] = sum;
      }
    }
  }
  return result;
}

/// RGBA of 1 to 4 stored channels.
Vec4 spread(const float* c, int channels) {
  switch (channels) {
    case 1:
      return {c[0], c[0], c[0], 1};
    case 2:
      return {c[0], c[0], c[0], c[1]};
    case 3:
      return {c[0], c[1], c[2], 1};
    default:
      return {c[0], c[1], c[2], c[3]};
  }
}

bool is_alpha(int channel, int channels) { return (channels == 2 && channel == 1) || channel == 3; }

/// Brings a coordinate near [0, 1] without changing what it shows, so that its texel index fits an int.
float reduced(float u, Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return u - std::floor(u);
    case Wrap::mirror:
      return u - 2 * std::floor(0.5f * u);
    case Wrap::clamp:
      return std::clamp(u, 0.f, 1.f);
    case Wrap::black:
      return std::clamp(u, -1.f, 2.f);
  }
  return u;
}

}  // namespace

MipMap::MipMap(std::shared_ptr<const Image> image, ColorEncoding encoding, bool with_levels)
    : image_(std::move(image)), channels_(image_->channels), kind_(image_->data.index()) {
  Level base{image_->width, image_->height, {}, {}, {}, nullptr};
  const bool is_srgb = encoding == ColorEncoding::srgb;
  if (kind_ == 0) {
    bytes_ = make_byte_decoder(is_srgb);
    base.texels = std::get<Image::Bytes>(image_->data).data();
  } else if (kind_ == 1) {
    if (is_srgb) srgb_words_ = make_srgb_word_decoder();
    base.texels = std::get<Image::Words>(image_->data).data();
  } else {
    base.texels = std::get<Image::Floats>(image_->data).data();
  }
  levels_.push_back(std::move(base));
  build_levels(with_levels);
}

void MipMap::build_levels(bool keep) {
  const std::optional<ByteEncoder> color_encoder = kind_ == 0 ? std::optional<ByteEncoder>(bytes_.color) : std::nullopt;
  const std::optional<ByteEncoder> alpha_encoder = kind_ == 0 ? std::optional<ByteEncoder>(bytes_.alpha) : std::nullopt;
  const bool words_are_srgb = !srgb_words_.empty();

  const auto stored = [&](std::size_t i, int c) -> float {
    const void* texels = levels_[0].texels;
    const bool alpha = is_alpha(c, channels_);
    if (kind_ == 0) return (alpha ? bytes_.alpha : bytes_.color)[static_cast<const std::uint8_t*>(texels)[i]];
    if (kind_ == 1) {
      const std::uint16_t word = static_cast<const std::uint16_t*>(texels)[i];
      return words_are_srgb && !alpha ? srgb_words_[word] : static_cast<float>(word) / 65535.f;
    }
    return static_cast<const float*>(texels)[i];
  };

  // Each level comes from the unrounded one above it, so that rounding does not add up on the way to the mean.
  int width = image_->width, height = image_->height;
  std::vector<float> linear;
  while (width > 1 || height > 1) {
    const int new_width = std::max(1, width / 2), new_height = std::max(1, height / 2);
    linear = linear.empty() ? halved(width, height, channels_, new_width, new_height, stored)
                            : halved(width, height, channels_, new_width, new_height, [&](std::size_t i, int) { return linear[i]; });
    width = new_width;
    height = new_height;
    if (!keep) continue;

    Level level{width, height, {}, {}, {}, nullptr};
    if (kind_ == 0) {
      level.bytes.resize(linear.size());
      for (std::size_t i = 0; i < linear.size(); ++i) {
        const int c = static_cast<int>(i % static_cast<std::size_t>(channels_));
        level.bytes[i] = (is_alpha(c, channels_) ? *alpha_encoder : *color_encoder)(linear[i]);
      }
      level.texels = level.bytes.data();
    } else if (kind_ == 1) {
      level.words.resize(linear.size());
      for (std::size_t i = 0; i < linear.size(); ++i) {
        const int c = static_cast<int>(i % static_cast<std::size_t>(channels_));
        if (words_are_srgb && !is_alpha(c, channels_)) {
          const auto above = std::lower_bound(srgb_words_.begin(), srgb_words_.end(), linear[i]);
          level.words[i] = static_cast<std::uint16_t>(std::min<std::ptrdiff_t>(above - srgb_words_.begin(), 65535));
        } else {
          level.words[i] = static_cast<std::uint16_t>(std::clamp(linear[i] * 65535.f + 0.5f, 0.f, 65535.f));
        }
      }
      level.texels = level.words.data();
    } else {
      level.floats = linear;
      level.texels = level.floats.data();
    }
    levels_.push_back(std::move(level));
  }
  if (linear.empty()) {
    for (int c = 0; c < channels_; ++c) linear.push_back(stored(static_cast<std::size_t>(c), c));
  }
  mean_ = spread(linear.data(), channels_);
}

Vec4 MipMap::texel(const Level& level, int x, int y) const {
  const std::size_t at = (static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) + static_cast<std::size_t>(x)) *
                         static_cast<std::size_t>(channels_);
  if (kind_ == 0) {
    const std::uint8_t* t = static_cast<const std::uint8_t*>(level.texels) + at;
    switch (channels_) {
      case 1:
        return {Vec3(bytes_.color[t[0]]), 1};
      case 2:
        return {Vec3(bytes_.color[t[0]]), bytes_.alpha[t[1]]};
      case 3:
        return {bytes_.color[t[0]], bytes_.color[t[1]], bytes_.color[t[2]], 1};
      default:
        return {bytes_.color[t[0]], bytes_.color[t[1]], bytes_.color[t[2]], bytes_.alpha[t[3]]};
    }
  }
  if (kind_ == 1) {
    const std::uint16_t* t = static_cast<const std::uint16_t*>(level.texels) + at;
    std::array<float, 4> c{};
    for (int i = 0; i < channels_; ++i) {
      c[static_cast<std::size_t>(i)] =
          !srgb_words_.empty() && !is_alpha(i, channels_) ? srgb_words_[t[i]] : static_cast<float>(t[i]) / 65535.f;
    }
    return spread(c.data(), channels_);
  }
  return spread(static_cast<const float*>(level.texels) + at, channels_);
}

int MipMap::wrapped(int i, int n, Wrap wrap) {
  if (i >= 0 && i < n) return i;
  switch (wrap) {
    case Wrap::repeat:
      i %= n;
      return i < 0 ? i + n : i;
    case Wrap::mirror: {
      i %= 2 * n;
      if (i < 0) i += 2 * n;
      return i < n ? i : 2 * n - 1 - i;
    }
    case Wrap::clamp:
      return i < 0 ? 0 : n - 1;
    case Wrap::black:
      return -1;
  }
  return -1;
}

Vec4 MipMap::nearest(const Vec2& uv, Wraps wraps) const {
  const Level& level = levels_[0];
  const int x = wrapped(static_cast<int>(std::floor(reduced(uv.x, wraps.u) * static_cast<float>(level.width))), level.width, wraps.u);
  const int y = wrapped(static_cast<int>(std::floor(reduced(uv.y, wraps.v) * static_cast<float>(level.height))), level.height, wraps.v);
  return x < 0 || y < 0 ? Vec4(0) : texel(level, x, y);
}

Vec4 MipMap::bilinear(int level_index, const Vec2& uv, Wraps wraps) const {
  const Level& level = levels_[static_cast<std::size_t>(level_index)];
  const float x = reduced(uv.x, wraps.u) * static_cast<float>(level.width) - 0.5f;
  const float y = reduced(uv.y, wraps.v) * static_cast<float>(level.height) - 0.5f;
  const float left = std::floor(x), top = std::floor(y);
  const float fx = x - left, fy = y - top;
  const int x0 = wrapped(static_cast<int>(left), level.width, wraps.u), x1 = wrapped(static_cast<int>(left) + 1, level.width, wraps.u);
  const int y0 = wrapped(static_cast<int>(top), level.height, wraps.v), y1 = wrapped(static_cast<int>(top) + 1, level.height, wraps.v);
  const auto fetch = [&](int i, int j) { return i < 0 || j < 0 ? Vec4(0) : texel(level, i, j); };
  const Vec4 upper = (1 - fx) * fetch(x0, y0) + fx * fetch(x1, y0);
  const Vec4 lower = (1 - fx) * fetch(x0, y1) + fx * fetch(x1, y1);
  return (1 - fy) * upper + fy * lower;
}

Vec4 MipMap::trilinear(float level, const Vec2& uv, Wraps wraps) const {
  if (!(level > 0)) return bilinear(0, uv, wraps);
  const int last = level_count() - 1;
  if (level >= static_cast<float>(last)) return bilinear(last, uv, wraps);
  const int fine = static_cast<int>(level);
  const float fraction = level - static_cast<float>(fine);
  const Vec4 a = bilinear(fine, uv, wraps);
  return fraction > 0 ? (1 - fraction) * a + fraction * bilinear(fine + 1, uv, wraps) : a;
}

Vec4 MipMap::filtered(const Vec2& uv, const Footprint& footprint, Wraps wraps) const {
  if (footprint.is_point()) return bilinear(0, uv, wraps);
  const Vec2 size{levels_[0].width, levels_[0].height};
  const Vec2 a = footprint.dx * size, b = footprint.dy * size;

  // Semi-axes of the image of a circle under [a b]: eigenvalues of the symmetric matrix a aᵀ + b bᵀ.
  const float xx = a.x * a.x + b.x * b.x, yy = a.y * a.y + b.y * b.y, xy = a.x * a.y + b.x * b.y;
  const float half_sum = 0.5f * (xx + yy);
  const float radius = std::sqrt(0.25f * (xx - yy) * (xx - yy) + xy * xy);
  const float major = std::sqrt(half_sum + radius);
  if (!std::isfinite(major)) return trilinear(static_cast<float>(level_count()), uv, wraps);
  const float minor = std::max(std::sqrt(std::max(half_sum - radius, 0.f)), major / kProbes);

  // Magnified: one bilinear look-up.
  if (major <= 1) return bilinear(0, uv, wraps);
  const float level = std::log2(std::max(minor, 1.f));
  const int probes = std::clamp(static_cast<int>(std::ceil(major / std::max(minor, 1.f) - 0.01f)), 1, kProbes);
  if (probes == 1) return trilinear(level, uv, wraps);

  // The major eigenvector, from the row that does not cancel.
  const Vec2 direction = xx >= yy ? Vec2(0.5f * (xx - yy) + radius, xy) : Vec2(xy, 0.5f * (yy - xx) + radius);
  const Vec2 step = direction * (major / (glm::length(direction) * static_cast<float>(probes))) / size;
  Vec4 sum(0);
  for (int i = 0; i < probes; ++i)
    sum += trilinear(level, uv + step * (static_cast<float>(i) + 0.5f - 0.5f * static_cast<float>(probes)), wraps);
  return sum / static_cast<float>(probes);
}

std::uint64_t MipMap::memory_bytes() const {
  std::uint64_t bytes = sizeof(*this) + srgb_words_.size() * sizeof(float) + levels_.capacity() * sizeof(Level);
  for (const Level& level : levels_) {
    bytes += level.bytes.size() + level.words.size() * sizeof(std::uint16_t) + level.floats.size() * sizeof(float);
  }
  return bytes;
}

}  // namespace sightline
