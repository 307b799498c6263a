#include "scene/load/gltf/meshes.h"

#include "base/core/error.h"
#include "scene/load/gltf/accessor.h"
#include "scene/load/gltf/skins.h"
#include "scene/load/gltf/triangles.h"
#include "scene/load/load.h"

namespace sightline::gltf {
namespace {

template <class T, class Convert>
SharedArray<T> read_array(Document& document, std::size_t accessor, int components, const Convert& convert) {
  const std::vector<float> values = read_floats(document, accessor, components);
  return SharedArray<T>::make(values.size() / static_cast<std::size_t>(components), [&](std::span<T> target) {
    for (std::size_t i = 0; i < target.size(); ++i) target[i] = convert(&values[i * static_cast<std::size_t>(components)], i);
  });
}

}  // namespace

std::vector<MeshImporter::Part>& MeshImporter::parts(std::size_t gltf_mesh) {
  if (const auto found = parts_.find(gltf_mesh); found != parts_.end()) return found->second;
  import_.context.check_cancelled();
  const JsonView mesh = import_.document.element("meshes", gltf_mesh);
  const std::string name = mesh.name();
  const JsonView primitives = mesh.require("primitives");
  std::vector<Part> parts;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    add_primitive(primitives.at(i), primitives.size() == 1 ? name : fmt::format("{}/{}", name, i), parts);
  }
  return parts_[gltf_mesh] = std::move(parts);
}

std::vector<PlacedPart> MeshImporter::place(const JsonView& reference, NodeId node, std::optional<SkinId> skin) {
  std::vector<PlacedPart> placed;
  for (Part& part : parts(import_.document.resolve("meshes", reference))) {
    const bool skinned = skin && part.deformation && part.deformation->influences > 0;
    if (skin && !skinned) ++without_joints_;
    if (skinned || (part.deformation && !part.deformation->targets.empty())) {
      add_bent(part, node, skinned ? skin : std::nullopt, reference);
      placed.push_back({MeshId(import_.scene.meshes.size() - 1), skinned});
      continue;
    }
    if (!part.shared.valid()) {
      part.shared = MeshId(import_.scene.meshes.size());
      import_.scene.meshes.push_back(part.mesh);
    }
    placed.push_back({part.shared, false});
  }
  return placed;
}

void MeshImporter::add_bent(const Part& part, NodeId node, std::optional<SkinId> skin, const JsonView& reference) {
  if (skin && part.largest_joint >= import_.scene.skins[skin->index].joints.size()) {
    throw input_error(
        fmt::format("a vertex hangs on joint {}, the skin has {}", part.largest_joint, import_.scene.skins[skin->index].joints.size()))
        .at(reference.path());
  }
  if (!part.deformation->targets.empty() && part.deformation->targets.size() != import_.scene.nodes[node.index].weights.size()) {
    throw input_error("the primitives of a mesh must have equally many morph targets").at(reference.path());
  }
  // The scene, posed, holds bent copies of the vertices.
  const Mesh& mesh = part.mesh;
  import_.document.charge(sizeof(Mesh) + mesh.positions.size_bytes() + mesh.normals.size_bytes() + mesh.tangents.size_bytes(),
                          reference.path());
  Mesh bent = mesh;
  bent.deformation = part.deformation;
  bent.skin = skin.value_or(SkinId());
  bent.weights_node = node;
  import_.scene.meshes.push_back(std::move(bent));
}

void MeshImporter::add_primitive(const JsonView& primitive, const std::string& name, std::vector<Part>& parts) {
  const std::uint64_t mode = primitive.unsigned_or("mode", kTriangles);
  if (mode > kTriangleFan) throw input_error(fmt::format("{} is no primitive mode", mode)).at(primitive.path() + "/mode");
  if (mode < kTriangles) {
    ++lines_and_points_;
    return;
  }
  const JsonView attributes = primitive.require("attributes");
  const std::optional<JsonView> position = attributes.find("POSITION");
  if (!position) {
    ++without_positions_;
    return;
  }
  coloured_ += attributes.find("COLOR_0").has_value();

  const std::size_t position_accessor = import_.document.resolve("accessors", *position);
  if (primitive.extension("KHR_draco_mesh_compression") && !accessor_info(import_.document, position_accessor).has_data) {
    throw input_error("the geometry is only there in compressed form (KHR_draco_mesh_compression), which is not supported")
        .at(primitive.path())
        .remedy("save the model without mesh compression");
  }

  Mesh mesh;
  mesh.name = name;
  std::uint64_t uv_set = 0;
  choose_material(primitive, mesh, uv_set);
  const Positions& vertices = positions(position_accessor);
  mesh.positions = vertices.array;
  const Triangles& faces = triangles(primitive, mode, position_accessor, vertices);
  mesh.triangles = faces.array;
  mesh.bounds = faces.bounds;
  if (mesh.triangles.empty()) return;

  bool has_broken_normals = false;
  if (const std::optional<JsonView> attribute = attributes.find("NORMAL")) {
    const Normals& data = normals(import_.document.resolve("accessors", *attribute));
    check_count(data.array.size(), mesh, *attribute);
    mesh.normals = data.array;
    has_broken_normals = data.has_broken;
    // Without normals a mesh is flat shaded and its tangents mean nothing [glTF2, §3.7.2].
    if (const std::optional<JsonView> tangent = attributes.find("TANGENT")) {
      mesh.tangents = tangents(import_.document.resolve("accessors", *tangent));
      check_count(mesh.tangents.size(), mesh, *tangent);
    }
  }
  if (const std::optional<JsonView> attribute = attributes.find(fmt::format("TEXCOORD_{}", uv_set))) {
    mesh.uvs = uvs(import_.document.resolve("accessors", *attribute));
    check_count(mesh.uvs.size(), mesh, *attribute);
  } else if (uv_set > 0) {
    ++without_uvs_;
  }

  PrimitiveDeformation bending = read_deformation(import_, primitive, mesh.positions.size());
  if (uses_few_vertices(mesh)) {
    const std::size_t vertex_bytes = 2 * sizeof(Vec3) + sizeof(Vec2) + 3 * sizeof(Vec3) * bending.deformation.targets.size() +
                                     (sizeof(float) + sizeof(std::uint16_t)) * bending.deformation.influences;
    import_.document.charge(mesh.triangles.size() * (sizeof(UVec3) + 3 * vertex_bytes), primitive.path());
    keep_vertices(bending.deformation, drop_unused_vertices(mesh));
  }
  if (has_broken_normals) {
    import_.document.charge(mesh.normals.size_bytes(), primitive.path());
    repair_normals(mesh);
    ++broken_normals_;
  }
  Part part;
  if (bending.bends()) {
    bending.deformation.positions = mesh.positions;
    bending.deformation.normals = mesh.normals;
    bending.deformation.tangents = mesh.tangents;
    part.largest_joint = bending.largest_joint;
    part.deformation = std::make_shared<const Deformation>(std::move(bending.deformation));
  }
  part.mesh = std::move(mesh);
  parts.push_back(std::move(part));
}

void MeshImporter::choose_material(const JsonView& primitive, Mesh& mesh, std::uint64_t& uv_set) {
  const std::optional<JsonView> reference = primitive.find("material");
  if (!reference) return;
  const std::size_t material = import_.document.resolve("materials", *reference);
  mesh.materials = {MaterialId(material)};
  uv_set = material_uv_sets_[material];
}

const MeshImporter::Triangles& MeshImporter::triangles(const JsonView& primitive, std::uint64_t mode, std::size_t position_accessor,
                                                       const Positions& positions) {
  const std::optional<JsonView> reference = primitive.find("indices");
  constexpr auto kNoIndices = static_cast<std::size_t>(-1);
  const std::size_t accessor = reference ? import_.document.resolve("accessors", *reference) : kNoIndices;
  const auto key = std::make_tuple(accessor, position_accessor, mode);
  if (const auto found = triangles_.find(key); found != triangles_.end()) return found->second;

  std::vector<UVec3> result;
  const auto charge = [&](std::size_t index_count) {
    import_.document.charge(triangle_count(mode, index_count) * sizeof(UVec3), primitive.path());
  };
  if (reference) {
    const std::vector<std::uint32_t> indices = read_unsigned(import_.document, accessor);
    charge(indices.size());
    result = assemble_triangles(mode, indices);
  } else {
    charge(positions.array.size());
    result = assemble_triangles(mode, positions.array.size());
  }

  // Triangles at vertices that the file left without a finite position go first: such vertices hold a stand-in by now.
  const std::size_t before = result.size();
  if (!positions.is_broken.empty()) {
    const auto is_broken = [&](std::uint32_t v) { return v < positions.is_broken.size() && positions.is_broken[v] != 0; };
    std::erase_if(result, [&](const UVec3& t) { return is_broken(t.x) || is_broken(t.y) || is_broken(t.z); });
  }
  import_.scene.dropped_triangles += before - result.size();
  drop_bad_triangles(positions.array.span(), result, nullptr, import_.scene.dropped_triangles);
  Bounds bounds;
  for (const UVec3& t : result) {
    for (int corner = 0; corner < 3; ++corner) bounds.add(positions.array[t[corner]]);
  }
  return triangles_[key] = {.array = SharedArray<UVec3>(result), .bounds = bounds};
}

const MeshImporter::Positions& MeshImporter::positions(std::size_t accessor) {
  const auto [found, is_new] = positions_.try_emplace(accessor);
  Positions& result = found->second;
  if (!is_new) return result;
  const AccessorInfo info = accessor_info(import_.document, accessor);
  if (info.count >= 0xffffffffu) throw input_error(fmt::format("{} vertices are too many for one mesh", info.count)).at(info.path);
  Vec3 stand_in{0};
  std::vector<std::uint8_t> is_broken;
  result.array = read_array<Vec3>(import_.document, accessor, 3, [&](const float* p, std::size_t i) {
    const Vec3 position{p[0], p[1], p[2]};
    if (is_finite(position)) return stand_in = position;
    is_broken.resize(static_cast<std::size_t>(info.count));
    is_broken[i] = 1;
    return stand_in;
  });
  result.is_broken = std::move(is_broken);
  return result;
}

const MeshImporter::Normals& MeshImporter::normals(std::size_t accessor) {
  const auto [found, is_new] = normals_.try_emplace(accessor);
  Normals& result = found->second;
  if (!is_new) return result;
  result.array = read_array<Vec3>(import_.document, accessor, 3, [&](const float* n, std::size_t) {
    const Vec3 normal = normalize_or({n[0], n[1], n[2]}, Vec3(0));
    if (length_squared(normal) == 0) result.has_broken = true;
    return normal;
  });
  return result;
}

SharedArray<Vec2> MeshImporter::uvs(std::size_t accessor) {
  const auto [found, is_new] = uvs_.try_emplace(accessor);
  if (is_new) {
    found->second = read_array<Vec2>(import_.document, accessor, 2, [](const float* t, std::size_t) {
      return Vec2(std::isfinite(t[0]) ? t[0] : 0, std::isfinite(t[1]) ? t[1] : 0);
    });
  }
  return found->second;
}

SharedArray<Vec4> MeshImporter::tangents(std::size_t accessor) {
  const auto [found, is_new] = tangents_.try_emplace(accessor);
  if (is_new) {
    found->second = read_array<Vec4>(import_.document, accessor, 4, [](const float* t, std::size_t) {
      return Vec4(normalize_or({t[0], t[1], t[2]}, Vec3(0)), t[3] < 0 ? -1.f : 1.f);
    });
  }
  return found->second;
}

void MeshImporter::check_count(std::size_t count, const Mesh& mesh, const JsonView& attribute) const {
  if (count == mesh.positions.size()) return;
  throw input_error(fmt::format("the attribute has {} elements for {} vertices", count, mesh.positions.size())).at(attribute.path());
}

void MeshImporter::warn_of_losses() const {
  const auto warn = [&](std::size_t count, std::string_view text) {
    if (count > 0) import_.warn(fmt::format("{} {}", count, text));
  };
  warn(lines_and_points_, "primitives of lines or points are left out");
  warn(without_positions_, "primitives without positions are left out");
  warn(without_joints_, "primitives of skinned meshes lack joints or weights and do not bend");
  warn(coloured_, "primitives have vertex colours, which are ignored");
  warn(without_uvs_, "primitives lack the texture coordinates that their material uses");
  warn(broken_normals_, "primitives have normals of length zero, which are replaced by those of their faces");
  warn(static_cast<std::size_t>(import_.scene.dropped_triangles), "triangles are dropped: degenerate, not finite, or with a wrong index");
}

}  // namespace sightline::gltf
