// Radiance RGBE with the new run-length encoding.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/core/error.h"
#include "image/io/image_io.h"

namespace sightline {
namespace {

/// Shared exponent of the largest component; mantissas are rounded to nearest, so that the mean stays where it is. What RGBE cannot hold
/// (negative, NaN) becomes 0, and what is too large the largest value.
std::array<std::uint8_t, 4> rgbe(Color color) {
  for (int c = 0; c < 3; ++c) {
    if (!(color[c] > 0)) color[c] = 0;
    color[c] = std::fmin(color[c], 1.69e38f);
  }
  const float largest = max_component(color);
  int exponent = 0;
  std::frexp(largest, &exponent);
  // Rounding may carry the largest mantissa to 256: then the next exponent is the right one.
  if (std::lround(std::ldexp(largest, 8 - exponent)) > 255) ++exponent;
  if (largest == 0 || exponent < -127) return {0, 0, 0, 0};
  std::array<std::uint8_t, 4> result{};
  for (int c = 0; c < 3; ++c)
    result[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::lround(std::ldexp(color[c], 8 - exponent)));
  result[3] = static_cast<std::uint8_t>(exponent + 128);
  return result;
}

/// One component of a scan line as runs of at least 4 equal bytes and literals of at most 128.
void append_runs(std::vector<std::byte>& out, std::span<const std::uint8_t> values) {
  constexpr std::size_t shortest_run = 4, longest_run = 127, longest_literal = 128;
  const auto run_length = [&](std::size_t begin) {
    std::size_t end = begin + 1;
    while (end < values.size() && end - begin < longest_run && values[end] == values[begin]) ++end;
    return end - begin;
  };
  for (std::size_t x = 0; x < values.size();) {
    if (const std::size_t run = run_length(x); run >= shortest_run) {
      out.push_back(static_cast<std::byte>(128 + run));
      out.push_back(static_cast<std::byte>(values[x]));
      x += run;
      continue;
    }
    std::size_t end = x;
    while (end < values.size() && end - x < longest_literal) {
      const std::size_t run = run_length(end);
      if (run >= shortest_run) break;
      end = std::min(end + run, x + longest_literal);
    }
    out.push_back(static_cast<std::byte>(end - x));
    for (; x < end; ++x) out.push_back(static_cast<std::byte>(values[x]));
  }
}

}  // namespace

std::vector<std::byte> encode_hdr(const ColorImage& image) {
  if (image.width <= 0 || image.height <= 0) throw usage_error("an empty picture cannot be written as HDR");
  const std::string header =
      "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(image.height) + " +X " + std::to_string(image.width) + "\n";
  std::vector<std::byte> out;
  for (const char c : header) out.push_back(static_cast<std::byte>(c));

  // The run-length encoding knows lines of 8 to 32767 pixels; others are stored flat.
  const auto width = static_cast<std::size_t>(image.width);
  const bool runs = width >= 8 && width < 32768;
  std::array<std::vector<std::uint8_t>, 4> planes;
  for (int y = 0; y < image.height; ++y) {
    for (auto& plane : planes) plane.clear();
    for (int x = 0; x < image.width; ++x) {
      const std::array<std::uint8_t, 4> pixel = rgbe(image.at(x, y));
      for (std::size_t c = 0; c < 4; ++c) {
        if (runs)
          planes[c].push_back(pixel[c]);
        else
          out.push_back(static_cast<std::byte>(pixel[c]));
      }
    }
    if (!runs) continue;
    for (const std::size_t byte : {std::size_t{2}, std::size_t{2}, width >> 8, width & 255}) out.push_back(static_cast<std::byte>(byte));
    for (const auto& plane : planes) append_runs(out, plane);
  }
  return out;
}

}  // namespace sightline
