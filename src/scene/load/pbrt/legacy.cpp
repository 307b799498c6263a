// Materials of pbrt-v3 by the nearest of pbrt-v4, each with a warning.
#include "scene/load/pbrt/builder.h"

namespace sightline::pbrt {

std::optional<SurfaceModel> Builder::legacy_model(const std::string& type, const ParameterList& parameters, ColorSpace space,
                                                  const Place& place) {
  const auto take_as = [&](std::string_view what) { warn_once(place, fmt::format("pbrt-v3 material '{}' is read as {}", type, what)); };
  parameters.ignore({"bumpmap"});
  const auto metal_roughness = [&](ConductorMaterial& model) {
    const FloatParam both = float_parameter(parameters, "roughness", 0.01f);
    model.alpha_u = parameters.has("uroughness") ? float_parameter(parameters, "uroughness", 0.01f) : both;
    model.alpha_v = parameters.has("vroughness") ? float_parameter(parameters, "vroughness", 0.01f) : both;
    model.remap_roughness = parameters.boolean("remaproughness", true);
  };
  if (type == "matte") {
    take_as("diffuse");
    parameters.ignore({"sigma"});
    return DiffuseMaterial{color_parameter(parameters, "Kd", Color(0.5f), space)};
  }
  if (type == "plastic" || type == "uber" || type == "substrate") {
    take_as("coateddiffuse of the same Kd and roughness");
    CoatedDiffuseMaterial model;
    model.reflectance = color_parameter(parameters, "Kd", Color(type == "substrate" ? 0.5f : 0.25f), space);
    model.alpha_u = model.alpha_v = float_parameter(parameters, "roughness", 0.1f);
    model.remap_roughness = parameters.boolean("remaproughness", true);
    parameters.ignore({"Ks", "Kr", "Kt", "opacity", "index", "eta", "uroughness", "vroughness"});
    return model;
  }
  if (type == "metal") {
    take_as("conductor");
    ConductorMaterial model = conductor(parameters, "", space, place);
    metal_roughness(model);
    return model;
  }
  if (type == "mirror") {
    take_as("conductor of that reflectance");
    const Color r = glm::clamp(surface_color(parameters, "Kr", Color(0.9f), space), Color(0), Color(0.9999f));
    ConductorMaterial model;
    model.eta = 1.f;
    model.k = 2.f * glm::sqrt(r / (Color(1) - r));
    return model;
  }
  if (type == "glass") {
    take_as("dielectric");
    DielectricMaterial model;
    model.eta = parameters.has("index") ? dielectric_index(parameters, place, space, "index") : dielectric_index(parameters, place, space);
    roughness(parameters, "", model.alpha_u, model.alpha_v);
    model.remap_roughness = parameters.boolean("remaproughness", true);
    parameters.ignore({"Kr", "Kt"});
    return model;
  }
  return std::nullopt;
}

}  // namespace sightline::pbrt
