#include "session/surface_tangents.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "scene/deformation.h"

namespace sightline {
namespace {

bool differ(const FloatParam& u, const FloatParam& v) { return u.value != v.value || u.texture != v.texture || u.channel != v.channel; }

struct IsAnisotropic {
  bool operator()(const WardMaterial& m) const { return differ(m.alpha_x, m.alpha_y); }
  bool operator()(const ConductorMaterial& m) const { return differ(m.alpha_u, m.alpha_v); }
  bool operator()(const DielectricMaterial& m) const { return differ(m.alpha_u, m.alpha_v); }
  bool operator()(const CoatedDiffuseMaterial& m) const { return differ(m.alpha_u, m.alpha_v); }
  template <class Other>
  bool operator()(const Other&) const {
    return false;
  }
};

std::vector<Vec3> mean_dp_du(const Mesh& mesh) {
  std::vector<Vec3> sums(mesh.positions.size(), Vec3(0));
  for (const UVec3& t : mesh.triangles) {
    const Vec3 edge1 = mesh.positions[t.y] - mesh.positions[t.x], edge2 = mesh.positions[t.z] - mesh.positions[t.x];
    const Vec2 uv1 = mesh.uvs[t.y] - mesh.uvs[t.x], uv2 = mesh.uvs[t.z] - mesh.uvs[t.x];
    // dp/du times the determinant, whose sign alone counts: so triangles weigh by their area in space and in the texture.
    const float determinant = uv1.x * uv2.y - uv1.y * uv2.x;
    const Vec3 dp_du = (determinant < 0 ? -1.f : 1.f) * (uv2.y * edge1 - uv1.y * edge2);
    if (!is_finite(dp_du)) continue;
    for (int k = 0; k < 3; ++k) sums[t[k]] += dp_du;
  }
  return sums;
}

SharedArray<Vec4> tangents_of(const Mesh& mesh) {
  std::vector<Vec3> along;
  if (mesh.uvs.size() == mesh.positions.size()) along = mean_dp_du(mesh);
  const Vec3 center = mesh.bounds.center();
  return SharedArray<Vec4>::make(mesh.positions.size(), [&](std::span<Vec4> tangents) {
    for (std::size_t i = 0; i < tangents.size(); ++i) {
      const Vec3 from_axis = mesh.positions[i] - center;
      const Vec3 circle = normalize_or(Vec3(from_axis.z, 0, -from_axis.x), Vec3(1, 0, 0));
      tangents[i] = Vec4(along.empty() ? circle : normalize_or(along[i], circle), 1);
    }
  });
}

}  // namespace

void add_missing_tangents(Scene& scene) {
  std::vector<bool> anisotropic;
  anisotropic.reserve(scene.materials.size());
  for (const Material& material : scene.materials) anisotropic.push_back(std::visit(IsAnisotropic(), material.model));
  const auto is_anisotropic = [&](MaterialId id) { return id.index < anisotropic.size() && anisotropic[id.index]; };
  std::vector<bool> wanted;
  wanted.reserve(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) wanted.push_back(std::ranges::any_of(mesh.materials, is_anisotropic));
  for (const Instance& instance : scene.instances) {
    if (is_anisotropic(instance.material_override)) wanted[instance.mesh.index] = true;
  }
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    Mesh& mesh = scene.meshes[i];
    if (!wanted[i] || mesh.source || mesh.tangents.size() == mesh.positions.size()) continue;
    mesh.tangents = tangents_of(mesh);
    if (!mesh.deformation) continue;
    auto deformation = std::make_shared<Deformation>(*mesh.deformation);
    deformation->tangents = mesh.tangents;
    mesh.deformation = std::move(deformation);
  }
}

}  // namespace sightline
