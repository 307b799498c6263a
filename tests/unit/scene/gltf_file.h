// Builds small glTF files for tests: data goes into one buffer, each call adds what its name says and returns its index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/context.h"
#include "scene/load/load.h"

namespace sightline::test {

/// glTF component types.
enum Component { kByte = 5120, kUnsignedByte, kShort, kUnsignedShort, kUnsignedInt = 5125, kFloat = 5126 };

class GltfFile {
 public:
  GltfFile() : json({{"asset", {{"version", "2.0"}}}}) {}

  /// Everything that is not data is edited here.
  nlohmann::json json;

  template <class T>
  int add_view(std::initializer_list<T> values, int stride = 0) {
    return add_view_bytes(std::as_bytes(std::span(values.begin(), values.size())), stride);
  }
  int add_view_bytes(std::span<const std::byte> bytes, int stride = 0);
  /// An accessor over a view (-1: none).
  int add_accessor(int view, int component_type, std::size_t count, std::string_view type, bool normalized = false, int offset = 0);
  template <class T>
  int add_array(std::initializer_list<T> values, int component_type, std::size_t count, std::string_view type, bool normalized = false) {
    return add_accessor(add_view(values), component_type, count, type, normalized);
  }
  /// A triangle (0,0,0) (1,0,0) (0,1,0).
  int add_triangle_positions() { return add_array<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, kFloat, 3, "VEC3"); }
  /// A mesh of one primitive.
  int add_mesh(nlohmann::json primitive) { return push("meshes", {{"primitives", {std::move(primitive)}}}); }
  /// A node that becomes a root of the scene.
  int add_root(nlohmann::json node);
  int push(const char* section, nlohmann::json element);

  /// The file with its buffer as a data URI.
  std::string text() const;
  /// The file as GLB.
  std::vector<std::byte> glb() const;
  Scene load() const;

 private:
  std::vector<std::byte> data_;
};

Scene parse(std::string_view text);
/// what() of the Error{input} that parsing ends in; empty if there is none.
std::string error_of(std::string_view text);
std::string error_of(const GltfFile& file);
std::string base64(std::span<const std::byte> bytes);

}  // namespace sightline::test
