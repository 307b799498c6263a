// The outer shell of a glTF file: plain JSON, or GLB with a JSON chunk and a binary one.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace sightline::gltf {

/// Views into the file's bytes.
struct Container {
  std::string_view json;
  std::size_t json_offset = 0;  ///< where `json` begins in the file, for messages
  std::span<const std::byte> binary;
  bool has_binary = false;
};

/// Splits the file; throws Error{input} at the byte that is wrong.
Container split_container(std::span<const std::byte> file);

}  // namespace sightline::gltf
