// Vertices and faces of a PLY body, written straight into arrays of their final size.
#pragma once

#include <cstdint>
#include <span>

#include "base/core/context.h"
#include "base/math/bounds.h"
#include "base/math/vec.h"
#include "scene/load/ply/header.h"

namespace sightline::ply {

/// Where vertices go; attributes that the file lacks are empty spans.
struct VertexTarget {
  std::span<Vec3> positions, normals;
  std::span<Vec2> uvs;
};
struct VertexSummary {
  Bounds bounds;                  ///< of the finite positions
  std::uint64_t non_finite = 0;   ///< positions with NaN or infinity
  std::uint64_t bad_normals = 0;  ///< zero or not finite; left as zero
};

struct FaceTarget {
  std::span<const Vec3> positions;
  bool all_finite = true;      ///< no position needs to be checked
  std::span<UVec3> triangles;  ///< filled as far as it reaches
};
struct FaceSummary {
  std::uint64_t triangles = 0;  ///< valid ones, also those that did not fit
  std::uint64_t dropped = 0;    ///< no area or a non-finite vertex
};

/// The vertex attributes an element has.
struct VertexLayout {
  int position[3] = {-1, -1, -1}, normal[3] = {-1, -1, -1}, uv[2] = {-1, -1};  ///< property numbers
  bool has_normals() const { return normal[0] >= 0 && normal[1] >= 0 && normal[2] >= 0; }
  bool has_uvs() const { return uv[0] >= 0 && uv[1] >= 0; }
};
VertexLayout vertex_layout(const Element& element);
/// Number of the property that lists a face's vertices, or -1.
int index_property(const Element& element);

/// Each reads one element from where the stream stands, and leaves the stream behind it. Throws Error{input} with line or byte.
VertexSummary read_vertices(ByteStream& stream, Encoding encoding, const Element& element, const VertexTarget& target,
                            const Context& context);
FaceSummary read_faces(ByteStream& stream, Encoding encoding, const Element& element, const FaceTarget& target, const Context& context);
void skip_element(ByteStream& stream, Encoding encoding, const Element& element, const Context& context);

}  // namespace sightline::ply
