// What the header of a PLY file declares.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scene/load/ply/byte_stream.h"

namespace sightline::ply {

enum class Encoding { ascii, binary_little_endian, binary_big_endian };
enum class ScalarType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t scalar_size(ScalarType type);
inline bool is_integral(ScalarType type) { return type < ScalarType::float32; }

struct Property {
  std::string name;
  ScalarType type = ScalarType::float32;
  bool is_list = false;
  ScalarType count_type = ScalarType::uint8;  ///< of a list's length
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  bool has_lists() const;
  /// Least bytes of one element in the file; exact for binary ones without lists.
  std::uint64_t least_bytes(Encoding encoding) const;
  /// Index of the first property of one of these names, or -1.
  int find(std::initializer_list<std::string_view> names) const;
};

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::uint64_t body_offset = 0;
};

/// Reads the header and leaves the stream at the first byte after it. Throws Error{input} with the line.
Header read_header(ByteStream& stream);

}  // namespace sightline::ply
