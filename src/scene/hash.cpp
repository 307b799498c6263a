#include <algorithm>
#include <memory>
#include <span>
#include <type_traits>

#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include "scene/scene.h"

namespace sightline {
namespace {

/// Streams fields into one 64-bit hash, field by field so that padding bytes never count.
class Hasher {
 public:
  Hasher() : state_(XXH3_createState()) { XXH3_64bits_reset(state_.get()); }
  std::uint64_t digest() const { return XXH3_64bits_digest(state_.get()); }
  void bytes(const void* data, std::size_t size) {
    if (size != 0) XXH3_64bits_update(state_.get(), data, size);
  }

  template <class T>
    requires std::is_arithmetic_v<T>
  void add(T value) {
    bytes(&value, sizeof value);
  }
  template <class T>
    requires std::is_enum_v<T>
  void add(T value) {
    add(static_cast<std::int32_t>(value));
  }
  template <class Tag>
  void add(Id<Tag> id) {
    add(id.index);
  }
  void add(const Vec2& v) { bytes(&v, sizeof v); }
  void add(const Vec3& v) { bytes(&v, sizeof v); }
  void add(const Vec4& v) { bytes(&v, sizeof v); }
  void add(const IVec2& v) { bytes(&v, sizeof v); }
  void add(const glm::mat2& m) { bytes(&m, sizeof m); }
  void add(const Mat3& m) { bytes(&m, sizeof m); }
  void add(const Mat4& m) { bytes(&m, sizeof m); }
  void add(const glm::quat& q) { add(Vec4(q.x, q.y, q.z, q.w)); }
  void add(const std::string& text) {
    add(text.size());
    bytes(text.data(), text.size());
  }
  void add(const Bounds& bounds) {
    add(bounds.lower);
    add(bounds.upper);
  }
  template <class T>
  void add(const std::optional<T>& value) {
    add(value.has_value());
    if (value) add(*value);
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(values.size());
    for (const T& value : values) add(value);
  }
  /// Plain arrays without padding go in at once.
  template <class T>
  void add_array(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(values.size());
    bytes(values.data(), values.size_bytes());
  }
  /// Which alternative, then its fields.
  template <class... T>
  void add(const std::variant<T...>& value) {
    add(value.index());
    std::visit([&](const auto& alternative) { this->add(alternative); }, value);
  }

  void add(const Image& image) {
    add(image.width);
    add(image.height);
    add(image.channels);
    add(image.data.index());
    std::visit([&](const auto& pixels) { this->add_array(std::span(pixels)); }, image.data);
  }
  void add(const std::shared_ptr<const Image>& image) {
    add(image != nullptr);
    if (image) add(*image);
  }
  void add(const ImageAsset& asset) { add(asset.image); }

  void add(const UvTransform& uv) { add_all(uv.matrix, uv.offset); }
  void add(const ConstantTexture& t) { add(t.value); }
  void add(const ImageTexture& t) { add_all(t.image, t.encoding, t.wrap_u, t.wrap_v, t.filter, t.uv, t.scale, t.invert); }
  void add(const CheckerboardTexture& t) { add_all(t.even, t.odd, t.uv); }
  void add(const ScaleTexture& t) { add_all(t.texture, t.factor); }
  void add(const MixTexture& t) { add_all(t.first, t.second, t.amount); }
  void add(const Texture& t) { add(t.node); }
  void add(const ColorParam& p) { add_all(p.value, p.texture); }
  void add(const FloatParam& p) { add_all(p.value, p.texture, p.channel); }

  void add(const DiffuseMaterial& m) { add(m.reflectance); }
  void add(const MetallicRoughnessMaterial& m) { add_all(m.base_color, m.metallic, m.roughness); }
  void add(const ConductorMaterial& m) { add_all(m.eta, m.k, m.reflectance_tint, m.alpha_u, m.alpha_v, m.remap_roughness); }
  void add(const DielectricMaterial& m) { add_all(m.eta, m.alpha_u, m.alpha_v, m.remap_roughness, m.thin); }
  void add(const CoatedDiffuseMaterial& m) { add_all(m.reflectance, m.eta, m.alpha_u, m.alpha_v, m.remap_roughness); }
  void add(const PhongMaterial& m) { add_all(m.diffuse, m.specular, m.exponent); }
  void add(const DiffuseTransmissionMaterial& m) { add_all(m.reflectance, m.transmittance); }
  void add(const MixMaterial& m) { add_all(m.first, m.second, m.amount); }
  void add(const InterfaceMaterial&) {}
  void add(const WardMaterial& m) { add_all(m.diffuse, m.specular, m.alpha_x, m.alpha_y); }
  void add(const CookTorranceMaterial& m) { add_all(m.diffuse, m.specular, m.roughness, m.f0); }
  void add(const MeasuredMaterial& m) { add(m.content_hash); }
  void add(const Material& m) {
    add_all(m.model, m.emission, m.emission_two_sided, m.normal_map, m.normal_scale, m.bump, m.bump_scale, m.alpha_mode, m.alpha_cutoff,
            m.alpha, m.two_sided, m.interior);
  }
  void add(const Medium& m) { add(m.sigma_a); }

  void add(const MorphTarget& t) {
    add_array(t.positions.span());
    add_array(t.normals.span());
    add_array(t.tangents.span());
  }
  void add(const Deformation& d) {
    add_array(d.positions.span());
    add_array(d.normals.span());
    add_array(d.tangents.span());
    add_all(d.targets, d.influences);
    add_array(d.joints.span());
    add_array(d.joint_weights.span());
  }
  void add(const Skin& s) { add_all(s.joints, s.joint_from_rest); }
  void add(const Mesh& mesh) {
    add_array(mesh.positions.span());
    add_array(mesh.normals.span());
    add_array(mesh.uvs.span());
    add_array(mesh.tangents.span());
    add_array(mesh.triangles.span());
    add_array(mesh.triangle_materials.span());
    add_all(mesh.materials, mesh.bounds);
    // A source is too big to be read for its hash: its name (which holds the parameters), counts and box stand for it.
    add(mesh.source != nullptr);
    if (mesh.source) add_all(mesh.name, mesh.source->vertex_count(), mesh.source->triangle_count());
    add(mesh.deformation != nullptr);
    if (mesh.deformation) {
      add(*mesh.deformation);
      add_all(mesh.skin, mesh.weights_node);
    }
  }
  void add(const Instance& i) { add_all(i.mesh, i.world_from_object, i.material_override, i.node); }
  void add(const Sphere& s) { add_all(s.center, s.radius, s.world_from_object, s.reverse_orientation, s.material); }

  void add(const PointLight& l) { add_all(l.position, l.intensity); }
  void add(const SpotLight& l) { add_all(l.position, l.direction, l.intensity, l.inner_angle_rad, l.outer_angle_rad, l.falloff); }
  void add(const DirectionalLight& l) { add_all(l.direction, l.irradiance); }
  void add(const RectangleLight& l) { add_all(l.center, l.half_u, l.half_v, l.radiance); }
  void add(const DiskLight& l) { add_all(l.center, l.half_u, l.half_v, l.radiance); }
  void add(const SphereLight& l) { add_all(l.center, l.radius, l.radiance); }
  void add(const Light& l) { add_all(l.shape, l.node); }
  void add(const Environment& e) { add_all(e.image, e.mapping, e.scale, e.world_from_environment); }

  void add(const Camera& c) {
    add_all(c.projection, c.world_from_camera, c.fov_axis, c.fov_rad, c.ortho_height, c.lens_radius, c.focal_distance, c.screen_window,
            c.node);
  }
  void add(const Track& t) {
    add(t.interpolation);
    add_array(std::span(t.times_s));
    add_array(std::span(t.values));
  }
  void add(const WeightsTrack& t) {
    add(t.interpolation);
    add_array(std::span(t.times_s));
    add_array(std::span(t.values));
  }
  void add(const Node& n) {
    add_all(n.parent, n.has_matrix, n.matrix, n.translation, n.rotation, n.scale, n.translation_track, n.rotation_track, n.scale_track,
            n.weights, n.weights_track);
  }
  void add(const RenderHints& h) { add_all(h.size_px, h.max_bounces, h.spp); }

 private:
  struct FreeState {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  template <class... T>
  void add_all(const T&... values) {
    (add(values), ...);
  }

  std::unique_ptr<XXH3_state_t, FreeState> state_;
};

}  // namespace

std::uint64_t scene_hash(const Scene& scene) {
  Hasher hasher;
  hasher.add(scene.images);
  hasher.add(scene.textures);
  hasher.add(scene.media);
  hasher.add(scene.materials);
  hasher.add(scene.meshes);
  hasher.add(scene.instances);
  hasher.add(scene.spheres);
  hasher.add(scene.lights);
  hasher.add(scene.environment);
  hasher.add(scene.cameras);
  hasher.add(scene.nodes);
  hasher.add(scene.skins);
  hasher.add(scene.hints);
  hasher.add(scene.framing);
  return hasher.digest();
}

}  // namespace sightline
