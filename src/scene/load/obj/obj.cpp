// Wavefront OBJ. The reader is ours: tinyobjloader copies each line, reads numbers to its own rounding, accepts indices that point nowhere
// and reports no line for most errors; this one takes a tenth of the time and names the line.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>

#include "base/core/error.h"
#include "scene/load/load.h"
#include "scene/load/obj/line_reader.h"
#include "scene/load/obj/mtl.h"
#include "scene/load/obj/polygon.h"
#include "scene/load/ply/byte_stream.h"
#include "scene/load/ply/repair_normals.h"
#include "scene/load/warnings.h"
#include "scene/materialize.h"

namespace sightline {
namespace {

using obj::LineReader;

constexpr std::uint32_t kAbsent = 0xffffffffu;

/// A corner of a face: positions in the lists of the file.
struct Corner {
  std::uint32_t position, uv = kAbsent, normal = kAbsent;
};

class ObjReader {
 public:
  /// `directory` empty: no other file is read.
  ObjReader(std::string_view text, const std::string& name, const std::filesystem::path* directory, const Context& context)
      : line_(text, name), name_(name), directory_(directory), context_(context) {}

  Scene read() {
    while (line_.next_line()) {
      if (line_.line() % 65536 == 0) context_.check_cancelled();
      const std::string_view keyword = line_.word();
      if (!keyword.empty()) statement(keyword);
    }
    finish();
    return std::move(scene_);
  }

 private:
  void statement(std::string_view keyword) {
    if (keyword == "v") {
      const float x = line_.require_number(), y = line_.require_number(), z = line_.require_number();
      check_count(file_positions_.size());
      file_positions_.emplace_back(x, y, z);  // a weight or a colour may follow
      first_use_.push_back(kAbsent);
    } else if (keyword == "vt") {
      const float u = line_.require_number(), v = line_.number().value_or(0);
      check_count(file_uvs_.size());
      // OBJ has v = 0 at the bottom of the picture, Sightline at its top.
      file_uvs_.emplace_back(u, 1 - v);
    } else if (keyword == "vn") {
      const float x = line_.require_number(), y = line_.require_number(), z = line_.require_number();
      check_count(file_normals_.size());
      file_normals_.push_back(normalize_or({x, y, z}, Vec3(0)));
    } else if (keyword == "f" || keyword == "fo") {
      face();
    } else if (keyword == "usemtl") {
      use_material(line_.rest());
    } else if (keyword == "mtllib") {
      material_library(std::string(line_.rest()));
    } else {
      other(keyword);
    }
  }

  /// What has no meaning for triangles is passed over; what is not known is reported once.
  void other(std::string_view keyword) {
    static constexpr std::array<std::string_view, 6> kIgnored{"o", "g", "s", "l", "p", "vw"};
    if (std::find(kIgnored.begin(), kIgnored.end(), keyword) != kIgnored.end()) return;
    if (unknown_.size() < 16 && unknown_.emplace(keyword).second) {
      add_warning(scene_, context_, fmt::format("{}: '{}' is not understood", line_.place(), LineReader::printable(keyword)));
    }
  }

  void check_count(std::size_t count) const {
    if (count >= kAbsent - 1) throw line_.error("more vertices than 32-bit indices can name");
  }

  /// One index of a face: from 1 on, or negative and counted back from the latest. kAbsent if there is none.
  std::uint32_t index(std::string_view& text, std::size_t count, const char* what) const {
    std::int64_t value = 0;
    std::size_t i = 0;
    const bool negative = !text.empty() && text[0] == '-';
    i += negative || (!text.empty() && text[0] == '+');
    const std::size_t first = i;
    for (; i < text.size() && i < 18 && text[i] >= '0' && text[i] <= '9'; ++i) value = value * 10 + (text[i] - '0');
    if (i == first) {
      if (i != 0) throw line_.error(fmt::format("'{}' is not an index", LineReader::printable(text)));
      return kAbsent;
    }
    const std::int64_t zero_based = negative ? static_cast<std::int64_t>(count) - value : value - 1;
    if (zero_based < 0 || zero_based >= static_cast<std::int64_t>(count)) {
      throw line_.error(fmt::format("a face names {} {}{}, but {} are defined so far", what, negative ? "-" : "", value, count));
    }
    text.remove_prefix(i);
    return static_cast<std::uint32_t>(zero_based);
  }

  Corner corner(std::string_view word) const {
    const std::string_view whole = word;
    Corner result{index(word, file_positions_.size(), "vertex")};
    const auto slash = [&] {
      const bool present = !word.empty() && word[0] == '/';
      if (present) word.remove_prefix(1);
      return present;
    };
    if (slash()) {
      result.uv = index(word, file_uvs_.size(), "texture coordinate");
      if (slash()) result.normal = index(word, file_normals_.size(), "normal");
    }
    if (!word.empty() || result.position == kAbsent) {
      throw line_.error(fmt::format("'{}' is not a corner of a face", LineReader::printable(whole)));
    }
    return result;
  }

  /// The vertex of our mesh for a corner: one for each combination of indices, found through a short list a position.
  std::uint32_t vertex(const Corner& corner) {
    std::uint32_t* link = &first_use_[corner.position];
    for (; *link != kAbsent; link = &next_use_[*link]) {
      const Corner& known = vertices_[*link];
      if (known.uv == corner.uv && known.normal == corner.normal) return *link;
    }
    check_count(vertices_.size());
    const auto fresh = static_cast<std::uint32_t>(vertices_.size());
    *link = fresh;
    vertices_.push_back(corner);
    next_use_.push_back(kAbsent);
    has_uvs_ |= corner.uv != kAbsent;
    has_normals_ |= corner.normal != kAbsent;
    return fresh;
  }

  void face() {
    face_vertices_.clear();
    face_positions_.clear();
    for (std::string_view word = line_.word(); !word.empty(); word = line_.word()) {
      const Corner c = corner(word);
      face_vertices_.push_back(vertex(c));
      face_positions_.push_back(file_positions_[c.position]);
    }
    if (face_vertices_.size() < 3) {
      ++scene_.dropped_triangles;
      return;
    }
    if (palette_.empty()) current_material_ = palette_entry({});
    face_triangles_.clear();
    obj::triangulate(face_positions_, face_triangles_);
    for (const UVec3& t : face_triangles_) {
      triangles_.push_back({face_vertices_[t.x], face_vertices_[t.y], face_vertices_[t.z]});
      triangle_materials_.push_back(current_material_);
    }
  }

  void material_library(std::string file) {
    if (directory_ == nullptr) {
      add_warning(scene_, context_, fmt::format("{}: '{}' is not read: there is no folder", line_.place(), LineReader::printable(file)));
      return;
    }
    std::replace(file.begin(), file.end(), '\\', '/');
    std::filesystem::path path = *directory_ / file;
    // Exporters write the path of their own machine; often the library lies beside the file.
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) path = *directory_ / std::filesystem::path(file).filename();
    if (!libraries_.insert(path.string()).second) return;
    try {
      const std::string text = read_text(path);
      obj::parse_mtl(text, path.string(), path.parent_path(), scene_, names_, context_);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::input) throw;
      add_warning(scene_, context_, fmt::format("{}: material library: {}", line_.place(), error.what()));
    }
  }

  /// Makes a named material the current one; one that is not defined is the default material.
  void use_material(std::string_view material) {
    MaterialId id;
    if (const auto found = names_.find(material); found != names_.end()) {
      id = found->second;
    } else if (missing_.size() < 16 && missing_.emplace(material).second) {
      add_warning(scene_, context_,
                  fmt::format("{}: material '{}' is not defined, Lambert 0.7 stands in", line_.place(), LineReader::printable(material)));
    }
    current_material_ = palette_entry(id);
  }
  std::uint16_t palette_entry(MaterialId id) {
    const auto [entry, is_new] = palette_entries_.try_emplace(id.index, static_cast<std::uint16_t>(palette_.size()));
    if (is_new) {
      if (palette_.size() > std::numeric_limits<std::uint16_t>::max()) throw line_.error("more than 65536 materials");
      palette_.push_back(id);
    }
    return entry->second;
  }

  void finish() {
    if (triangles_.empty()) add_warning(scene_, context_, name_ + ": no triangles");
    std::vector<Vec3> positions(vertices_.size());
    for (std::size_t i = 0; i < vertices_.size(); ++i) positions[i] = file_positions_[vertices_[i].position];
    const std::uint64_t dropped_before = scene_.dropped_triangles;
    drop_bad_triangles(positions, triangles_, &triangle_materials_, scene_.dropped_triangles);
    if (scene_.dropped_triangles > dropped_before) {
      add_warning(scene_, context_,
                  fmt::format("{}: {} degenerate or non-finite triangles dropped", name_, scene_.dropped_triangles - dropped_before));
    }
    Mesh mesh;
    mesh.name = std::filesystem::path(name_).stem().string();
    for (const Vec3& p : positions) mesh.bounds.add(p);
    mesh.positions = SharedArray<Vec3>(positions);
    mesh.triangles = SharedArray<UVec3>(triangles_);
    if (has_uvs_) {
      mesh.uvs = SharedArray<Vec2>::make(vertices_.size(), [&](std::span<Vec2> uvs) {
        for (std::size_t i = 0; i < uvs.size(); ++i) uvs[i] = vertices_[i].uv == kAbsent ? Vec2(0) : file_uvs_[vertices_[i].uv];
      });
    }
    if (has_normals_) {
      mesh.normals = SharedArray<Vec3>::make(vertices_.size(), [&](std::span<Vec3> normals) {
        for (std::size_t i = 0; i < normals.size(); ++i) {
          normals[i] = vertices_[i].normal == kAbsent ? Vec3(0) : file_normals_[vertices_[i].normal];
        }
        repair_normals(normals, positions, triangles_);
      });
    }
    if (palette_ != std::vector<MaterialId>{MaterialId{}}) mesh.materials = palette_;
    if (palette_.size() > 1) mesh.triangle_materials = SharedArray<std::uint16_t>(triangle_materials_);
    scene_.name = mesh.name;
    Instance instance;
    instance.name = mesh.name;
    instance.mesh = MeshId(0);
    scene_.meshes.push_back(std::move(mesh));
    scene_.instances.push_back(std::move(instance));
  }

 public:
  static std::string read_text(const std::filesystem::path& path);

 private:
  LineReader line_;
  std::string name_;
  const std::filesystem::path* directory_;
  const Context& context_;
  Scene scene_;

  std::vector<Vec3> file_positions_, file_normals_;
  std::vector<Vec2> file_uvs_;
  std::vector<Corner> vertices_;
  std::vector<std::uint32_t> first_use_, next_use_;  ///< heads by position, links by vertex
  bool has_uvs_ = false, has_normals_ = false;
  std::vector<UVec3> triangles_;
  std::vector<std::uint16_t> triangle_materials_;

  obj::MaterialNames names_;
  std::set<std::string, std::less<>> missing_, unknown_, libraries_;
  std::map<std::uint32_t, std::uint16_t> palette_entries_;
  std::vector<MaterialId> palette_;
  std::uint16_t current_material_ = 0;

  std::vector<std::uint32_t> face_vertices_;
  std::vector<Vec3> face_positions_;
  std::vector<UVec3> face_triangles_;
};

std::string ObjReader::read_text(const std::filesystem::path& path) {
  ByteStream stream(path);
  if (stream.size() > std::numeric_limits<std::size_t>::max() / 2) throw input_error("the file is too large").at(path.string());
  std::string text;
  text.reserve(static_cast<std::size_t>(stream.size()));
  while (stream.ensure(1)) {
    text.append(stream.cursor(), stream.available());
    stream.set_cursor(stream.end());
  }
  return text;
}

}  // namespace

Scene load_obj(const std::filesystem::path& path, const LoadOptions&, const Context& context) {
  std::error_code ignored;
  const auto size = std::filesystem::file_size(path, ignored);
  // The text, and arrays that are about as large.
  if (!ignored) require_memory(context, 2 * size, "the text of an OBJ file and its arrays");
  const std::string text = ObjReader::read_text(path);
  const std::filesystem::path directory = path.parent_path();
  return ObjReader(text, path.string(), &directory, context).read();
}

Scene parse_obj(std::string_view text, const std::string& name, const Context& context) {
  return ObjReader(text, name, nullptr, context).read();
}

}  // namespace sightline
