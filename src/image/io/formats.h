// The readers behind parse_image(), one a format. They throw Error{input} at a byte offset; the caller adds the file's name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "image/image.h"

namespace sightline {

bool looks_like_exr(std::span<const std::byte> bytes);
bool looks_like_hdr(std::span<const std::byte> bytes);
bool looks_like_pfm(std::span<const std::byte> bytes);
bool looks_like_png(std::span<const std::byte> bytes);
bool looks_like_jpeg(std::span<const std::byte> bytes);
bool looks_like_bmp(std::span<const std::byte> bytes);
/// TGA has no magic number, so this is a guess from the plausibility of the header: ask last.
bool looks_like_tga(std::span<const std::byte> bytes);

/// All channels and text metadata of the first part.
LayeredImage parse_exr_layers(std::span<const std::byte> bytes);
Image parse_hdr(std::span<const std::byte> bytes);   ///< Floats, 3 channels
Image parse_pfm(std::span<const std::byte> bytes);   ///< Floats, 1, 3 or 4 channels
Image parse_png(std::span<const std::byte> bytes);   ///< Bytes or Words, 1, 3 or 4 channels (grey with alpha becomes 4)
Image parse_jpeg(std::span<const std::byte> bytes);  ///< Bytes, 1 or 3 channels
Image parse_tga(std::span<const std::byte> bytes);   ///< Bytes, 1, 3 or 4 channels
Image parse_bmp(std::span<const std::byte> bytes);   ///< Bytes, 3 or 4 channels

/// Throws Error{input} unless 0 < width, height <= 2^20 and a picture of `bytes_per_pixel` can come out of `encoded_bytes` in a format
/// that packs at most `expansion` decoded bytes into one. This is what keeps a file of 50 bytes from claiming gigabytes.
void check_picture_size(std::int64_t width, std::int64_t height, std::size_t bytes_per_pixel, std::size_t encoded_bytes, double expansion);

/// Deflate's limit: a run of 258 bytes takes at least two bits.
inline constexpr double kDeflateExpansion = 1032;

}  // namespace sightline
