// Procedural scenes: production code that tests, benchmarks, docs and the command line share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/context.h"
#include "base/settings/settings.h"
#include "scene/load/load.h"
#include "scene/scene.h"

namespace sightline {

/// One builtin scene: its name, one line of help, and its parameters (declared once by a settings struct).
struct BuiltinScene {
  std::string name, help;
  SettingsValue parameters;
  Scene (*build)(const SettingsValue& parameters, const LoadOptions& options, const Context& context);
};

/// The explicit table of all builtin scenes.
const std::vector<BuiltinScene>& builtin_scenes();
/// "NAME?k=v&k=v" or "NAME,k=v,k=v" (without "builtin:"). Unknown names and parameters are Errors{usage} with the nearest known one.
Scene build_builtin(std::string_view spec, const LoadOptions& options, const Context& context);

}  // namespace sightline
