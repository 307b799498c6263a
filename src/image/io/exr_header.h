// A look at an EXR header before OpenEXR sees it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sightline {

/// What decides how much memory the reading of a part takes.
struct ExrPartHeader {
  std::int64_t x_min = 0, y_min = 0, x_max = -1, y_max = -1;  ///< data window, inclusive
  std::size_t bytes_per_pixel = 0;                            ///< all channels, as stored
  std::size_t channel_count = 0;
  std::uint8_t compression = 0;
  std::int64_t tile_width = 0, tile_height = 0;  ///< 0: scan lines
  bool deep = false;
  bool subsampled = false;

  std::int64_t width() const { return x_max - x_min + 1; }
  std::int64_t height() const { return y_max - y_min + 1; }
};

/// Headers of all parts; throws Error{input} where one is malformed, where an attribute is longer than the file, or where a part claims
/// more pixels, tiles or chunks than the file can hold. OpenEXR allocates by these numbers before it reads any pixel, hence the check.
std::vector<ExrPartHeader> check_exr_headers(std::span<const std::byte> bytes);

/// Rows that one chunk of scan lines holds.
int exr_rows_per_chunk(std::uint8_t compression);

}  // namespace sightline
