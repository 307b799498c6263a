#include <algorithm>
#include <iterator>
#include <utility>

#include "scene/load/load.h"

namespace sightline {
namespace {

/// By how much each kind of id moves when one scene's arrays are put behind another's.
struct IdOffsets {
  std::size_t images, textures, media, materials, meshes, nodes, skins;

  void shift(ImageId& id) const { shift_by(id, images); }
  void shift(TextureId& id) const { shift_by(id, textures); }
  void shift(MediumId& id) const { shift_by(id, media); }
  void shift(MaterialId& id) const { shift_by(id, materials); }
  void shift(MeshId& id) const { shift_by(id, meshes); }
  void shift(NodeId& id) const { shift_by(id, nodes); }
  void shift(SkinId& id) const { shift_by(id, skins); }
  void shift(ColorParam& param) const { shift(param.texture); }
  void shift(FloatParam& param) const { shift(param.texture); }

  void shift(ConstantTexture&) const {}
  void shift(ImageTexture& t) const { shift(t.image); }
  void shift(CheckerboardTexture& t) const { shift_all(t.even, t.odd); }
  void shift(ScaleTexture& t) const { shift_all(t.texture, t.factor); }
  void shift(MixTexture& t) const { shift_all(t.first, t.second, t.amount); }

  void shift(DiffuseMaterial& m) const { shift(m.reflectance); }
  void shift(MetallicRoughnessMaterial& m) const { shift_all(m.base_color, m.metallic, m.roughness); }
  void shift(ConductorMaterial& m) const { shift_all(m.eta, m.k, m.reflectance_tint, m.alpha_u, m.alpha_v); }
  void shift(DielectricMaterial& m) const { shift_all(m.alpha_u, m.alpha_v); }
  void shift(CoatedDiffuseMaterial& m) const { shift_all(m.reflectance, m.alpha_u, m.alpha_v); }
  void shift(PhongMaterial& m) const { shift_all(m.diffuse, m.specular, m.exponent); }
  void shift(DiffuseTransmissionMaterial& m) const { shift_all(m.reflectance, m.transmittance); }
  void shift(MixMaterial& m) const { shift_all(m.first, m.second, m.amount); }
  void shift(InterfaceMaterial&) const {}
  void shift(WardMaterial& m) const { shift_all(m.diffuse, m.specular, m.alpha_x, m.alpha_y); }
  void shift(CookTorranceMaterial& m) const { shift_all(m.diffuse, m.specular, m.roughness, m.f0); }
  void shift(MeasuredMaterial&) const {}
  void shift(Material& m) const {
    std::visit([this](auto& model) { shift(model); }, m.model);
    shift_all(m.emission, m.normal_map, m.bump, m.alpha, m.interior);
  }

 private:
  template <class Tag>
  static void shift_by(Id<Tag>& id, std::size_t offset) {
    if (id.valid()) id = Id<Tag>(id.index + offset);
  }
  template <class... T>
  void shift_all(T&... values) const {
    (shift(values), ...);
  }
};

template <class T>
void append(std::vector<T>& target, std::vector<T>&& source) {
  target.insert(target.end(), std::make_move_iterator(source.begin()), std::make_move_iterator(source.end()));
}

}  // namespace

void merge_into(Scene& scene, Scene other) {
  const IdOffsets offsets{.images = scene.images.size(),
                          .textures = scene.textures.size(),
                          .media = scene.media.size(),
                          .materials = scene.materials.size(),
                          .meshes = scene.meshes.size(),
                          .nodes = scene.nodes.size(),
                          .skins = scene.skins.size()};
  for (Texture& texture : other.textures) {
    std::visit([&](auto& node) { offsets.shift(node); }, texture.node);
  }
  for (Material& material : other.materials) offsets.shift(material);
  for (Mesh& mesh : other.meshes) {
    for (MaterialId& id : mesh.materials) offsets.shift(id);
    offsets.shift(mesh.skin);
    offsets.shift(mesh.weights_node);
  }
  for (Instance& instance : other.instances) {
    offsets.shift(instance.mesh);
    offsets.shift(instance.material_override);
    offsets.shift(instance.node);
  }
  for (Sphere& sphere : other.spheres) offsets.shift(sphere.material);
  for (Light& light : other.lights) offsets.shift(light.node);
  for (Camera& camera : other.cameras) offsets.shift(camera.node);
  for (Node& node : other.nodes) offsets.shift(node.parent);
  for (Skin& skin : other.skins) {
    for (NodeId& joint : skin.joints) offsets.shift(joint);
  }

  // A framing box of one scene must not hide the geometry that the other adds.
  if (scene.framing || other.framing) {
    Bounds framing = scene.framing ? *scene.framing : scene_bounds(scene);
    framing.add(other.framing ? *other.framing : scene_bounds(other));
    scene.framing = framing;
  }

  append(scene.images, std::move(other.images));
  append(scene.textures, std::move(other.textures));
  append(scene.media, std::move(other.media));
  append(scene.materials, std::move(other.materials));
  append(scene.meshes, std::move(other.meshes));
  append(scene.instances, std::move(other.instances));
  append(scene.spheres, std::move(other.spheres));
  append(scene.lights, std::move(other.lights));
  append(scene.nodes, std::move(other.nodes));
  append(scene.skins, std::move(other.skins));
  append(scene.warnings, std::move(other.warnings));
  // All cameras stay, so that --camera can name any; the first is the one that is used.
  append(scene.cameras, std::move(other.cameras));
  if (!scene.environment) scene.environment = std::move(other.environment);
  if (!scene.hints.size_px) scene.hints.size_px = other.hints.size_px;
  if (!scene.hints.max_bounces) scene.hints.max_bounces = other.hints.max_bounces;
  if (!scene.hints.spp) scene.hints.spp = other.hints.spp;
  if (scene.hints.output.empty()) scene.hints.output = std::move(other.hints.output);
  if (scene.name.empty()) scene.name = std::move(other.name);
  scene.dropped_triangles += other.dropped_triangles;
  scene.animation_duration_s = std::max(scene.animation_duration_s, other.animation_duration_s);
}

}  // namespace sightline
