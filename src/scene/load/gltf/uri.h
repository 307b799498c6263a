// URIs of glTF files: data in the file itself, or a file beside it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::gltf {

/// Text of RFC 3986 with %XX decoded; a broken escape stays as it is.
std::string decode_percent(std::string_view text);
/// Standard or URL-safe base64, padding optional; nothing if a character does not belong.
std::optional<std::vector<std::byte>> decode_base64(std::string_view text);
bool is_data_uri(std::string_view uri);
/// Bytes of "data:[type][;base64],..."; nothing if malformed.
std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri);
/// The file that a relative URI means, if it lies in `folder` or below it: no scheme, no absolute path, no way out through "..".
std::optional<std::filesystem::path> file_of_uri(std::string_view uri, const std::filesystem::path& folder);

}  // namespace sightline::gltf
