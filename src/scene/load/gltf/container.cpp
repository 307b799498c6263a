#include "scene/load/gltf/container.h"

#include <fmt/format.h>

#include <cstdint>

#include "base/core/error.h"

namespace sightline::gltf {
namespace {

constexpr std::uint32_t kMagic = 0x46546c67;        // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;    // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004e4942;  // "BIN\0"

std::uint32_t read_u32(std::span<const std::byte> bytes, std::size_t offset) {
  if (offset + 4 > bytes.size()) throw input_error("the file ends too early").at(fmt::format("byte {}", bytes.size()));
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::to_integer<std::uint32_t>(bytes[offset + i]) << (8 * i);
  return value;
}

std::string_view as_text(std::span<const std::byte> bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

}  // namespace

Container split_container(std::span<const std::byte> file) {
  if (file.size() < 4 || read_u32(file, 0) != kMagic) return {.json = as_text(file), .json_offset = 0, .binary = {}};

  const std::uint32_t version = read_u32(file, 4);
  if (version != 2) throw input_error(fmt::format("GLB version {} is not supported, only 2", version)).at("byte 4");
  const std::uint32_t length = read_u32(file, 8);
  if (length > file.size()) {
    throw input_error(fmt::format("the file ends too early: its header says {} bytes, it has {}", length, file.size())).at("byte 8");
  }
  file = file.first(length);

  Container container;
  bool has_json = false;
  for (std::size_t offset = 12; offset < file.size();) {
    const std::size_t chunk_size = read_u32(file, offset);
    const std::uint32_t type = read_u32(file, offset + 4);
    if (chunk_size > file.size() - offset - 8) {
      throw input_error(fmt::format("a chunk of {} bytes does not fit into the file of {}", chunk_size, file.size()))
          .at(fmt::format("byte {}", offset));
    }
    const std::span<const std::byte> chunk = file.subspan(offset + 8, chunk_size);
    if (!has_json) {
      if (type != kJsonChunk) throw input_error("the first chunk is not JSON").at(fmt::format("byte {}", offset + 4));
      container.json = as_text(chunk);
      container.json_offset = offset + 8;
      has_json = true;
    } else if (type == kBinaryChunk && !container.has_binary) {
      container.binary = chunk;
      container.has_binary = true;
    }
    offset += 8 + chunk_size;
  }
  if (!has_json) throw input_error("there is no JSON chunk").at(fmt::format("byte {}", file.size()));
  return container;
}

}  // namespace sightline::gltf
