#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/core/error.h"
#include "methods/bidirectional/method.h"
#include "methods/fragments/method.h"
#include "methods/method.h"
#include "methods/reference/method.h"
#include "methods/square_lights/method.h"
#include "methods/visibility_cache/method.h"

namespace sightline {

std::span<const Method* const> methods() {
  static const ReferenceMethod reference;
  static const BidirectionalMethod bidirectional;
  static const VisibilityCacheMethod visibility_cache;
  static const FragmentsMethod fragments;
  static const SquareLightsMethod square_lights;
  static const std::array<const Method*, 5> table = {&reference, &bidirectional, &visibility_cache, &fragments, &square_lights};
  return table;
}

std::vector<LightKind> all_light_kinds() {
  std::vector<LightKind> kinds;
  for (int k = 0; k <= static_cast<int>(LightKind::environment); ++k) kinds.push_back(static_cast<LightKind>(k));
  return kinds;
}

std::vector<MaterialKind> all_material_kinds() {
  std::vector<MaterialKind> kinds;
  for (int k = 0; k <= static_cast<int>(MaterialKind::measured); ++k) kinds.push_back(static_cast<MaterialKind>(k));
  return kinds;
}

const Method& find_method(std::string_view name) {
  std::vector<std::string> known;
  for (const Method* method : methods()) {
    if (method->info().name == name) return *method;
    known.push_back(method->info().name);
  }
  Error error = usage_error(fmt::format("unknown method '{}'", name));
  const std::string nearest = nearest_name(name, known);
  error.remedy(nearest.empty() ? fmt::format("known: {}", fmt::join(known, ", ")) : fmt::format("did you mean '{}'?", nearest));
  throw error;
}

std::string_view name_of(LightKind kind) {
  constexpr std::array<std::string_view, 8> names = {"point", "spot", "directional", "rectangle", "disk", "sphere", "mesh", "environment"};
  return names[static_cast<std::size_t>(kind)];
}

std::string_view name_of(MaterialKind kind) {
  constexpr std::array<std::string_view, std::variant_size_v<SurfaceModel>> names = {
      "diffuse", "metallic-roughness", "conductor", "dielectric",    "coated-diffuse", "phong", "diffuse-transmission",
      "mix",     "interface",          "ward",      "cook-torrance", "measured"};
  return names[static_cast<std::size_t>(kind)];
}

PassStatistics& PassStatistics::operator+=(const PassStatistics& other) {
  rays += other.rays;
  visibility += other.visibility;
  for (const auto& [name, seconds] : other.stage_seconds) stage_seconds[name] += seconds;
  for (const auto& [name, value] : other.method_statistics) method_statistics[name] += value;
  return *this;
}

namespace {

// The order of the variants is the order of the enums.
template <class Kind>
void check_kind(const Method& method, const std::vector<Kind> MethodInfo::* supported, Kind kind, const std::string& what) {
  const auto handles = [&](const Method& m) {
    const std::vector<Kind>& kinds = m.info().*supported;
    return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
  };
  if (handles(method)) return;
  std::vector<std::string> others;
  for (const Method* other : methods()) {
    if (handles(*other)) others.push_back(other->info().name);
  }
  throw usage_error(fmt::format("method {} cannot handle {} ({})", method.info().name, what, name_of(kind)))
      .remedy(others.empty() ? "no method can yet" : fmt::format("use --method {}", fmt::join(others, " or ")));
}

}  // namespace

void check_supported(const Method& method, const Scene& scene) {
  for (const Light& light : scene.lights)
    check_kind(method, &MethodInfo::lights, static_cast<LightKind>(light.shape.index()), fmt::format("light '{}'", light.name));
  if (scene.environment) check_kind(method, &MethodInfo::lights, LightKind::environment, "the environment");
  for (const Material& material : scene.materials) {
    check_kind(method, &MethodInfo::materials, static_cast<MaterialKind>(material.model.index()),
               fmt::format("material '{}'", material.name));
    if (!is_black(material.emission.value))
      check_kind(method, &MethodInfo::lights, LightKind::mesh, fmt::format("emissive material '{}'", material.name));
  }
}

}  // namespace sightline
