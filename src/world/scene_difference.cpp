#include "world/scene_difference.h"

#include <algorithm>
#include <variant>

namespace sightline {
namespace {

bool same(const UvTransform& a, const UvTransform& b) { return a.matrix == b.matrix && a.offset == b.offset; }
bool same(const ConstantTexture& a, const ConstantTexture& b) { return a.value == b.value; }
bool same(const ImageTexture& a, const ImageTexture& b) {
  return a.image == b.image && a.encoding == b.encoding && a.wrap_u == b.wrap_u && a.wrap_v == b.wrap_v && a.filter == b.filter &&
         same(a.uv, b.uv) && a.scale == b.scale && a.invert == b.invert;
}
bool same(const CheckerboardTexture& a, const CheckerboardTexture& b) { return a.even == b.even && a.odd == b.odd && same(a.uv, b.uv); }
bool same(const ScaleTexture& a, const ScaleTexture& b) { return a.texture == b.texture && a.factor == b.factor; }
bool same(const MixTexture& a, const MixTexture& b) { return a.first == b.first && a.second == b.second && a.amount == b.amount; }

bool same(const PointLight& a, const PointLight& b) { return a.position == b.position && a.intensity == b.intensity; }
bool same(const SpotLight& a, const SpotLight& b) {
  return a.position == b.position && a.direction == b.direction && a.intensity == b.intensity && a.inner_angle_rad == b.inner_angle_rad &&
         a.outer_angle_rad == b.outer_angle_rad && a.falloff == b.falloff;
}
bool same(const DirectionalLight& a, const DirectionalLight& b) { return a.direction == b.direction && a.irradiance == b.irradiance; }
bool same(const RectangleLight& a, const RectangleLight& b) {
  return a.center == b.center && a.half_u == b.half_u && a.half_v == b.half_v && a.radiance == b.radiance;
}
bool same(const DiskLight& a, const DiskLight& b) {
  return a.center == b.center && a.half_u == b.half_u && a.half_v == b.half_v && a.radiance == b.radiance;
}
bool same(const SphereLight& a, const SphereLight& b) { return a.center == b.center && a.radius == b.radius && a.radiance == b.radiance; }

template <class... T>
bool same_variant(const std::variant<T...>& a, const std::variant<T...>& b) {
  return a.index() == b.index() && std::visit(
                                       [&](const auto& x) {
                                         using Alternative = std::decay_t<decltype(x)>;
                                         return same(x, std::get<Alternative>(b));
                                       },
                                       a);
}

template <class T, class Equal>
bool all_same(const std::vector<T>& a, const std::vector<T>& b, Equal equal) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), equal);
}

bool same_emission(const Material& a, const Material& b) {
  return a.emission.value == b.emission.value && a.emission.texture == b.emission.texture && a.emission_two_sided == b.emission_two_sided &&
         a.alpha_mode == b.alpha_mode;
}

bool emits(const Scene& scene, MaterialId id) {
  return id.valid() && id.index < scene.materials.size() && max_component(scene.materials[id.index].emission.value) > 0;
}
bool emits(const Scene& scene, const Instance& instance) {
  if (instance.material_override.valid()) return emits(scene, instance.material_override);
  const std::vector<MaterialId>& palette = scene.meshes[instance.mesh.index].materials;
  return std::any_of(palette.begin(), palette.end(), [&](MaterialId id) { return emits(scene, id); });
}

// Whether the instance contributes the same light entries.
bool same_emitter(const Scene& scene_a, const Instance& a, const Scene& scene_b, const Instance& b) {
  if (!emits(scene_a, a) && !emits(scene_b, b)) return true;
  const Mesh &mesh_a = scene_a.meshes[a.mesh.index], &mesh_b = scene_b.meshes[b.mesh.index];
  return a.world_from_object == b.world_from_object && a.material_override == b.material_override && mesh_a.materials == mesh_b.materials &&
         mesh_a.positions == mesh_b.positions && mesh_a.triangles == mesh_b.triangles && mesh_a.uvs == mesh_b.uvs &&
         mesh_a.triangle_materials == mesh_b.triangle_materials;
}

bool same_environment(const std::optional<Environment>& a, const std::optional<Environment>& b) {
  if (!a || !b) return !a && !b;
  return a->image == b->image && a->mapping == b->mapping && a->scale == b->scale && a->world_from_environment == b->world_from_environment;
}

// Powers of lights at infinity depend on how large the scene is.
bool has_infinite_light(const Scene& scene) {
  return scene.environment || std::any_of(scene.lights.begin(), scene.lights.end(),
                                          [](const Light& light) { return std::holds_alternative<DirectionalLight>(light.shape); });
}

bool same_mesh(const Mesh& a, const Mesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.uvs == b.uvs && a.triangles == b.triangles &&
         a.triangle_materials == b.triangle_materials && a.materials == b.materials;
}

// What decides where rays pass, and which way surfaces face.
bool same_surface(const Material& a, const Material& b) {
  return a.model.index() == b.model.index() && a.normal_map == b.normal_map && a.normal_scale == b.normal_scale && a.bump == b.bump &&
         a.bump_scale == b.bump_scale && a.alpha_mode == b.alpha_mode && a.alpha_cutoff == b.alpha_cutoff &&
         a.alpha.value == b.alpha.value && a.alpha.texture == b.alpha.texture && a.two_sided == b.two_sided;
}

}  // namespace

bool same_textures(const Scene& a, const Scene& b) {
  return all_same(a.images, b.images, [](const ImageAsset& x, const ImageAsset& y) { return x.image == y.image; }) &&
         all_same(a.textures, b.textures, [](const Texture& x, const Texture& y) { return same_variant(x.node, y.node); });
}

bool same_lights(const Scene& a, const Scene& b, const Bounds& bounds_a, const Bounds& bounds_b) {
  if (has_infinite_light(a) && (bounds_a.lower != bounds_b.lower || bounds_a.upper != bounds_b.upper)) return false;
  return same_environment(a.environment, b.environment) && all_same(a.materials, b.materials, same_emission) &&
         all_same(a.lights, b.lights, [](const Light& x, const Light& y) { return same_variant(x.shape, y.shape); }) &&
         all_same(a.instances, b.instances, [&](const Instance& x, const Instance& y) { return same_emitter(a, x, b, y); }) &&
         all_same(a.spheres, b.spheres, [&](const Sphere& x, const Sphere& y) {
           return x.center == y.center && x.radius == y.radius && x.material == y.material && x.world_from_object == y.world_from_object &&
                  x.reverse_orientation == y.reverse_orientation;
         });
}

bool same_surfaces(const Scene& a, const Scene& b) {
  return all_same(a.materials, b.materials, same_surface) && all_same(a.meshes, b.meshes, same_mesh) &&
         all_same(a.instances, b.instances, [](const Instance& x, const Instance& y) {
           return x.mesh == y.mesh && x.world_from_object == y.world_from_object && x.material_override == y.material_override;
         });
}

}  // namespace sightline
