// PLY: one mesh a file [Turk1994]. Arrays are allocated once, at their final size; the file passes through a small window.
#include <fmt/format.h>

#include <filesystem>
#include <limits>

#include "base/core/error.h"
#include "scene/array_builder.h"
#include "scene/load/load.h"
#include "scene/load/ply/body.h"
#include "scene/load/ply/byte_stream.h"
#include "scene/load/ply/header.h"
#include "scene/load/ply/repair_normals.h"
#include "scene/load/warnings.h"
#include "scene/materialize.h"

namespace sightline {
namespace {

using namespace ply;

/// Index of the element with one of these names, or -1.
int find_element(const Header& header, std::initializer_list<std::string_view> names) {
  for (std::size_t i = 0; i < header.elements.size(); ++i) {
    for (const std::string_view name : names) {
      if (header.elements[i].name == name) return static_cast<int>(i);
    }
  }
  return -1;
}

/// Where the elements begin, as far as it is known.
class ElementOffsets {
 public:
  ElementOffsets(ByteStream& stream, const Header& header, const Context& context)
      : stream_(stream), header_(header), context_(context), offsets_{header.body_offset} {}

  /// Moves the stream to the first byte of element i, reading over elements before it if need be.
  void go_to(std::size_t i) {
    while (offsets_.size() <= i) {
      const Element& element = header_.elements[offsets_.size() - 1];
      stream_.seek(offsets_.back());
      check_room(element);
      skip_element(stream_, header_.encoding, element, context_);
      offsets_.push_back(stream_.offset());
    }
    stream_.seek(offsets_[i]);
    check_room(header_.elements[i]);
  }
  /// The stream stands behind element i.
  void passed(std::size_t i) {
    if (offsets_.size() == i + 1) offsets_.push_back(stream_.offset());
  }

 private:
  /// Refuses a count that the rest of the file cannot hold, before anything is allocated for it.
  void check_room(const Element& element) const {
    const std::uint64_t least = element.least_bytes(header_.encoding);
    // The last value of a text file may lack its separator.
    if (least == 0 || element.count <= (stream_.remaining() + 1) / least) return;
    throw input_error(fmt::format("element '{}' is declared {} times, {} bytes or more each, but only {} bytes follow", element.name,
                                  element.count, least, stream_.remaining()))
        .at(fmt::format("{}: byte {}", stream_.name(), stream_.offset()));
  }

  ByteStream& stream_;
  const Header& header_;
  const Context& context_;
  std::vector<std::uint64_t> offsets_;
};

/// Non-finite positions take a place inside the box, so that whoever measures the array again is not misled; nothing refers to them.
void replace_non_finite(std::span<Vec3> positions, const Bounds& bounds) {
  const Vec3 inside = bounds.is_empty() ? Vec3(0) : bounds.lower;
  for (Vec3& p : positions) {
    if (!is_finite(p)) p = inside;
  }
}

/// Most triangles that `bytes` of a face element can hold: a polygon has two triangles fewer than vertices.
std::uint64_t most_triangles(const Header& header, const Element& faces, std::uint64_t bytes) {
  if (header.encoding == Encoding::ascii) return bytes / 2;
  return bytes / scalar_size(faces.properties[static_cast<std::size_t>(index_property(faces))].type);
}

class MeshReader {
 public:
  MeshReader(ByteStream& stream, const Context& context)
      : stream_(stream), context_(context), header_(read_header(stream)), offsets_(stream, header_, context) {}

  Mesh read(std::uint64_t& dropped) {
    Mesh mesh;
    mesh.name = std::filesystem::path(stream_.name()).stem().string();
    const int vertices = find_element(header_, {"vertex"});
    if (vertices < 0) throw at_file(input_error("the header declares no element 'vertex'"));
    const Element& element = header_.elements[static_cast<std::size_t>(vertices)];
    const VertexLayout layout = vertex_layout(element);
    for (const int property : layout.position) {
      if (property < 0) throw at_file(input_error("the vertices lack x, y or z"));
    }
    if (element.count >= std::numeric_limits<std::uint32_t>::max()) {
      throw at_file(input_error(fmt::format("{} vertices are more than 32-bit indices can name", element.count)));
    }
    // Faces are checked now too: a wrong header should not cost the time to read all vertices.
    const int faces = face_element();

    offsets_.go_to(static_cast<std::size_t>(vertices));
    const auto count = static_cast<std::size_t>(element.count);
    require_memory(context_, count * (12 + (layout.has_normals() ? 12 : 0) + (layout.has_uvs() ? 8 : 0)), "the vertices of a PLY file");
    ArrayBuilder<Vec3> positions(count), normals(layout.has_normals() ? count : 0);
    ArrayBuilder<Vec2> uvs(layout.has_uvs() ? count : 0);
    const VertexSummary summary =
        read_vertices(stream_, header_.encoding, element, {positions.values, normals.values, uvs.values}, context_);
    offsets_.passed(static_cast<std::size_t>(vertices));

    if (faces >= 0) {
      mesh.triangles = read_triangles(static_cast<std::size_t>(faces), positions.values, summary.non_finite == 0, dropped);
    }
    if (summary.non_finite) replace_non_finite(positions.values, summary.bounds);
    if (summary.bad_normals) repair_normals(normals.values, positions.values, mesh.triangles.span());
    mesh.bounds = summary.bounds;
    mesh.positions = positions.array;
    mesh.normals = normals.array;
    mesh.uvs = uvs.array;
    return mesh;
  }

 private:
  Error at_file(Error error) const { return error.at(stream_.name()); }

  int face_element() const {
    const int faces = find_element(header_, {"face", "tristrips"});
    if (faces >= 0) {
      const Element& element = header_.elements[static_cast<std::size_t>(faces)];
      const int list = index_property(element);
      if (list < 0) throw at_file(input_error(fmt::format("element '{}' has no list 'vertex_indices'", element.name)));
      if (!is_integral(element.properties[static_cast<std::size_t>(list)].type) && header_.encoding != Encoding::ascii) {
        throw at_file(input_error("the vertex indices of the faces are not integers"));
      }
    }
    return faces;
  }

  /// Fills an array of as many triangles as there are faces. Where polygons or dropped triangles make that guess wrong, the true number is
  /// known at the end, and the faces are read once more into an array of that size: time is cheaper than a second copy in memory.
  SharedArray<UVec3> read_triangles(std::size_t i, std::span<const Vec3> positions, bool all_finite, std::uint64_t& dropped) {
    const Element& element = header_.elements[i];
    offsets_.go_to(i);
    std::uint64_t guess = std::min(element.name == "face" ? element.count : 0, most_triangles(header_, element, stream_.remaining()));
    for (;;) {
      require_memory(context_, guess * sizeof(UVec3), "the triangles of a PLY file");
      ArrayBuilder<UVec3> triangles(static_cast<std::size_t>(guess));
      offsets_.go_to(i);
      const FaceSummary summary = read_faces(stream_, header_.encoding, element, {positions, all_finite, triangles.values}, context_);
      if (summary.triangles == guess) {
        dropped += summary.dropped;
        return triangles.array;
      }
      guess = summary.triangles;
    }
  }

  ByteStream& stream_;
  const Context& context_;
  Header header_;
  ElementOffsets offsets_;
};

Scene scene_of(ByteStream& stream, const Context& context) {
  Scene scene;
  scene.meshes.push_back(MeshReader(stream, context).read(scene.dropped_triangles));
  const Mesh& mesh = scene.meshes.back();
  scene.name = mesh.name;
  const auto warn = [&](const std::string& text) { add_warning(scene, context, stream.name() + ": " + text); };
  if (scene.dropped_triangles) warn(fmt::format("{} degenerate or non-finite triangles dropped", scene.dropped_triangles));
  if (mesh.triangles.empty()) warn("no triangles");
  scene.instances.push_back({.name = mesh.name, .mesh = MeshId(0), .world_from_object = Mat4(1), .material_override = {}, .node = {}});
  return scene;
}

}  // namespace

Mesh read_ply_mesh(const std::filesystem::path& path, const Context& context, std::uint64_t* dropped_triangles) {
  ByteStream stream(path);
  std::uint64_t dropped = 0;
  Mesh mesh = MeshReader(stream, context).read(dropped);
  if (dropped_triangles) *dropped_triangles += dropped;
  return mesh;
}

Scene load_ply(const std::filesystem::path& path, const LoadOptions&, const Context& context) {
  ByteStream stream(path);
  return scene_of(stream, context);
}

Scene parse_ply(std::span<const std::byte> bytes, const std::string& name, const Context& context) {
  ByteStream stream(bytes, name);
  return scene_of(stream, context);
}

}  // namespace sightline
