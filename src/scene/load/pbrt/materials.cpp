// Material and MakeNamedMaterial.
#include <cmath>

#include "base/settings/settings.h"
#include "scene/load/pbrt/builder.h"

namespace sightline::pbrt {
namespace {

constexpr int kMaxMixDepth = 32;

}  // namespace

ColorParam Builder::color_parameter(const ParameterList& parameters, std::string_view name, Color fallback, ColorSpace space) {
  if (const Parameter* const texture = parameters.find(name, "texture")) {
    ColorParam result(1.f);
    result.texture = find_texture(*texture, true);
    return result;
  }
  return surface_color(parameters, name, fallback, space);
}

FloatParam Builder::float_parameter(const ParameterList& parameters, std::string_view name, float fallback) {
  if (const Parameter* const texture = parameters.find(name, "texture")) {
    FloatParam result(1.f);
    result.texture = find_texture(*texture, false);
    return result;
  }
  return parameters.number(name, fallback);
}

void Builder::roughness(const ParameterList& parameters, const std::string& prefix, FloatParam& alpha_u, FloatParam& alpha_v) {
  const FloatParam both = float_parameter(parameters, prefix + "roughness", 0);
  alpha_u = parameters.has(prefix + "uroughness") ? float_parameter(parameters, prefix + "uroughness", 0) : both;
  alpha_v = parameters.has(prefix + "vroughness") ? float_parameter(parameters, prefix + "vroughness", 0) : both;
}

float Builder::dielectric_index(const ParameterList& parameters, const Place& place, ColorSpace space, std::string_view name) {
  if (parameters.find(name, "texture") != nullptr) {
    warn(place, "a textured index of refraction is not supported; 1.5 is used");
    return 1.5f;
  }
  const std::optional<SpectrumValue> value = spectrum_value(parameters, name, space);
  float eta = parameters.number(name, 1.5f);
  if (value) {
    eta = value->spectrum ? mean_value(*value->spectrum) : (value->rgb.x + value->rgb.y + value->rgb.z) / 3;
    warn_once(place, "dispersion is not supported: a spectral index of refraction becomes its mean");
  }
  if (!(eta > 0) || !std::isfinite(eta)) throw error_at(place, fmt::format("an index of refraction of {} is not positive", eta));
  return eta;
}

ConductorMaterial Builder::conductor(const ParameterList& parameters, const std::string& prefix, ColorSpace space, const Place& place) {
  ConductorMaterial result;
  roughness(parameters, prefix, result.alpha_u, result.alpha_v);
  const std::string reflectance = prefix.empty() ? "reflectance" : prefix.substr(0, prefix.size() - 1) + ".reflectance";
  if (const Parameter* const texture = parameters.find(reflectance, "texture")) {
    result.eta = 1.f;
    result.k = 1e4f;  // a perfect mirror, tinted
    result.reflectance_tint.texture = find_texture(*texture, true);
    warn_once(place, "a textured conductor reflectance tints a mirror: its edges do not grow brighter as they do in pbrt");
    return result;
  }
  if (parameters.find(reflectance, "rgb spectrum") != nullptr) {
    // The index that gives this reflectance at normal incidence: eta = 1, k = 2 sqrt(r / (1 - r)).
    const Color r = glm::clamp(surface_color(parameters, reflectance, Color(0), space), Color(0), Color(0.9999f));
    result.eta = 1.f;
    result.k = 2.f * glm::sqrt(r / (Color(1) - r));
    return result;
  }
  for (const std::string& name : {prefix + "eta", prefix + "k"}) {
    if (const Parameter* const texture = parameters.find(name, "texture")) {
      warn(texture->place, "a textured index of a conductor is not supported; that of copper is used");
    }
  }
  const auto value_or_copper = [&](const std::string& name, std::string_view copper) {
    std::optional<SpectrumValue> value = spectrum_value(parameters, prefix + name, space);
    if (!value) value = SpectrumValue{named_spectrum(copper), Color(0)};
    return *value;
  };
  const SpectrumValue eta = value_or_copper("eta", "metal-Cu-eta"), k = value_or_copper("k", "metal-Cu-k");
  if (eta.spectrum && k.spectrum) {
    const ConductorColors colors = conductor_colors(*eta.spectrum, *k.spectrum);
    result.eta = colors.eta;
    result.k = colors.k;
  } else {
    result.eta = glm::max(eta.spectrum ? reflectance_color(*eta.spectrum) : eta.rgb, Color(1e-3f));
    result.k = glm::max(k.spectrum ? reflectance_color(*k.spectrum) : k.rgb, Color(0));
  }
  return result;
}

Builder::MaterialEntry Builder::make_material(const std::string& type, const ParameterList& parameters, const GraphicsState& state,
                                              const Place& place) {
  MaterialEntry entry;
  entry.place = place;
  Material& material = entry.material;
  const ColorSpace space = state.color_space;
  const auto remap = [&] { return parameters.boolean("remaproughness", true); };

  if (type == "diffuse") {
    material.model = DiffuseMaterial{color_parameter(parameters, "reflectance", Color(0.5f), space)};
    if (parameters.number("sigma", 0) != 0) warn(place, "Oren-Nayar roughness (sigma) is not supported");
  } else if (type == "coateddiffuse") {
    CoatedDiffuseMaterial model;
    model.reflectance = color_parameter(parameters, "reflectance", Color(0.5f), space);
    roughness(parameters, "", model.alpha_u, model.alpha_v);
    model.eta = dielectric_index(parameters, place, space);
    model.remap_roughness = remap();
    // How pbrt's random walk between the layers is cut off; ours is one analytic model.
    parameters.ignore({"maxdepth", "nsamples", "thickness", "g", "twosided"});
    if (!is_black(surface_color(parameters, "albedo", Color(0), space))) warn(place, "a scattering layer (albedo) is not supported");
    material.model = model;
  } else if (type == "conductor") {
    ConductorMaterial model = conductor(parameters, "", space, place);
    model.remap_roughness = remap();
    material.model = model;
  } else if (type == "coatedconductor") {
    warn(place, "coatedconductor is approximated by its conductor without the coat");
    ConductorMaterial model = conductor(parameters, "conductor.", space, place);
    // Seen from inside the coat, the metal's index counts relative to the coat's.
    const float coat = dielectric_index(parameters, place, space, "interface.eta");
    model.eta.value /= coat;
    model.k.value /= coat;
    model.remap_roughness = remap();
    parameters.ignore({"interface.roughness", "interface.uroughness", "interface.vroughness", "thickness", "maxdepth", "nsamples", "g",
                       "albedo", "twosided"});
    material.model = model;
  } else if (type == "dielectric") {
    DielectricMaterial model;
    model.eta = dielectric_index(parameters, place, space);
    roughness(parameters, "", model.alpha_u, model.alpha_v);
    model.remap_roughness = remap();
    material.model = model;
  } else if (type == "thindielectric") {
    DielectricMaterial model;
    model.eta = dielectric_index(parameters, place, space);
    model.thin = true;
    material.model = model;
  } else if (type == "diffusetransmission") {
    DiffuseTransmissionMaterial model;
    model.reflectance = color_parameter(parameters, "reflectance", Color(0.25f), space);
    model.transmittance = color_parameter(parameters, "transmittance", Color(0.25f), space);
    const float scale = parameters.number("scale", 1);
    model.reflectance.value *= scale;
    model.transmittance.value *= scale;
    parameters.ignore({"remaproughness"});
    material.model = model;
  } else if (type == "mix") {
    const Parameter* const names = parameters.find("materials", "string");
    if (names == nullptr || names->strings.size() != 2) throw error_at(place, "a mix needs \"string materials\" with two names");
    MixMaterial model;
    model.amount = float_parameter(parameters, "amount", 0.5f);
    material.model = model;
    Slot* const slots[2] = {&entry.mix_first, &entry.mix_second};
    for (std::size_t i = 0; i < 2; ++i) {
      const auto found = material_names_.find(names->strings[i]);
      if (found == material_names_.end() || !materials_[static_cast<std::size_t>(found->second)].defined) {
        throw error_at(names->place, fmt::format("material '{}' of the mix is not defined yet", shown(names->strings[i])));
      }
      *slots[i] = found->second;
      entry.depth = std::max(entry.depth, materials_[static_cast<std::size_t>(found->second)].depth + 1);
    }
    if (entry.depth > kMaxMixDepth) throw error_at(place, "mixes of materials are nested too deeply");
  } else if (type == "interface" || type.empty() || type == "none") {
    material.model = InterfaceMaterial{};
  } else if (std::optional<SurfaceModel> model = legacy_model(type, parameters, space, place)) {
    material.model = *model;
  } else {
    warn(place, fmt::format("material type '{}' is not supported; diffuse 0.5 is used", shown(type)));
    material.model = DiffuseMaterial{Color(0.5f)};
    for (const Parameter& parameter : parameters.all()) parameter.used = true;
  }

  if (const Parameter* const texture = parameters.find("displacement", "texture")) {
    material.bump = find_texture(*texture, false);
  } else if (parameters.find("displacement", "float") != nullptr) {
    // A constant displacement tilts nothing.
  }
  if (const std::string file = parameters.text("normalmap", ""); !file.empty()) {
    ImageTexture node;
    node.image = ImageId(static_cast<std::size_t>(add_image(file, place)));
    node.encoding = ColorEncoding::linear;
    node.filter = TextureFilter::linear;
    material.normal_map = add_texture({"normalmap", node}, {});
  }
  report_unused(parameters, fmt::format("material type '{}'", shown(type)));
  return entry;
}

Slot Builder::material(const std::string& type, const ParameterList& parameters, const GraphicsState& state, const Place& place) {
  MaterialEntry entry = make_material(type, parameters, state, place);
  entry.material.name = type;
  materials_.push_back(std::move(entry));
  return static_cast<Slot>(materials_.size()) - 1;
}

void Builder::named_material(const std::string& name, const ParameterList& parameters, const GraphicsState& state, const Place& place) {
  const std::string type = parameters.text("type", "");
  if (type.empty()) throw error_at(place, fmt::format("named material '{}' has no \"string type\"", shown(name)));
  MaterialEntry entry = make_material(type, parameters, state, place);
  entry.material.name = name;
  const auto [found, is_new] = material_names_.try_emplace(name, static_cast<Slot>(materials_.size()));
  if (is_new) {
    materials_.push_back(std::move(entry));
    return;
  }
  MaterialEntry& known = materials_[static_cast<std::size_t>(found->second)];
  if (!known.defined) {  // used before its definition
    known = std::move(entry);
    return;
  }
  warn(place, fmt::format("named material '{}' is defined again; shapes that follow use this one", shown(name)));
  found->second = static_cast<Slot>(materials_.size());
  materials_.push_back(std::move(entry));
}

Slot Builder::use_named_material(const std::string& name, const Place& place) {
  const auto [found, is_new] = material_names_.try_emplace(name, static_cast<Slot>(materials_.size()));
  if (is_new) {
    MaterialEntry entry;
    entry.material.name = name;
    entry.material.model = DiffuseMaterial{Color(0.5f)};
    entry.defined = false;
    entry.place = place;
    materials_.push_back(std::move(entry));
  }
  return found->second;
}

void Builder::named_medium(const std::string& name, const ParameterList& parameters, const GraphicsState& state, const Place& place) {
  const std::string type = parameters.text("type", "");
  Medium medium{name, Color(0)};
  if (type != "homogeneous") {
    warn(place, fmt::format("medium type '{}' is not supported; the medium is left out", shown(type)));
    for (const Parameter& parameter : parameters.all()) parameter.used = true;
  } else {
    const float scale = parameters.number("scale", 1);
    if (parameters.has("preset")) {
      warn(place, "medium presets are not supported; the default coefficients are used");
      parameters.ignore({"preset"});
    }
    // pbrt's defaults, per millimetre [Jensen2001].
    medium.sigma_a = scale * surface_color(parameters, "sigma_a", Color(0.0011f, 0.0024f, 0.014f), state.color_space);
    const Color scattering = surface_color(parameters, "sigma_s", Color(2.55f, 3.21f, 3.77f), state.color_space);
    if (!is_black(scattering)) warn(place, fmt::format("medium '{}' scatters; only its absorption is honoured", shown(name)));
    if (parameters.has("Le")) warn(place, fmt::format("medium '{}' emits; only its absorption is honoured", shown(name)));
    parameters.ignore({"g", "Le", "Lescale"});
    if (!is_finite(medium.sigma_a)) throw error_at(place, "an absorption coefficient is not finite");
  }
  report_unused(parameters, "the medium");
  scene_.media.push_back(std::move(medium));
  media_.insert_or_assign(name, MediumId(scene_.media.size() - 1));
}

MediumId Builder::medium_for(const std::string& name, const Place& place) {
  if (name.empty()) return {};
  const auto found = media_.find(name);
  if (found == media_.end()) {
    warn_once(place, fmt::format("there is no medium '{}'", shown(name)));
    return {};
  }
  return is_black(scene_.media[found->second.index].sigma_a) ? MediumId() : found->second;
}

}  // namespace sightline::pbrt
