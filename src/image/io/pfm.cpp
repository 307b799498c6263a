// Portable float maps: a text header "PF", width, height, scale (its sign is the byte order), then rows from the bottom up.
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <string>

#include "image/io/byte_reader.h"
#include "image/io/formats.h"
#include "image/io/image_io.h"

namespace sightline {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// The next word, with the white space before it and the one character after it.
std::string_view word(ByteReader& reader, std::span<const std::byte> bytes) {
  constexpr std::size_t longest = 64;
  const auto at = [&bytes](std::size_t i) { return static_cast<char>(bytes[i]); };
  while (reader.remaining() > 0 && is_space(at(reader.position()))) reader.take(1);
  const std::size_t begin = reader.position();
  while (reader.remaining() > 0 && !is_space(at(reader.position()))) {
    if (reader.position() - begin == longest) throw input_error_at(begin, "a word of the header is too long");
    reader.take(1);
  }
  const std::size_t end = reader.position();
  if (begin == end || reader.remaining() == 0) throw input_error_at(begin, "the file ends inside the header");
  reader.take(1);
  return {reinterpret_cast<const char*>(bytes.data()) + begin, end - begin};
}

template <class T>
T number(ByteReader& reader, std::span<const std::byte> bytes, const char* what) {
  const std::size_t offset = reader.position();
  std::string_view text = word(reader, bytes);
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) throw input_error_at(offset, std::string(what) + " is not a number");
  return value;
}

int channel_count(std::string_view magic) { return magic == "Pf" ? 1 : magic == "PF" ? 3 : magic == "PF4" ? 4 : 0; }

}  // namespace

bool looks_like_pfm(std::span<const std::byte> bytes) {
  if (bytes.size() < 4) return false;
  const char *begin = reinterpret_cast<const char*>(bytes.data()), *end = std::find_if(begin, begin + 4, is_space);
  return channel_count({begin, static_cast<std::size_t>(end - begin)}) > 0;
}

Image parse_pfm(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  const int channels = channel_count(word(reader, bytes));
  const int width = number<int>(reader, bytes, "the width"), height = number<int>(reader, bytes, "the height");
  const double scale = number<double>(reader, bytes, "the scale");
  if (scale == 0 || !std::isfinite(scale)) throw input_error("the scale must be finite and not 0");
  const std::size_t pixel_bytes = static_cast<std::size_t>(channels) * sizeof(float);
  check_picture_size(width, height, pixel_bytes, reader.remaining(), 1);

  Image::Floats values;
  const std::size_t row_values = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
  const auto rows = reader.take(row_values * static_cast<std::size_t>(height) * sizeof(float));
  values.resize(row_values * static_cast<std::size_t>(height));
  const bool swap = (scale < 0 ? std::endian::little : std::endian::big) != std::endian::native;
  const float factor = static_cast<float>(std::fabs(scale));
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    const std::byte* source = rows.data() + y * row_values * sizeof(float);
    float* target = values.data() + (static_cast<std::size_t>(height) - 1 - y) * row_values;
    for (std::size_t i = 0; i < row_values; ++i) {
      std::uint32_t bits;
      std::memcpy(&bits, source + i * sizeof(float), sizeof(bits));
      if (swap) bits = __builtin_bswap32(bits);
      target[i] = std::bit_cast<float>(bits) * factor;
    }
  }
  return {width, height, channels, std::move(values)};
}

std::vector<std::byte> encode_pfm(const ColorImage& image) {
  if (image.width <= 0 || image.height <= 0) throw usage_error("an empty picture cannot be written as PFM");
  const std::string header = "PF\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n-1.0\n";
  std::vector<std::byte> out(header.size() + image.pixels.size() * 3 * sizeof(float));
  std::memcpy(out.data(), header.data(), header.size());
  std::byte* target = out.data() + header.size();
  for (int y = image.height - 1; y >= 0; --y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c, target += sizeof(float)) {
        auto bits = std::bit_cast<std::uint32_t>(image.at(x, y)[c]);
        if constexpr (std::endian::native == std::endian::big) bits = __builtin_bswap32(bits);
        std::memcpy(target, &bits, sizeof(bits));
      }
    }
  }
  return out;
}

}  // namespace sightline
