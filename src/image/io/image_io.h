// Reading and writing picture files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "image/image.h"

namespace sightline {

/// Reads a picture by content (magic bytes), endings being only a hint: EXR, HDR (RGBE), PFM, PNG (8/16), JPEG, TGA, BMP. EXR and float
/// formats give Floats, 1, 3 or 4 channels. Throws Error{input} naming file and place; sizes are checked before memory is taken.
Image read_image(const std::filesystem::path& path);
Image parse_image(std::span<const std::byte> bytes, const std::string& name);
/// All channels and metadata of an EXR file; other formats give R G B (A).
LayeredImage read_layered_image(const std::filesystem::path& path);
LayeredImage parse_exr(std::span<const std::byte> bytes, const std::string& name);

enum class ExrCompression { none, rle, zip, piz, dwab };
struct ExrOptions {
  ExrCompression compression = ExrCompression::zip;
};
/// Encoders produce the whole file in memory, without dates or other things that differ between equal runs.
std::vector<std::byte> encode_exr(const LayeredImage& image, const ExrOptions& options = {});
std::vector<std::byte> encode_hdr(const ColorImage& image);
std::vector<std::byte> encode_pfm(const ColorImage& image);
/// 8-bit interleaved RGB or RGBA, row 0 at the top.
std::vector<std::byte> encode_png(int width, int height, int channels, std::span<const std::uint8_t> pixels);
std::vector<std::byte> encode_jpeg(int width, int height, std::span<const std::uint8_t> rgb, int quality = 92);

/// Writes beside `path`, syncs, renames: the file appears whole or not at all. Throws Error{resource} (disk full, no permission) after
/// removing the temporary file. "-" writes to standard output.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
/// Throws Error if a file at `path` could not be written (missing folder, no permission), before the work starts.
void check_writable(const std::filesystem::path& path);
/// Whole file as bytes; Error{input} if unreadable or larger than `limit_bytes`.
std::vector<std::byte> read_file(const std::filesystem::path& path, std::uint64_t limit_bytes = std::uint64_t{1} << 34);

}  // namespace sightline
