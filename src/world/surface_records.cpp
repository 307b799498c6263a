#include "world/surface_records.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

MaterialRecord record_of(const Material& material, std::uint32_t index) {
  MaterialRecord record;
  record.material = index;
  record.emits = max_component(material.emission.value) > 0;
  if (const auto* diffuse = std::get_if<DiffuseMaterial>(&material.model)) {
    record.plain = !diffuse->reflectance.texture.valid() && !material.normal_map.valid() && !material.bump.valid();
    const Color& c = diffuse->reflectance.value;
    // As make_bsdf does: into [0, 1], not-a-number becomes 0.
    for (int i = 0; i < 3; ++i) record.albedo[i] = c[i] > 0 ? std::min(c[i], 1.f) : 0.f;
  }
  return record;
}

// Rounding of Embree's way to an instance and back. It inverts the matrix in single precision (adjoint over determinant), then carries
// each ray's origin through the inverse; both errors are measured in object space and come back through the matrix.
void set_transform_error(InstanceRecord& record) {
  const glm::dmat3 m(record.linear);
  const glm::dmat3 inverse = glm::inverse(m);
  const auto absolute = [](const glm::dmat3& a) {
    glm::dmat3 result;
    for (int i = 0; i < 3; ++i) result[i] = glm::abs(a[i]);
    return result;
  };
  const glm::dmat3 size = absolute(m);
  double determinant_terms = 0;
  glm::dmat3 cofactor_terms(0);
  for (int column = 0; column < 3; ++column) {
    const int c1 = (column + 1) % 3, c2 = (column + 2) % 3;
    for (int row = 0; row < 3; ++row) {
      const int r1 = (row + 1) % 3, r2 = (row + 2) % 3;
      const double terms = size[c1][r1] * size[c2][r2] + size[c1][r2] * size[c2][r1];
      cofactor_terms[row][column] = terms;  // of the inverse's entry: transposed
      if (column == 0) determinant_terms += size[0][row] * terms;
    }
  }
  const double determinant = std::fabs(glm::determinant(m));
  const glm::dmat3 inverse_size = absolute(inverse);
  glm::dmat3 inverse_error;
  for (int i = 0; i < 3; ++i) {
    inverse_error[i] = 4.0 * cofactor_terms[i] / determinant + inverse_size[i] * (4.0 + 6.0 * determinant_terms / determinant);
  }
  const glm::dmat3 way = size * inverse_error;
  const glm::dvec3 translation = glm::abs(glm::dvec3(record.translation));
  const auto row_sum = [](const glm::dmat3& a) {
    double most = 0;
    for (int row = 0; row < 3; ++row) most = std::max(most, a[0][row] + a[1][row] + a[2][row]);
    return most;
  };
  const glm::dvec3 from_translation = way * translation;
  const double moved = std::max({translation.x, translation.y, translation.z});
  // M p + t itself: four roundings of each term; |M p| <= local_scale |p| is added where |p| is known.
  record.local_scale = static_cast<float>(row_sum(size));
  record.world_scale = kRounding * static_cast<float>(row_sum(way));
  record.constant = kRounding * static_cast<float>(4 * moved + std::max({from_translation.x, from_translation.y, from_translation.z}));
}

}  // namespace

SurfaceTables make_surface_tables(const Scene& scene, const Placement& placement, bool shadow_terminator) {
  SurfaceTables tables;
  tables.shadow_terminator = shadow_terminator;
  tables.spheres = scene.spheres;
  const auto default_index = static_cast<std::uint32_t>(scene.materials.size());
  for (std::uint32_t i = 0; i < default_index; ++i) tables.materials.push_back(record_of(scene.materials[i], i));
  tables.materials.push_back(record_of(Material{}, kDefaultMaterial));
  const auto index_of = [&](MaterialId id) { return id.valid() ? std::min(id.index, default_index) : default_index; };

  // Palettes first, by offset: their addresses are known once all of them stand in one array.
  std::vector<std::size_t> offsets;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh.index];
    offsets.push_back(tables.palettes.size());
    if (instance.material_override.valid() || mesh.materials.empty()) {
      tables.palettes.push_back(index_of(instance.material_override));
    } else {
      for (const MaterialId id : mesh.materials) tables.palettes.push_back(index_of(id));
    }
  }
  tables.palettes.shrink_to_fit();
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh.index];
    const PlacedMesh& placed = placement.instances[i];
    InstanceRecord record;
    record.palette = tables.palettes.data() + offsets[i];
    record.palette_size = static_cast<std::uint32_t>((i + 1 < offsets.size() ? offsets[i + 1] : tables.palettes.size()) - offsets[i]);
    for (std::uint32_t j = 0; j < record.palette_size; ++j) record.emits = record.emits || tables.materials[record.palette[j]].emits;
    if (record.palette_size > 1 && mesh.triangle_materials.size() >= mesh.triangles.size()) {
      record.triangle_materials = mesh.triangle_materials.data();
    } else if (record.palette_size == 1) {
      record.triangle_materials = nullptr;
    }
    if (placed.kind != PlacedMesh::Kind::absent) {
      record.positions = placed.positions.data();
      record.triangles = placed.triangles.data();
      if (mesh.normals.size() >= placed.positions.size()) record.normals = mesh.normals.data();
      record.winding = placed.mirrored ? -1.f : 1.f;
      record.transforms = placed.kind == PlacedMesh::Kind::instanced;
      record.transforms_normals = placed.world_from_object != Mat4(1);
      const Vec3 x(placed.world_from_object[0]), y(placed.world_from_object[1]), z(placed.world_from_object[2]);
      // Cofactors: the inverse transpose times the determinant, which exists for flattened instances too. Scaled to stay in range.
      const float scale = std::max({glm::length(x), glm::length(y), glm::length(z)});
      const Vec3 a = x / scale, b = y / scale, c = z / scale;
      record.normal_matrix = record.winding * Mat3(glm::cross(b, c), glm::cross(c, a), glm::cross(a, b));
      constexpr std::size_t kMaxGather = std::size_t{1} << 29;
      record.gathers = !record.transforms && !(record.normals && record.transforms_normals) && placed.positions.size() < kMaxGather &&
                       placed.triangles.size() < kMaxGather;
      if (record.transforms) {
        record.linear = Mat3(x, y, z);
        record.translation = Vec3(placed.world_from_object[3]);
        set_transform_error(record);
      }
    }
    tables.instances.push_back(record);
  }
  return tables;
}

}  // namespace sightline
