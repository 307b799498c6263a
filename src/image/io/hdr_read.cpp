// Radiance pictures (RGBE, XYZE): flat, old and new run-length encoding, all eight orientations [Ward1991].
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "image/io/byte_reader.h"
#include "image/io/formats.h"

namespace sightline {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

/// One half of a resolution line: "-Y 512" is {axis Y, falling, 512}.
struct Axis {
  char name = 'Y';
  bool rising = false;
  int length = 0;
};

struct HdrHeader {
  bool xyz = false;
  double exposure = 1;  ///< pixels were multiplied by this
  Axis major, minor;    ///< scan lines, and pixels along one
};

std::string_view trimmed(std::string_view text) {
  const auto space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && space(text.front())) text.remove_prefix(1);
  while (!text.empty() && space(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<double> number(std::string_view text) {
  text = trimmed(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<Axis> parse_axis(std::string_view& text) {
  text = trimmed(text);
  if (text.size() < 3 || (text[0] != '-' && text[0] != '+') || (text[1] != 'X' && text[1] != 'Y')) return std::nullopt;
  Axis axis{text[1], text[0] == '+', 0};
  text = trimmed(text.substr(2));
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), axis.length);
  if (error != std::errc() || axis.length <= 0) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return axis;
}

HdrHeader read_header(ByteReader& reader) {
  constexpr std::size_t longest_line = 1 << 16;
  HdrHeader header;
  reader.text_until('\n', longest_line);  // "#?RADIANCE", checked by looks_like_hdr()
  for (;;) {
    const std::size_t offset = reader.position();
    const std::string_view line = trimmed(reader.text_until('\n', longest_line));
    if (line.empty()) break;
    if (line.starts_with("FORMAT=")) {
      const std::string_view format = trimmed(line.substr(7));
      header.xyz = format == "32-bit_rle_xyze";
      if (!header.xyz && format != "32-bit_rle_rgbe") throw input_error_at(offset, "unknown pixel format '" + std::string(format) + "'");
    } else if (line.starts_with("EXPOSURE=")) {
      // Several such lines multiply.
      const std::optional<double> exposure = number(line.substr(9));
      if (!exposure || !(*exposure > 0) || !std::isfinite(*exposure)) throw input_error_at(offset, "EXPOSURE is not a positive number");
      header.exposure *= *exposure;
    }
  }
  const std::size_t offset = reader.position();
  std::string_view line = reader.text_until('\n', longest_line);
  const std::optional<Axis> major = parse_axis(line);
  const std::optional<Axis> minor = major ? parse_axis(line) : std::nullopt;
  if (!minor || major->name == minor->name || !trimmed(line).empty())
    throw input_error_at(offset, "the line with the resolution, such as '-Y 512 +X 1024', is malformed");
  header.major = *major;
  header.minor = *minor;
  return header;
}

/// New encoding: the four components one after the other, each as runs (count > 128) and literals.
void read_new_scanline(ByteReader& reader, std::vector<Rgbe>& line) {
  for (std::size_t component = 0; component < 4; ++component) {
    for (std::size_t x = 0; x < line.size();) {
      const std::size_t offset = reader.position();
      const std::uint8_t code = reader.u8();
      const bool run = code > 128;
      const std::size_t count = run ? code - 128u : code;
      if (count == 0 || count > line.size() - x) throw input_error_at(offset, "a run leaves its scan line");
      if (run) {
        const std::uint8_t value = reader.u8();
        for (std::size_t i = 0; i < count; ++i) line[x++][component] = value;
      } else {
        for (const std::byte value : reader.take(count)) line[x++][component] = static_cast<std::uint8_t>(value);
      }
    }
  }
}

/// Old encoding: pixels, where (1, 1, 1, n) repeats the last one n times; further such codes in a row stand for n << 8, n << 16, ...
void read_old_scanline(ByteReader& reader, std::vector<Rgbe>& line, Rgbe first) {
  std::size_t x = 0;
  int shift = 0;
  Rgbe pixel = first;
  for (;;) {
    if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
      const std::size_t offset = reader.position() - 4;
      if (x == 0) throw input_error_at(offset, "a run repeats a pixel before the first of its scan line");
      if (shift > 24) throw input_error_at(offset, "a run leaves its scan line");
      const std::size_t count = std::size_t{pixel[3]} << shift;
      if (count > line.size() - x) throw input_error_at(offset, "a run leaves its scan line");
      const Rgbe repeated = line[x - 1];
      for (std::size_t i = 0; i < count; ++i) line[x++] = repeated;
      shift += 8;
    } else {
      line[x++] = pixel;
      shift = 0;
    }
    if (x == line.size()) return;
    const auto bytes = reader.take(4);
    for (std::size_t i = 0; i < 4; ++i) pixel[i] = static_cast<std::uint8_t>(bytes[i]);
  }
}

void read_scanline(ByteReader& reader, std::vector<Rgbe>& line) {
  const std::size_t offset = reader.position();
  const auto bytes = reader.take(4);
  Rgbe first;
  for (std::size_t i = 0; i < 4; ++i) first[i] = static_cast<std::uint8_t>(bytes[i]);
  const bool new_encoding = line.size() >= 8 && line.size() < 32768 && first[0] == 2 && first[1] == 2 && first[2] < 128;
  if (!new_encoding) return read_old_scanline(reader, line, first);
  if ((std::size_t{first[2]} << 8 | first[3]) != line.size())
    throw input_error_at(offset, "a scan line has another length than the picture");
  read_new_scanline(reader, line);
}

/// Mantissas share one exponent: value = m 2^(e - 136), zero where e = 0. Like most readers, and so that black and powers of two stay
/// exact, this leaves out the half that Ward's own adds to the mantissa.
Color decode(const Rgbe& pixel, float scale) {
  if (pixel[3] == 0) return Color(0);
  const float unit = std::ldexp(scale, pixel[3] - 136);
  return Color(pixel[0], pixel[1], pixel[2]) * unit;
}

/// CIE XYZ with white point D65 to linear Rec.709 [IEC 61966-2-1].
Color rec709_from_xyz(const Color& c) {
  return {3.2404542f * c.x - 1.5371385f * c.y - 0.4985314f * c.z, -0.9692660f * c.x + 1.8760108f * c.y + 0.0415560f * c.z,
          0.0556434f * c.x - 0.2040259f * c.y + 1.0572252f * c.z};
}

}  // namespace

bool looks_like_hdr(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{'#'} && bytes[1] == std::byte{'?'};
}

Image parse_hdr(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  const HdrHeader header = read_header(reader);
  const bool rows = header.major.name == 'Y';
  const int width = rows ? header.minor.length : header.major.length, height = rows ? header.major.length : header.minor.length;
  // A new-style run packs 127 pixels into 8 bytes. Old-style runs can pack more, but 64 pixels a byte is beyond any real picture.
  constexpr double bytes_per_byte = 64 * 3 * sizeof(float);
  check_picture_size(width, height, 3 * sizeof(float), reader.remaining(), bytes_per_byte);

  Image::Floats values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  std::vector<Rgbe> line(static_cast<std::size_t>(header.minor.length));
  const float scale = static_cast<float>(1 / header.exposure);
  for (int i = 0; i < header.major.length; ++i) {
    read_scanline(reader, line);
    for (int j = 0; j < header.minor.length; ++j) {
      // Y rises upwards in the file's words, but rows count from the top here.
      int x = rows ? j : i, y = rows ? i : j;
      const Axis &x_axis = rows ? header.minor : header.major, &y_axis = rows ? header.major : header.minor;
      if (!x_axis.rising) x = width - 1 - x;
      if (y_axis.rising) y = height - 1 - y;
      Color color = decode(line[static_cast<std::size_t>(j)], scale);
      if (header.xyz) color = rec709_from_xyz(color);
      float* target = &values[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * 3];
      for (int c = 0; c < 3; ++c) target[c] = color[c];
    }
  }
  return {width, height, 3, std::move(values)};
}

}  // namespace sightline
