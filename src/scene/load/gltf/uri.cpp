#include "scene/load/gltf/uri.h"

#include <array>
#include <cstdint>

namespace sightline::gltf {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

constexpr std::array<int, 256> make_base64_table() {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> table{};
  table.fill(-1);
  int value = 0;
  for (const char digit : digits) table[static_cast<unsigned char>(digit)] = value++;
  // Texts made for addresses write the last two differently.
  table['-'] = table['+'];
  table['_'] = table['/'];
  return table;
}

constexpr std::array<int, 256> kBase64 = make_base64_table();

}  // namespace

std::string decode_percent(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size()) {
      const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
      if (high >= 0 && low >= 0) {
        result.push_back(static_cast<char>(16 * high + low));
        i += 2;
        continue;
      }
    }
    result.push_back(text[i]);
  }
  return result;
}

std::optional<std::vector<std::byte>> decode_base64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const int value = kBase64[static_cast<unsigned char>(c)];
    if (value < 0) return std::nullopt;
    bits = (bits << 6) | static_cast<std::uint32_t>(value);
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      bytes.push_back(static_cast<std::byte>((bits >> bit_count) & 0xffu));
    }
  }
  return bytes;
}

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
  const std::string_view header = uri.substr(0, comma), payload = uri.substr(comma + 1);
  if (header.ends_with(";base64")) return decode_base64(payload);
  const std::string text = decode_percent(payload);
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return std::vector<std::byte>(first, first + text.size());
}

std::optional<std::filesystem::path> file_of_uri(std::string_view uri, const std::filesystem::path& folder) {
  const std::string decoded = decode_percent(uri);
  if (decoded.empty() || decoded.find('\0') != std::string::npos || decoded.find("://") != std::string::npos) return std::nullopt;
  const std::filesystem::path relative = std::filesystem::path(decoded).lexically_normal();
  if (relative.is_absolute() || relative.empty() || relative.filename().empty() || relative == ".") return std::nullopt;
  if (*relative.begin() == "..") return std::nullopt;

  // A symbolic link inside the folder must not lead out of it either.
  std::error_code error;
  const std::filesystem::path root = std::filesystem::weakly_canonical(folder.empty() ? "." : folder, error);
  if (error) return std::nullopt;
  const std::filesystem::path target = std::filesystem::weakly_canonical(root / relative, error);
  if (error) return std::nullopt;
  const std::filesystem::path inside = target.lexically_relative(root);
  if (inside.empty() || *inside.begin() == "..") return std::nullopt;
  return folder / relative;
}

}  // namespace sightline::gltf
