// Material libraries of OBJ files.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "base/core/context.h"
#include "scene/scene.h"

namespace sightline::obj {

using MaterialNames = std::map<std::string, MaterialId, std::less<>>;

/// Adds the materials of an MTL text to the scene and their ids to `names` (the first of a name wins). Textures are read from `directory`.
void parse_mtl(std::string_view text, const std::string& name, const std::filesystem::path& directory, Scene& scene, MaterialNames& names,
               const Context& context);

}  // namespace sightline::obj
