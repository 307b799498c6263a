#include "gltf_file.h"

#include <gtest/gtest.h>

#include "base/core/error.h"

namespace sightline::test {
namespace {

void append_u32(std::vector<std::byte>& out, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::byte>((value >> shift) & 0xff));
}

void append_chunk(std::vector<std::byte>& out, std::size_t type, std::span<const std::byte> bytes, char padding) {
  append_u32(out, (bytes.size() + 3) / 4 * 4);
  append_u32(out, type);
  out.insert(out.end(), bytes.begin(), bytes.end());
  while (out.size() % 4 != 0) out.push_back(static_cast<std::byte>(padding));
}

}  // namespace

int GltfFile::push(const char* section, nlohmann::json element) {
  json[section].push_back(std::move(element));
  return static_cast<int>(json[section].size()) - 1;
}

int GltfFile::add_view_bytes(std::span<const std::byte> bytes, int stride) {
  nlohmann::json view = {{"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  data_.insert(data_.end(), bytes.begin(), bytes.end());
  while (data_.size() % 4 != 0) data_.push_back(std::byte{0});
  return push("bufferViews", std::move(view));
}

int GltfFile::add_accessor(int view, int component_type, std::size_t count, std::string_view type, bool normalized, int offset) {
  nlohmann::json accessor = {{"componentType", component_type}, {"count", count}, {"type", std::string(type)}};
  if (view >= 0) accessor["bufferView"] = view;
  if (normalized) accessor["normalized"] = true;
  if (offset != 0) accessor["byteOffset"] = offset;
  return push("accessors", std::move(accessor));
}

int GltfFile::add_root(nlohmann::json node) {
  const int index = push("nodes", std::move(node));
  if (!json.contains("scenes")) json["scenes"] = nlohmann::json::array({{{"nodes", nlohmann::json::array()}}});
  json["scenes"][0]["nodes"].push_back(index);
  return index;
}

std::string GltfFile::text() const {
  nlohmann::json document = json;
  if (!data_.empty() && !document.contains("buffers")) {
    document["buffers"] = {{{"byteLength", data_.size()}, {"uri", "data:application/octet-stream;base64," + base64(data_)}}};
  }
  return document.dump();
}

std::vector<std::byte> GltfFile::glb() const {
  nlohmann::json document = json;
  document["buffers"] = {{{"byteLength", data_.size()}}};
  const std::string text = document.dump();
  std::vector<std::byte> chunks;
  append_chunk(chunks, 0x4e4f534a, std::as_bytes(std::span(text)), ' ');
  append_chunk(chunks, 0x004e4942, data_, '\0');
  std::vector<std::byte> file;
  append_u32(file, 0x46546c67);
  append_u32(file, 2);
  append_u32(file, 12 + chunks.size());
  file.insert(file.end(), chunks.begin(), chunks.end());
  return file;
}

Scene GltfFile::load() const { return parse(text()); }

Scene parse(std::string_view text) {
  Context context;
  context.threads = 1;
  return parse_gltf(std::as_bytes(std::span(text)), "test.gltf", context);
}

std::string error_of(std::string_view text) {
  try {
    parse(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    EXPECT_TRUE(error.place().starts_with("test.gltf")) << error.what();
    return error.what();
  }
  return {};
}

std::string error_of(const GltfFile& file) { return error_of(file.text()); }

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text.push_back(k <= count ? kDigits[bits >> (18 - 6 * k) & 63] : '=');
  }
  return text;
}

}  // namespace sightline::test
