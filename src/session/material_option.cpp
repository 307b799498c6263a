#include "session/material_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <set>

#include "base/core/error.h"
#include "session/material_choices.h"
#include "session/surface_tangents.h"
#include "shade/measured_file.h"

namespace sightline {
namespace material_choice {

Color parse_color(const std::string& key, const std::string& text, float most) {
  const SettingInfo limits{.minimum = 0, .maximum = static_cast<double>(most)};
  const auto colons = std::count(text.begin(), text.end(), ':');
  if (colons != 0 && colons != 2)
    throw usage_error(fmt::format("setting {} = '{}' is not a colour", key, text)).remedy("write R:G:B or one number");
  if (colons == 0) return Color(static_cast<float>(parse_real(key, text, limits)));
  const std::size_t first = text.find(':'), second = text.find(':', first + 1);
  const auto channel = [&](std::size_t begin, std::size_t end) {
    return static_cast<float>(parse_real(key, std::string_view(text).substr(begin, end - begin), limits));
  };
  return {channel(0, first), channel(first + 1, second), channel(second + 1, text.size())};
}

SurfaceModel Measured::model(const std::filesystem::path& data_directory) const {
  if (file.empty()) throw usage_error("measured reflectance needs a file").remedy("write measured,file=PATH");
  const bool elsewhere = !std::filesystem::exists(file) && !data_directory.empty() && std::filesystem::exists(data_directory / file);
  return load_measured_material(elsewhere ? data_directory / file : std::filesystem::path(file));
}

}  // namespace material_choice

namespace {

template <class S>
MaterialChoice declare(std::string name, std::string help) {
  return {std::move(name), std::move(help), SettingsValue::of<S>(),
          [](const SettingsValue& parameters, const std::filesystem::path& data) { return parameters.as<S>().model(data); }};
}

std::vector<MaterialChoice> make_table() {
  using namespace material_choice;
  return {declare<Diffuse>("diffuse", "Lambert"),
          declare<MetallicRoughness>("metallic-roughness", "glTF's paint and metal: GGX over Lambert"),
          declare<Conductor>("conductor", "metal by its index of refraction"),
          declare<Dielectric>("dielectric", "glass"),
          declare<CoatedDiffuse>("coated-diffuse", "Lambert below a clear coat"),
          declare<Phong>("phong", "normalised Phong lobe over Lambert"),
          declare<DiffuseTransmission>("diffuse-transmission", "Lambert on both sides: paper, leaves"),
          declare<Ward>("ward", "Ward's lobe over Lambert, brushed where its slopes differ"),
          declare<CookTorrance>("cook-torrance", "Beckmann's facets over Lambert"),
          declare<Measured>("measured", "as it was measured"),
          declare<Interface>("interface", "no surface, only the border of a medium")};
}

const MaterialChoice* find_choice(std::string_view name) {
  const std::vector<MaterialChoice>& choices = material_choices();
  const auto found = std::find_if(choices.begin(), choices.end(), [name](const MaterialChoice& c) { return c.name == name; });
  return found == choices.end() ? nullptr : &*found;
}

std::string_view first_word(std::string_view text) { return text.substr(0, text.find(',')); }

Error unknown_model(std::string_view text) {
  // What stands behind the last '=' of the first word was probably meant to be the model.
  std::string_view name = first_word(text);
  if (const std::size_t equals = name.rfind('='); equals != std::string_view::npos) name.remove_prefix(equals + 1);
  std::vector<std::string> known;
  for (const MaterialChoice& choice : material_choices()) known.push_back(choice.name);
  const std::string nearest = nearest_name(name, known);
  Error error = usage_error(fmt::format("--material '{}': unknown model '{}'", text, name));
  error.remedy(nearest.empty() ? fmt::format("known: {}", fmt::join(known, ", ")) : fmt::format("did you mean '{}'?", nearest));
  return error;
}

/// Whether a mesh is part of what a built-in scene puts around its content.
bool is_stage(const Scene& scene, const Mesh& mesh) {
  if (scene.name == "ground") return mesh.name == "ground";
  if (scene.name == "room" || scene.name == "open-room") return mesh.name == "room" || mesh.name == "light";
  return false;
}

/// Gives all that is not of the stage the model: materials in place where the stage does not use them too, else copies of them.
class ReplaceAll {
 public:
  ReplaceAll(Scene& scene, const SurfaceModel& model) : scene_(scene), model_(model) {
    for (const Mesh& mesh : scene.meshes) {
      if (is_stage(scene, mesh)) of_stage_.insert(mesh.materials.begin(), mesh.materials.end());
    }
    for (const Instance& instance : scene.instances) {
      if (is_stage(scene, scene.meshes[instance.mesh.index])) of_stage_.insert(instance.material_override);
    }
  }

  void run() {
    for (Mesh& mesh : scene_.meshes) {
      if (is_stage(scene_, mesh)) continue;
      if (mesh.materials.empty()) mesh.materials.push_back({});
      for (MaterialId& id : mesh.materials) id = replaced(id);
    }
    for (Instance& instance : scene_.instances) {
      if (is_stage(scene_, scene_.meshes[instance.mesh.index])) continue;
      if (instance.material_override.valid()) instance.material_override = replaced(instance.material_override);
    }
    for (Sphere& sphere : scene_.spheres) sphere.material = replaced(sphere.material);
  }

 private:
  MaterialId replaced(MaterialId id) {
    const auto [entry, is_new] = replacements_.try_emplace(id, id);
    if (!is_new) return entry->second;
    const bool known = id.index < scene_.materials.size();
    if (known && stays(scene_.materials[id.index])) return id;
    if (!known || of_stage_.contains(id)) {
      Material copy = known ? scene_.materials[id.index] : Material{.name = "--material"};
      entry->second = MaterialId(scene_.materials.size());
      scene_.materials.push_back(std::move(copy));
    }
    scene_.materials[entry->second.index].model = model_;
    return entry->second;
  }
  static bool stays(const Material& material) {
    return !is_black(material.emission.value) || std::holds_alternative<InterfaceMaterial>(material.model);
  }

  Scene& scene_;
  const SurfaceModel& model_;
  std::set<MaterialId> of_stage_;
  std::map<MaterialId, MaterialId> replacements_;
};

std::string display_name(const Scene& scene, std::size_t i) {
  return scene.materials[i].name.empty() ? fmt::format("{}", i) : scene.materials[i].name;
}

void replace_one(Scene& scene, const MaterialRequest& request) {
  bool found = false;
  for (Material& material : scene.materials) {
    if (material.name != request.material) continue;
    material.model = request.model;
    found = true;
  }
  if (found) return;
  const std::string& name = request.material;
  std::size_t index = 0;
  const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), index);
  if (status == std::errc{} && end == name.data() + name.size() && index < scene.materials.size()) {
    scene.materials[index].model = request.model;
    return;
  }
  std::vector<std::string> known;
  known.reserve(scene.materials.size());
  for (std::size_t i = 0; i < scene.materials.size(); ++i) known.push_back(display_name(scene, i));
  Error error = usage_error(fmt::format("no material '{}' in the scene", name));
  const std::string nearest = nearest_name(name, known);
  constexpr std::size_t kShown = 12;
  if (!nearest.empty()) {
    error.remedy(fmt::format("did you mean '{}'?", nearest));
  } else if (known.empty()) {
    error.remedy("it has none; leave out NAME=");
  } else {
    const std::string rest = known.size() > kShown ? fmt::format(", ... ({} in all; sightline info lists them)", known.size()) : "";
    known.resize(std::min(known.size(), kShown));
    error.remedy(fmt::format("known: {}{}", fmt::join(known, ", "), rest));
  }
  throw error;
}

}  // namespace

const std::vector<MaterialChoice>& material_choices() {
  static const std::vector<MaterialChoice> table = make_table();
  return table;
}

MaterialRequest parse_material(std::string_view text, const std::filesystem::path& data_directory) {
  // The model is the first word, or what stands behind the first '=' that a model follows: names may hold '=' and ','.
  const MaterialChoice* choice = find_choice(first_word(text));
  std::string_view name, rest = text;
  for (std::size_t equals = text.find('='); !choice && equals != std::string_view::npos; equals = text.find('=', equals + 1)) {
    name = text.substr(0, equals);
    rest = text.substr(equals + 1);
    choice = find_choice(first_word(rest));
  }
  if (!choice) throw unknown_model(text);
  try {
    SettingsValue parameters = choice->parameters;
    rest.remove_prefix(choice->name.size());
    while (!rest.empty()) {
      rest.remove_prefix(1);
      const std::string_view assignment = first_word(rest);
      if (!assignment.empty()) parameters.apply(assignment);
      rest.remove_prefix(assignment.size());
    }
    return {std::string(name), choice->build(parameters, data_directory)};
  } catch (Error& error) {
    throw error.during(fmt::format("--material {}", choice->name));
  }
}

void apply_material(Scene& scene, const MaterialRequest& request) {
  if (request.material.empty())
    ReplaceAll(scene, request.model).run();
  else
    replace_one(scene, request);
}

std::vector<MaterialRequest> parse_materials(const std::vector<std::string>& texts, const std::filesystem::path& data_directory) {
  std::vector<MaterialRequest> requests;
  requests.reserve(texts.size());
  for (const std::string& text : texts) requests.push_back(parse_material(text, data_directory));
  return requests;
}

void apply_materials(Scene& scene, const std::vector<MaterialRequest>& requests) {
  for (const MaterialRequest& request : requests) apply_material(scene, request);
  if (!requests.empty()) add_missing_tangents(scene);
}

}  // namespace sightline
