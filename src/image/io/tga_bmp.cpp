// TGA and BMP through stb_image, with our own look at the header first: stb allocates what the header claims, and takes missing data for
// zeros.
#include <algorithm>
#include <array>
#include <memory>
#include <string>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#define STBI_NO_FAILURE_STRINGS
#include <stb_image.h>

#include "image/io/byte_reader.h"
#include "image/io/formats.h"

namespace sightline {
namespace {

struct TgaHeader {
  int id_length = 0, palette_type = 0, type = 0, palette_length = 0, palette_bits = 0, width = 0, height = 0, bits = 0;

  bool compressed() const { return type >= 9; }
  int base_type() const { return type & 7; }  ///< 1 palette, 2 colour, 3 grey
};
constexpr std::size_t kTgaHeaderBytes = 18;

TgaHeader read_tga_header(std::span<const std::byte> bytes) {
  const auto u8 = [&bytes](std::size_t i) { return static_cast<int>(bytes[i]); };
  const auto u16 = [&u8](std::size_t i) { return u8(i) | u8(i + 1) << 8; };
  return {u8(0), u8(1), u8(2), u16(5), u8(7), u16(12), u16(14), u8(16)};
}

bool plausible(const TgaHeader& h) {
  const auto one_of = [](int value, auto... options) { return ((value == options) || ...); };
  if (!one_of(h.type, 1, 2, 3, 9, 10, 11) || h.palette_type > 1 || h.width == 0 || h.height == 0) return false;
  if (h.base_type() == 1)
    return h.palette_type == 1 && h.palette_length > 0 && one_of(h.palette_bits, 15, 16, 24, 32) && one_of(h.bits, 8, 16);
  if (h.base_type() == 3) return one_of(h.bits, 8, 16);
  return one_of(h.bits, 15, 16, 24, 32);
}

/// Walks over the packets of run-length encoded pixels, which stb would read as zeros beyond the end of the file.
void check_tga_packets(ByteReader& reader, std::size_t pixels, std::size_t pixel_bytes) {
  while (pixels > 0) {
    const std::uint8_t code = reader.u8();
    const std::size_t count = (code & 127u) + 1;
    reader.take(code & 128 ? pixel_bytes : count * pixel_bytes);
    // A last packet that goes beyond the picture is cut, as stb does.
    pixels -= std::min(count, pixels);
  }
}

void check_tga(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  const TgaHeader header = read_tga_header(reader.take(kTgaHeaderBytes));
  if (!plausible(header)) throw input_error_at(0, "the TGA header is malformed");
  reader.take(static_cast<std::size_t>(header.id_length));
  const std::size_t palette_bytes = static_cast<std::size_t>((header.palette_bits + 7) / 8);
  if (header.palette_type == 1) reader.take(palette_bytes * static_cast<std::size_t>(header.palette_length));
  const std::size_t pixel_bytes = static_cast<std::size_t>((header.bits + 7) / 8);
  const std::size_t pixels = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
  check_picture_size(header.width, header.height, pixel_bytes, reader.remaining(), header.compressed() ? 128 : 1);
  if (header.compressed())
    check_tga_packets(reader, pixels, pixel_bytes);
  else
    reader.take(pixels * pixel_bytes);
}

void check_bmp(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  reader.take(10);
  const std::int32_t pixel_offset = reader.i32_little(), info_size = reader.i32_little();
  std::int64_t width = 0, height = 0, bits = 0;
  if (info_size == 12) {
    const std::int32_t size = reader.i32_little();
    width = size & 0xffff;
    height = (size >> 16) & 0xffff;
    bits = (reader.i32_little() >> 16) & 0xffff;
  } else {
    width = reader.i32_little();
    height = reader.i32_little();
    bits = (reader.i32_little() >> 16) & 0xffff;
    const std::int32_t compression = reader.i32_little();
    if (compression == 1 || compression == 2) throw input_error("run-length encoded BMP pictures are not read");
  }
  // Negative heights mean rows from the top.
  height = height < 0 ? -height : height;
  if (bits != 1 && bits != 4 && bits != 8 && bits != 16 && bits != 24 && bits != 32)
    throw input_error("a BMP with " + std::to_string(bits) + " bits a pixel is not read");
  if (pixel_offset < 0 || static_cast<std::size_t>(pixel_offset) > bytes.size())
    throw input_error_at(10, "the pixels begin after the end of the file");
  check_picture_size(width, height, 0, bytes.size(), 1);
  const std::int64_t row_bytes = (width * bits + 31) / 32 * 4;
  if (row_bytes * height > static_cast<std::int64_t>(bytes.size()) - pixel_offset)
    throw input_error_at(static_cast<std::size_t>(pixel_offset),
                         "the file ends too early: rows of " + std::to_string(row_bytes) + " bytes are missing");
}

struct Free {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

/// Grey with alpha becomes four channels, as everywhere in this layer.
Image decode(std::span<const std::byte> bytes, const char* format) {
  if (bytes.size() > std::size_t{1} << 30) throw input_error(std::string("a ") + format + " file of more than 1 GiB is not read");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  const int known = stbi_info_from_memory(data, size, &width, &height, &channels);
  const int wanted = known && channels == 2 ? 4 : 0;
  const std::unique_ptr<stbi_uc, Free> pixels(stbi_load_from_memory(data, size, &width, &height, &channels, wanted));
  if (!pixels) throw input_error(std::string("damaged ") + format + " data");
  if (wanted != 0) channels = wanted;
  Image image{width, height, channels, {}};
  image.data = Image::Bytes(pixels.get(), pixels.get() + image.pixel_count() * static_cast<std::size_t>(channels));
  return image;
}

}  // namespace

bool looks_like_tga(std::span<const std::byte> bytes) { return bytes.size() >= kTgaHeaderBytes && plausible(read_tga_header(bytes)); }

bool looks_like_bmp(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{'B'} && bytes[1] == std::byte{'M'};
}

Image parse_tga(std::span<const std::byte> bytes) {
  check_tga(bytes);
  return decode(bytes, "TGA");
}

Image parse_bmp(std::span<const std::byte> bytes) {
  check_bmp(bytes);
  return decode(bytes, "BMP");
}

}  // namespace sightline
