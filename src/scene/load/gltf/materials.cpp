#include "scene/load/gltf/materials.h"

#include <algorithm>
#include <optional>

#include "base/core/error.h"

namespace sightline::gltf {
namespace {

/// Reads one material and keeps track of the texture coordinates it needs.
class MaterialImporter {
 public:
  MaterialImporter(Import& import, TextureImporter& textures) : import_(import), textures_(textures) {}

  Material read(const JsonView& json) {
    uv_set_ = 0;
    has_uv_set_ = mixes_uv_sets_ = false;
    Material material;
    material.name = json.name();
    material.two_sided = json.bool_or("doubleSided", false);
    read_reflectance(json, material);
    read_normal_map(json, material);
    read_emission(json, material);
    read_alpha(json, material);
    if (mixes_uv_sets_) {
      import_.warn(fmt::format("{}: its textures use several sets of texture coordinates, only TEXCOORD_{} is used", json.path(), uv_set_));
    }
    return material;
  }
  std::uint64_t uv_set() const { return uv_set_; }

 private:
  TextureId texture(const JsonView& owner, std::string_view key, ColorEncoding encoding) {
    const std::optional<JsonView> info = owner.find(key);
    if (!info) return {};
    const TextureId id = textures_.add(*info, encoding);
    if (!id.valid()) return id;
    // A mesh has one set of texture coordinates: that of the first texture, which is the base colour where there is one.
    const std::uint64_t set = texture_coordinate_set(*info);
    if (!has_uv_set_) uv_set_ = set;
    has_uv_set_ = true;
    if (uv_set_ != set) mixes_uv_sets_ = true;
    return id;
  }

  void read_reflectance(const JsonView& json, Material& material) {
    MetallicRoughnessMaterial model;
    Vec4 factor{1};
    if (const std::optional<JsonView> pbr = json.find("pbrMetallicRoughness")) {
      pbr->vector_or("baseColorFactor", {&factor.x, 4});
      model.base_color.texture = texture(*pbr, "baseColorTexture", ColorEncoding::srgb);
      model.metallic.value = std::clamp(pbr->number_or("metallicFactor", 1), 0.f, 1.f);
      model.roughness.value = std::clamp(pbr->number_or("roughnessFactor", 1), 0.f, 1.f);
      const TextureId packed = texture(*pbr, "metallicRoughnessTexture", ColorEncoding::linear);
      model.metallic.texture = model.roughness.texture = packed;
      model.metallic.channel = 2;
      model.roughness.channel = 1;
    } else if (const std::optional<JsonView> gloss = json.extension("KHR_materials_pbrSpecularGlossiness")) {
      // The older model without a fallback: its diffuse part carries over, its specular colour does not.
      gloss->vector_or("diffuseFactor", {&factor.x, 4});
      model.base_color.texture = texture(*gloss, "diffuseTexture", ColorEncoding::srgb);
      model.metallic.value = 0;
      model.roughness.value = std::clamp(1 - gloss->number_or("glossinessFactor", 1), 0.f, 1.f);
    }
    factor = glm::clamp(factor, Vec4(0), Vec4(1));
    model.base_color.value = Color(factor);
    material.alpha.value = factor.a;
    material.alpha.texture = model.base_color.texture;
    material.alpha.channel = 3;
    material.model = model;
  }

  void read_normal_map(const JsonView& json, Material& material) {
    const std::optional<JsonView> info = json.find("normalTexture");
    if (!info) return;
    material.normal_map = texture(json, "normalTexture", ColorEncoding::linear);
    material.normal_scale = info->number_or("scale", 1);
    textures_.mark_normal_map(material.normal_map);
  }

  void read_emission(const JsonView& json, Material& material) {
    Color factor{0};
    json.vector_or("emissiveFactor", {&factor.x, 3});
    float strength = 1;
    if (const std::optional<JsonView> extension = json.extension("KHR_materials_emissive_strength")) {
      strength = extension->number_or("emissiveStrength", 1);
    }
    material.emission.value = glm::max(factor * strength, Color(0));
    if (is_black(material.emission.value)) return;
    material.emission.texture = texture(json, "emissiveTexture", ColorEncoding::srgb);
    material.emission_two_sided = material.two_sided;
  }

  static void read_alpha(const JsonView& json, Material& material) {
    const std::optional<JsonView> member = json.find("alphaMode");
    const std::string mode = member ? member->as_string() : "OPAQUE";
    if (mode == "MASK") {
      material.alpha_mode = AlphaMode::mask;
      material.alpha_cutoff = json.number_or("alphaCutoff", 0.5f);
    } else if (mode == "BLEND") {
      material.alpha_mode = AlphaMode::blend;
    } else if (mode == "OPAQUE") {
      material.alpha = FloatParam(1);
    } else {
      throw input_error(fmt::format("'{}' is no alpha mode", mode)).at(member->path());
    }
  }

  Import& import_;
  TextureImporter& textures_;
  std::uint64_t uv_set_ = 0;
  bool has_uv_set_ = false, mixes_uv_sets_ = false;
};

}  // namespace

std::vector<std::uint64_t> import_materials(Import& import, TextureImporter& textures) {
  MaterialImporter importer(import, textures);
  std::vector<std::uint64_t> uv_sets;
  std::size_t blended = 0;
  for (std::size_t i = 0; i < import.document.count("materials"); ++i) {
    import.scene.materials.push_back(importer.read(import.document.element("materials", i)));
    uv_sets.push_back(importer.uv_set());
    blended += import.scene.materials.back().alpha_mode == AlphaMode::blend;
  }
  if (blended > 0) import.warn(fmt::format("{} materials blend by alpha, they are masked at 0.5 instead", blended));
  return uv_sets;
}

}  // namespace sightline::gltf
