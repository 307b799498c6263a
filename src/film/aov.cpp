#include "film/aov.h"

#include <fmt/format.h>

#include "base/core/error.h"
#include "base/settings/settings.h"

namespace sightline {

std::span<const AovInfo> aov_table() {
  static const std::vector<AovInfo> table = {
      {Aov::color, "color", "radiance", {"R", "G", "B"}, false},
      {Aov::albedo, "albedo", "albedo of the first surface", {"R", "G", "B"}, true},
      {Aov::normal, "normal", "shading normal of the first surface, world space", {"X", "Y", "Z"}, true},
      {Aov::position, "position", "first hit point, world space", {"X", "Y", "Z"}, false},
      {Aov::depth, "depth", "distance from the camera to the first hit", {"Z"}, false},
      {Aov::surface,
       "surface",
       "share of samples that hit a non-emitting surface (S) or an emitter (E); the rest is background",
       {"S", "E"},
       true},
      {Aov::direct, "direct", "radiance by emission and direct light", {"R", "G", "B"}, true},
      {Aov::indirect, "indirect", "radiance by one or more indirect bounces", {"R", "G", "B"}, true},
      {Aov::variance, "variance", "mean of the squared luminance of samples (V); the error estimate comes from it", {"V"}, false},
      {Aov::alpha, "alpha", "coverage: share of samples that hit a surface, not the background", {"A"}, false},
  };
  return table;
}

const AovInfo& aov_info(Aov aov) { return aov_table()[static_cast<std::size_t>(aov)]; }

std::string channel_name(const AovInfo& info, std::string_view channel) {
  if (info.id == Aov::color || info.id == Aov::alpha) return std::string(channel);
  return fmt::format("{}.{}", info.name, channel);
}

AovSet parse_aovs(std::string_view list) {
  AovSet set;
  std::vector<std::string> known{"all", "samples"};
  for (const AovInfo& info : aov_table()) known.emplace_back(info.name);
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    const std::string_view name = list.substr(0, comma);
    list = comma == std::string_view::npos ? std::string_view{} : list.substr(comma + 1);
    if (name.empty() || name == "samples") continue;
    bool found = name == "all";
    for (const AovInfo& info : aov_table()) {
      if (name == "all" || name == info.name) {
        set.add(info.id);
        found = true;
      }
    }
    if (found) continue;
    Error error = usage_error(fmt::format("unknown layer '{}'", name));
    const std::string nearest = nearest_name(name, known);
    error.remedy(nearest.empty() ? fmt::format("known: {}", fmt::join(known, ", ")) : fmt::format("did you mean '{}'?", nearest));
    throw error;
  }
  return set;
}

}  // namespace sightline
