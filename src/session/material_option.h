// --material: reflectance models as users write them, and where they go in a scene.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/settings/settings.h"
#include "scene/scene.h"

namespace sightline {

/// One reflectance model that can be asked for by name: its parameters are declared once by a settings struct.
struct MaterialChoice {
  std::string name, help;
  SettingsValue parameters;
  /// `data_directory` is where files that are not found as given are looked up.
  SurfaceModel (*build)(const SettingsValue& parameters, const std::filesystem::path& data_directory);
};

/// The explicit table of all of them.
const std::vector<MaterialChoice>& material_choices();

/// "[NAME=]MODEL[,key=value...]".
struct MaterialRequest {
  std::string material;  ///< name or number of the material that is replaced; empty: all
  SurfaceModel model;
};
/// Colours are one number or R:G:B. Unknown models and keys are Errors{usage} with the nearest known one.
MaterialRequest parse_material(std::string_view text, const std::filesystem::path& data_directory);

/// Replaces the reflectance of the material asked for; its emission, maps and media stay. Without a name that of everything but emitters,
/// interfaces and the stage of a built-in scene (ground, room), geometry without a material included. Throws Error{usage} naming the known
/// materials.
void apply_material(Scene& scene, const MaterialRequest& request);

/// Both for several, one after the other: what is wrong with the texts is found before a scene is read. Meshes that then look different
/// turned about the normal get tangents if they have none.
std::vector<MaterialRequest> parse_materials(const std::vector<std::string>& texts, const std::filesystem::path& data_directory);
void apply_materials(Scene& scene, const std::vector<MaterialRequest>& requests);

}  // namespace sightline
