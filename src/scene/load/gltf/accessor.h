// Accessors: typed arrays over buffer views, of any component type, strided, sparse.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math/vec.h"
#include "scene/load/gltf/document.h"

namespace sightline::gltf {

/// What an accessor says of itself, checked as far as it can be without its data.
struct AccessorInfo {
  std::string path;
  int components = 0;  ///< 1 to 4, or 16 of a 4 x 4 matrix by columns; 0 = a smaller matrix, which is not read
  std::uint64_t component_type = 0;
  bool normalized = false;
  std::uint64_t count = 0;
  bool has_data = false;  ///< a buffer view or sparse values; all zeros otherwise
};

AccessorInfo accessor_info(const Document& document, std::size_t index);

/// Elements as floats, `components` of them each (normalised integers become 0..1 or -1..1). The accessor must have exactly as many.
std::vector<float> read_floats(Document& document, std::size_t index, int components);
/// Elements of an unsigned integer type, `components` of them each.
std::vector<std::uint32_t> read_unsigned(Document& document, std::size_t index, int components = 1);

}  // namespace sightline::gltf
