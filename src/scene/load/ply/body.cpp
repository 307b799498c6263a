#include "scene/load/ply/body.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <limits>

#include "scene/load/ply/cursors.h"

namespace sightline::ply {
namespace {

/// Rows between two looks at the cancel flag.
constexpr std::uint64_t kCancelStride = 1 << 16;

/// Values that a vertex row may hold, in the order of VertexRow::values.
enum Slot { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kU, kV, kSlotCount };

std::vector<int> slots_of(const Element& element) {
  std::vector<int> slots(element.properties.size(), -1);
  const VertexLayout layout = vertex_layout(element);
  for (int i = 0; i < 3; ++i) slots[static_cast<std::size_t>(layout.position[i])] = kX + i;
  for (int i = 0; i < 3 && layout.has_normals(); ++i) slots[static_cast<std::size_t>(layout.normal[i])] = kNormalX + i;
  for (int i = 0; i < 2 && layout.has_uvs(); ++i) slots[static_cast<std::size_t>(layout.uv[i])] = kU + i;
  return slots;
}

/// Takes finished rows: checks them and writes them to the target.
class VertexWriter {
 public:
  explicit VertexWriter(const VertexTarget& target) : target_(target) {}

  void write(std::uint64_t row, const float* values) {
    const Vec3 position(values[kX], values[kY], values[kZ]);
    target_.positions[row] = position;
    if (is_finite(position)) {
      summary_.bounds.add(position);
    } else {
      ++summary_.non_finite;
    }
    if (!target_.normals.empty()) {
      const Vec3 normal = normalize_or({values[kNormalX], values[kNormalY], values[kNormalZ]}, Vec3(0));
      if (normal == Vec3(0)) ++summary_.bad_normals;
      target_.normals[row] = normal;
    }
    // PLY has v = 0 at the bottom of the picture, Sightline at its top.
    if (!target_.uvs.empty()) target_.uvs[row] = Vec2(values[kU], 1 - values[kV]);
  }
  const VertexSummary& summary() const { return summary_; }

 private:
  VertexTarget target_;
  VertexSummary summary_;
};

template <class Cursor>
void skip_property(Cursor& cursor, const Property& property) {
  if (!property.is_list) return cursor.skip(property.type);
  const std::int64_t count = cursor.integer(property.count_type);
  if (count < 0) throw input_error(fmt::format("list '{}' has the length {}", property.name, count));
  cursor.skip(property.type, static_cast<std::uint64_t>(count));
}

template <class Cursor>
void read_vertex_rows(Cursor& cursor, const Element& element, VertexWriter& writer, const Context& context) {
  const std::vector<int> slots = slots_of(element);
  float values[kSlotCount + 1] = {};
  for (std::uint64_t row = 0; row < element.count; ++row) {
    if (row % kCancelStride == 0) context.check_cancelled();
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const Property& property = element.properties[i];
      if (slots[i] < 0) {
        skip_property(cursor, property);
      } else {
        values[slots[i]] = cursor.real(property.type);
      }
    }
    writer.write(row, values);
  }
}

/// The common layout: every row has the same size and every value that we want is a 32-bit float.
template <bool kSwap>
bool read_float_rows(BinaryCursor<kSwap>& cursor, const Element& element, VertexWriter& writer, const Context& context) {
  struct Field {
    std::size_t offset;
    int slot;
  };
  std::vector<Field> fields;
  std::size_t row_bytes = 0;
  const std::vector<int> slots = slots_of(element);
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const Property& property = element.properties[i];
    if (property.is_list || (slots[i] >= 0 && property.type != ScalarType::float32)) return false;
    if (slots[i] >= 0) fields.push_back({row_bytes, slots[i]});
    row_bytes += scalar_size(property.type);
  }
  float values[kSlotCount] = {};
  for (std::uint64_t row = 0; row < element.count; ++row) {
    if (row % kCancelStride == 0) context.check_cancelled();
    const char* bytes = cursor.take(row_bytes);
    for (const Field& field : fields) {
      values[field.slot] = std::bit_cast<float>(BinaryCursor<kSwap>::template decode<std::uint32_t>(bytes + field.offset));
    }
    writer.write(row, values);
  }
  return true;
}

/// Takes triangles: checks them, writes them as far as the target reaches, counts them.
class TriangleWriter {
 public:
  explicit TriangleWriter(const FaceTarget& target)
      : positions_(target.positions.data()),
        vertex_count_(target.positions.size()),
        all_finite_(target.all_finite),
        next_(target.triangles.data()),
        end_(next_ + target.triangles.size()) {}

  void write(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    // Negative indices have become huge ones.
    if (a >= vertex_count_ || b >= vertex_count_ || c >= vertex_count_) throw out_of_range(a, b, c);
    if (a == b || b == c || c == a || !has_area(positions_[a], positions_[b], positions_[c])) {
      ++dropped_;
      return;
    }
    ++count_;
    if (next_ != end_) *next_++ = UVec3(a, b, c);
  }
  FaceSummary summary() const { return {count_, dropped_}; }
  void drop_one() { ++dropped_; }

 private:
  /// Area in the sense of drop_bad_triangles: finite corners that are neither equal nor exactly on a line.
  bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) const {
    if (!all_finite_ && !(is_finite(a) && is_finite(b) && is_finite(c))) return false;
    return glm::cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a)) != Vec3d(0);
  }
  Error out_of_range(std::uint64_t a, std::uint64_t b, std::uint64_t c) const {
    const std::uint64_t wrong = a >= vertex_count_ ? a : b >= vertex_count_ ? b : c;
    return input_error(fmt::format("a face names vertex {}, but there are {}", static_cast<std::int64_t>(wrong), vertex_count_));
  }

  const Vec3* positions_;
  std::uint64_t vertex_count_;
  bool all_finite_;
  UVec3 *next_, *end_;
  std::uint64_t count_ = 0, dropped_ = 0;
};

template <class Cursor>
std::uint64_t list_length(Cursor& cursor, const Property& list) {
  const std::int64_t length = cursor.integer(list.count_type);
  if (length < 0) throw input_error(fmt::format("a face has {} vertices", length));
  return static_cast<std::uint64_t>(length);
}

/// A polygon as a fan around its first vertex.
template <class Cursor>
void read_polygon(Cursor& cursor, const Property& list, TriangleWriter& writer) {
  const std::uint64_t length = list_length(cursor, list);
  const auto index = [&] { return static_cast<std::uint64_t>(cursor.integer(list.type)); };
  if (length < 3) {
    cursor.skip(list.type, length);
    return writer.drop_one();
  }
  const std::uint64_t first = index();
  std::uint64_t previous = index();
  for (std::uint64_t i = 2; i < length; ++i) {
    const std::uint64_t current = index();
    writer.write(first, previous, current);
    previous = current;
  }
}

/// A list of strips, each ended by -1; every second triangle of a strip is turned round.
template <class Cursor>
void read_strips(Cursor& cursor, const Property& list, TriangleWriter& writer) {
  const std::uint64_t length = list_length(cursor, list);
  std::array<std::uint64_t, 2> last{};
  std::uint64_t in_strip = 0;
  for (std::uint64_t i = 0; i < length; ++i) {
    const std::int64_t index = cursor.integer(list.type);
    if (index == -1) {
      in_strip = 0;
      continue;
    }
    const auto current = static_cast<std::uint64_t>(index);
    if (in_strip >= 2) {
      const bool turned = in_strip % 2 == 1;
      writer.write(last[turned], last[!turned], current);
    }
    last = {last[1], current};
    ++in_strip;
  }
}

template <class Cursor>
void read_face_rows(Cursor& cursor, const Element& element, TriangleWriter& writer, const Context& context) {
  const auto list = static_cast<std::size_t>(index_property(element));
  const bool strips = element.name == "tristrips";
  for (std::uint64_t row = 0; row < element.count; ++row) {
    if (row % kCancelStride == 0) context.check_cancelled();
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      if (i != list) {
        skip_property(cursor, element.properties[i]);
      } else if (strips) {
        read_strips(cursor, element.properties[i], writer);
      } else {
        read_polygon(cursor, element.properties[i], writer);
      }
    }
  }
}

/// The common layout of binary faces: nothing but a list of 32-bit indices after an 8-bit length, most of them triangles.
template <bool kSwap>
bool read_triangle_rows(BinaryCursor<kSwap>& cursor, const Element& element, TriangleWriter& writer, const Context& context) {
  if (element.properties.size() != 1 || element.name == "tristrips") return false;
  const Property& list = element.properties[0];
  const bool wide = list.type == ScalarType::int32 || list.type == ScalarType::uint32;
  const bool narrow_count = list.count_type == ScalarType::uint8 || list.count_type == ScalarType::int8;
  if (!list.is_list || !wide || !narrow_count) return false;
  using Bytes = BinaryCursor<kSwap>;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    if (row % kCancelStride == 0) context.check_cancelled();
    if (*cursor.peek() != 3) {
      read_polygon(cursor, list, writer);
      continue;
    }
    const char* bytes = cursor.take(13) + 1;
    writer.write(Bytes::template decode<std::uint32_t>(bytes), Bytes::template decode<std::uint32_t>(bytes + 4),
                 Bytes::template decode<std::uint32_t>(bytes + 8));
  }
  return true;
}

/// Runs `body(cursor)` with the cursor of the encoding, and adds the place to its errors.
template <class Body>
void with_cursor(ByteStream& stream, Encoding encoding, const Element& element, Body&& body) {
  const auto run = [&](auto cursor) {
    try {
      body(cursor);
      cursor.commit();
    } catch (Error& error) {
      if (error.code() != ErrorCode::input) throw;
      throw error.at(cursor.place()).during(fmt::format("reading PLY element '{}'", element.name));
    }
  };
  static constexpr bool kLittle = std::endian::native == std::endian::little;
  if (encoding == Encoding::ascii) {
    run(AsciiCursor(stream));
  } else if ((encoding == Encoding::binary_little_endian) == kLittle) {
    run(BinaryCursor<false>(stream));
  } else {
    run(BinaryCursor<true>(stream));
  }
}

template <class Cursor>
inline constexpr bool kIsBinary = !std::is_same_v<Cursor, AsciiCursor>;

}  // namespace

VertexLayout vertex_layout(const Element& element) {
  const auto scalar = [&](std::initializer_list<std::string_view> names) {
    const int i = element.find(names);
    return i >= 0 && !element.properties[static_cast<std::size_t>(i)].is_list ? i : -1;
  };
  VertexLayout layout{{scalar({"x"}), scalar({"y"}), scalar({"z"})}, {scalar({"nx"}), scalar({"ny"}), scalar({"nz"})}, {}};
  layout.uv[0] = scalar({"u", "s", "texture_u", "texture_s", "tex_u"});
  layout.uv[1] = scalar({"v", "t", "texture_v", "texture_t", "tex_v"});
  return layout;
}

int index_property(const Element& element) {
  const int i = element.find({"vertex_indices", "vertex_index"});
  return i >= 0 && element.properties[static_cast<std::size_t>(i)].is_list ? i : -1;
}

VertexSummary read_vertices(ByteStream& stream, Encoding encoding, const Element& element, const VertexTarget& target,
                            const Context& context) {
  VertexWriter writer(target);
  with_cursor(stream, encoding, element, [&]<class Cursor>(Cursor& cursor) {
    if constexpr (kIsBinary<Cursor>) {
      if (read_float_rows(cursor, element, writer, context)) return;
    }
    read_vertex_rows(cursor, element, writer, context);
  });
  return writer.summary();
}

FaceSummary read_faces(ByteStream& stream, Encoding encoding, const Element& element, const FaceTarget& target, const Context& context) {
  TriangleWriter writer(target);
  with_cursor(stream, encoding, element, [&]<class Cursor>(Cursor& cursor) {
    if constexpr (kIsBinary<Cursor>) {
      if (read_triangle_rows(cursor, element, writer, context)) return;
    }
    read_face_rows(cursor, element, writer, context);
  });
  return writer.summary();
}

void skip_element(ByteStream& stream, Encoding encoding, const Element& element, const Context& context) {
  if (element.properties.empty()) return;
  with_cursor(stream, encoding, element, [&]<class Cursor>(Cursor& cursor) {
    if constexpr (kIsBinary<Cursor>) {
      if (!element.has_lists()) return cursor.skip_bytes(element.count * element.least_bytes(encoding));
    }
    for (std::uint64_t row = 0; row < element.count; ++row) {
      if (row % kCancelStride == 0) context.check_cancelled();
      for (const Property& property : element.properties) skip_property(cursor, property);
    }
  });
}

}  // namespace sightline::ply
