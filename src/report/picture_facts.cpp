#include "report/picture_facts.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sightline {
namespace {

using Json = nlohmann::json;

// The number at "a.b", or NaN.
double number_at(const Json& json, std::string_view group, std::string_view key) {
  const auto outer = json.find(group);
  if (outer == json.end() || !outer->is_object()) return std::nan("");
  const auto inner = outer->find(key);
  return inner != outer->end() && inner->is_number() ? inner->get<double>() : std::nan("");
}

}  // namespace

std::string short_number(double value) {
  static constexpr std::array<const char*, 5> kUnits{"", " k", " M", " G", " T"};
  std::size_t unit = 0;
  while (std::fabs(value) >= 999.5 && unit + 1 < kUnits.size()) {
    value /= 1000;
    ++unit;
  }
  return fmt::format("{:.3g}{}", value, kUnits[unit]);
}

std::vector<std::pair<std::string, std::string>> picture_facts(std::string_view statistics_json) {
  std::vector<std::pair<std::string, std::string>> facts;
  const Json json = Json::parse(statistics_json, nullptr, false);
  if (!json.is_object()) return facts;
  if (const auto method = json.find("method"); method != json.end() && method->is_string()) facts.emplace_back("method", *method);
  if (const auto size = json.find("size"); size != json.end() && size->is_array() && size->size() == 2)
    facts.emplace_back("size", fmt::format("{} × {}", (*size)[0].dump(), (*size)[1].dump()));
  if (const auto samples = json.find("samples_done"); samples != json.end() && samples->is_number())
    facts.emplace_back("samples a pixel", samples->dump());
  if (const double triangles = number_at(json, "scene", "triangles"); std::isfinite(triangles))
    facts.emplace_back("triangles", short_number(triangles));
  const double seconds = number_at(json, "seconds", "render");
  if (std::isfinite(seconds)) facts.emplace_back("render time", fmt::format("{:.3g} s", seconds));
  const double rays = number_at(json, "rays", "closest") + number_at(json, "rays", "occlusion");
  if (std::isfinite(rays)) {
    const std::string speed = seconds > 0 ? fmt::format(" ({}/s)", short_number(rays / seconds)) : "";
    facts.emplace_back("rays", short_number(rays) + speed);
  }
  if (const double bytes = number_at(json, "memory", "peak_rss_bytes"); bytes > 0)
    facts.emplace_back("peak memory", fmt::format("{:.0f} MiB", bytes / (1 << 20)));
  return facts;
}

}  // namespace sightline
