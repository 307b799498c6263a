// Statistics as JSON: the same keys for every method (docs/cli.md).
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "session/render.h"

namespace sightline {

nlohmann::ordered_json statistics_json(const RenderResult& result, const World& world, const Context& context);
/// Settings, with numbers and booleans as such.
nlohmann::ordered_json settings_json(const std::vector<std::pair<std::string, std::string>>& settings, const Schema& schema);

}  // namespace sightline
