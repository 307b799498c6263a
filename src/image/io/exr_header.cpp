// EXR files: magic number, version and flags, then headers of attributes (name, type, size, value), each ended by an empty name; files
// with several parts have one more empty header (the OpenEXR project's page "OpenEXR File Layout").
#include "image/io/exr_header.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "image/io/byte_reader.h"
#include "image/io/formats.h"

namespace sightline {
namespace {

constexpr std::uint32_t kTiledFlag = 0x200, kLongNamesFlag = 0x400, kDeepFlag = 0x800, kMultiPartFlag = 0x1000;
constexpr std::size_t kLongestName = 255;

/// Largest factor by which each compression, in the order of its number in the file, can shrink data; generous, since it is only there
/// to tell the possible from the absurd.
struct Compression {
  double expansion;
  int rows_per_chunk;
};
constexpr std::array<Compression, 10> kCompressions = {{
    {1, 1},                        // none
    {64, 1},                       // rle
    {kDeflateExpansion, 1},        // zips
    {kDeflateExpansion, 16},       // zip
    {1024, 32},                    // piz: Huffman-coded runs
    {2 * kDeflateExpansion, 16},   // pxr24: deflate of the upper three bytes
    {4, 32},                       // b44
    {16, 32},                      // b44a: 3 bytes for a block of 4 x 4 equal halves
    {8 * kDeflateExpansion, 32},   // dwaa: deflate of few coefficients
    {8 * kDeflateExpansion, 256},  // dwab
}};

void read_channels(ByteReader value, ExrPartHeader& part) {
  while (!value.text_until('\0', kLongestName).empty()) {
    const std::size_t offset = value.position();
    const std::int32_t type = value.i32_little();
    value.take(4);  // a hint for lossy compression, and reserved bytes
    const std::int32_t x_sampling = value.i32_little(), y_sampling = value.i32_little();
    if (type < 0 || type > 2) throw input_error_at(offset, fmt::format("a channel has the unknown pixel type {}", type));
    if (x_sampling < 1 || y_sampling < 1) throw input_error_at(offset, "a channel has a sampling rate below 1");
    part.subsampled = part.subsampled || x_sampling != 1 || y_sampling != 1;
    part.bytes_per_pixel += type == 1 ? 2 : 4;
    ++part.channel_count;
  }
}

void read_value(std::string_view name, ByteReader value, ExrPartHeader& part) {
  if (name == "channels") {
    read_channels(value, part);
  } else if (name == "dataWindow") {
    part.x_min = value.i32_little();
    part.y_min = value.i32_little();
    part.x_max = value.i32_little();
    part.y_max = value.i32_little();
  } else if (name == "compression") {
    part.compression = value.u8();
  } else if (name == "tiles") {
    part.tile_width = static_cast<std::uint32_t>(value.i32_little());
    part.tile_height = static_cast<std::uint32_t>(value.i32_little());
  } else if (name == "type") {
    const auto text = value.take(value.remaining());
    part.deep = std::string_view(reinterpret_cast<const char*>(text.data()), text.size()).starts_with("deep");
  } else if (name == "preview") {
    // Width, height, and four bytes a pixel, which is what is allocated for it.
    const auto width = static_cast<std::uint32_t>(value.i32_little()), height = static_cast<std::uint32_t>(value.i32_little());
    if (height != 0 && width > value.remaining() / 4 / height) throw input_error("the preview picture is larger than its attribute");
  }
}

/// OpenEXR reads values by their type, not by the stored size; where the two differ it would take pixels for sizes from there on.
void check_value_size(std::string_view type, ByteReader value) {
  using Size = std::pair<std::string_view, std::size_t>;
  static constexpr std::array sizes = {Size{"box2i", 16},      Size{"box2f", 16},   Size{"chromaticities", 32},
                                       Size{"compression", 1}, Size{"double", 8},   Size{"envmap", 1},
                                       Size{"float", 4},       Size{"int", 4},      Size{"keycode", 28},
                                       Size{"lineOrder", 1},   Size{"m33f", 36},    Size{"m44f", 64},
                                       Size{"m33d", 72},       Size{"m44d", 128},   Size{"rational", 8},
                                       Size{"tiledesc", 9},    Size{"timecode", 8}, Size{"v2i", 8},
                                       Size{"v2f", 8},         Size{"v2d", 16},     Size{"v3i", 12},
                                       Size{"v3f", 12},        Size{"v3d", 24},     Size{"deepImageState", 1}};
  const auto* known = std::find_if(sizes.begin(), sizes.end(), [type](const Size& size) { return size.first == type; });
  if (known != sizes.end() && value.remaining() != known->second) throw input_error("it has the wrong size for its type");
  if (type == "stringvector") {
    while (value.remaining() > 0) {
      const std::int32_t length = value.i32_little();
      if (length < 0) throw input_error("a text has a negative length");
      value.take(static_cast<std::size_t>(length));
    }
  } else if (type == "chlist") {
    while (!value.text_until('\0', kLongestName).empty()) value.take(16);
    if (value.remaining() != 0) throw input_error("it goes on after its end");
  }
}

/// False at the empty header that ends a list of parts.
bool read_part(ByteReader& reader, ExrPartHeader& part, std::size_t& chunk_count) {
  static constexpr std::array<std::string_view, 7> once = {"channels", "chunkCount", "compression", "dataWindow",
                                                           "preview",  "tiles",      "type"};
  std::set<std::string_view> seen;
  for (bool first = true;; first = false) {
    const std::string_view name = reader.text_until('\0', kLongestName);
    if (name.empty()) {
      if (first) return false;
      break;
    }
    const std::size_t offset = reader.position();
    const std::string_view type = reader.text_until('\0', kLongestName);
    const std::int32_t size = reader.i32_little();
    if (size < 0) throw input_error_at(offset, "an attribute has a negative size");
    ByteReader value(reader.take(static_cast<std::size_t>(size)));
    try {
      check_value_size(type, value);
    } catch (const Error& error) {
      throw input_error_at(offset, fmt::format("the attribute '{}' is malformed: {}", name, error.message()));
    }
    if (std::find(once.begin(), once.end(), name) == once.end()) continue;
    if (!seen.insert(name).second) throw input_error_at(offset, fmt::format("the attribute '{}' stands twice", name));
    if (name == "chunkCount") {
      chunk_count = static_cast<std::uint32_t>(value.i32_little());
    } else {
      try {
        read_value(name, value, part);
      } catch (const Error& error) {
        throw input_error_at(offset, fmt::format("the attribute '{}' is malformed: {}", name, error.message()));
      }
    }
  }
  for (const std::string_view needed : {"channels", "compression", "dataWindow"}) {
    if (!seen.contains(needed)) throw input_error_at(reader.position(), fmt::format("the header has no attribute '{}'", needed));
  }
  return true;
}

void check_part(const ExrPartHeader& part, std::size_t declared_chunks, std::size_t file_size) {
  constexpr std::int64_t farthest = std::int64_t{1} << 30;
  for (const std::int64_t corner : {part.x_min, part.y_min, part.x_max, part.y_max}) {
    if (corner < -farthest || corner > farthest) throw input_error(fmt::format("the data window reaches the coordinate {}", corner));
  }
  if (part.channel_count == 0) throw input_error("the picture has no channels");
  if (part.compression >= kCompressions.size()) throw input_error(fmt::format("unknown compression {}", part.compression));
  const Compression& compression = kCompressions[part.compression];
  // Deep pixels can be empty, and subsampled channels need less than a value a pixel.
  const std::size_t least_pixel = part.deep || part.subsampled ? 0 : part.bytes_per_pixel;
  check_picture_size(part.width(), part.height(), least_pixel, file_size, compression.expansion);

  const bool tiled = part.tile_width != 0 || part.tile_height != 0;
  double chunks = 0, chunk_pixels = 0;
  if (tiled) {
    if (part.tile_width < 1 || part.tile_height < 1) throw input_error("tiles have no size");
    const std::int64_t across = (part.width() - 1) / part.tile_width + 1, down = (part.height() - 1) / part.tile_height + 1;
    chunks = static_cast<double>(across) * static_cast<double>(down);
    // One row of tiles is held at a time.
    chunk_pixels = static_cast<double>(across) * static_cast<double>(part.tile_width) * static_cast<double>(part.tile_height);
  } else {
    const std::int64_t down = (part.height() - 1) / compression.rows_per_chunk + 1;
    chunks = static_cast<double>(down);
    chunk_pixels = static_cast<double>(part.width()) * compression.rows_per_chunk;
  }
  // The table of chunks takes 8 bytes each.
  if (8 * std::max(chunks, static_cast<double>(declared_chunks)) > static_cast<double>(file_size))
    throw input_error(fmt::format("{:.0f} chunks of pixels cannot come from {} bytes",
                                  std::max(chunks, static_cast<double>(declared_chunks)), file_size));
  constexpr double always_granted = 16 << 20;
  if (chunk_pixels * static_cast<double>(part.bytes_per_pixel) > compression.expansion * static_cast<double>(file_size) + always_granted)
    throw input_error(fmt::format("a chunk of {:.0f} pixels cannot come from {} bytes", chunk_pixels, file_size));
}

}  // namespace

bool looks_like_exr(std::span<const std::byte> bytes) {
  constexpr std::array magic = {std::byte{0x76}, std::byte{0x2f}, std::byte{0x31}, std::byte{0x01}};
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

int exr_rows_per_chunk(std::uint8_t compression) { return kCompressions.at(compression).rows_per_chunk; }

std::vector<ExrPartHeader> check_exr_headers(std::span<const std::byte> bytes) {
  if (!looks_like_exr(bytes)) throw input_error_at(0, "not an EXR file");
  ByteReader reader(bytes);
  reader.take(4);
  const auto version = static_cast<std::uint32_t>(reader.i32_little());
  if ((version & 0xff) != 2 || (version & ~(0xffu | kTiledFlag | kLongNamesFlag | kDeepFlag | kMultiPartFlag)) != 0)
    throw input_error_at(4, fmt::format("unknown version or flags {:#x}", version));

  const bool multi_part = (version & kMultiPartFlag) != 0;
  std::vector<ExrPartHeader> parts;
  for (;;) {
    ExrPartHeader part;
    std::size_t chunk_count = 0;
    const std::size_t offset = reader.position();
    if (!read_part(reader, part, chunk_count)) {
      if (parts.empty()) throw input_error_at(offset, "the file has no header");
      break;
    }
    part.deep = part.deep || (!multi_part && (version & kDeepFlag) != 0);
    try {
      check_part(part, chunk_count, bytes.size());
    } catch (Error& error) {
      error.at("byte " + std::to_string(offset));
      throw;
    }
    parts.push_back(part);
    if (!multi_part) break;
  }
  return parts;
}

}  // namespace sightline
