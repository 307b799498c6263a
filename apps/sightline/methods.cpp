// sightline methods
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "base/core/error.h"
#include "commands.h"
#include "methods/method.h"
#include "visibility/visibility.h"

namespace sightline::app {
namespace {

using Json = nlohmann::ordered_json;

std::string_view type_name(SettingType type) {
  switch (type) {
    case SettingType::boolean:
      return "boolean";
    case SettingType::integer:
      return "integer";
    case SettingType::real:
      return "real";
    case SettingType::text:
      return "text";
  }
  return "";
}

Json value_json(const std::string& text) {
  const Json parsed = Json::parse(text, nullptr, false);
  return parsed.is_number() || parsed.is_boolean() ? parsed : Json(text);
}

Json settings_to_json(const SettingsValue& value) {
  Json list = Json::array();
  const auto defaults = value.to_text();
  for (std::size_t i = 0; i < defaults.size(); ++i) {
    const Setting& setting = value.schema().settings()[i];
    Json entry = {{"name", setting.name},
                  {"type", type_name(setting.type)},
                  {"default", value_json(defaults[i].second)},
                  {"help", setting.info.help}};
    if (std::isfinite(setting.info.minimum)) entry["minimum"] = setting.info.minimum;
    if (std::isfinite(setting.info.maximum)) entry["maximum"] = setting.info.maximum;
    if (!setting.info.unit.empty()) entry["unit"] = setting.info.unit;
    if (!setting.info.symbol.empty()) entry["symbol"] = setting.info.symbol;
    if (!setting.info.choices.empty()) entry["choices"] = setting.info.choices;
    list.push_back(entry);
  }
  return list;
}

void print_settings(const SettingsValue& value) {
  const auto defaults = value.to_text();
  if (defaults.empty()) fmt::print("  no settings\n");
  for (std::size_t i = 0; i < defaults.size(); ++i) {
    const Setting& setting = value.schema().settings()[i];
    fmt::print("  {:<18} {}", setting.name + "=" + defaults[i].second, setting.info.help);
    if (!setting.info.choices.empty()) fmt::print(" [{}]", fmt::join(setting.info.choices, "|"));
    if (std::isfinite(setting.info.minimum) && std::isfinite(setting.info.maximum))
      fmt::print(" [{} .. {}]", setting.info.minimum, setting.info.maximum);
    if (!setting.info.unit.empty()) fmt::print(" ({})", setting.info.unit);
    if (!setting.info.symbol.empty()) fmt::print(" (paper: {})", setting.info.symbol);
    fmt::print("\n");
  }
}

template <class Kind>
Json names(const std::vector<Kind>& kinds) {
  Json list = Json::array();
  for (const Kind kind : kinds) list.push_back(name_of(kind));
  return list;
}

Json method_json(const Method& method) {
  const MethodInfo& info = method.info();
  return {{"name", info.name},
          {"help", info.help},
          {"citation", info.citation},
          {"unbiased", info.unbiased},
          {"consistent", info.consistent},
          {"progressive", info.progressive},
          {"needs_bake", info.needs_bake},
          {"deterministic", info.deterministic},
          {"default_visibility", method.default_visibility()},
          {"default_spp", method.default_spp()},
          {"lights", names(info.lights)},
          {"materials", names(info.materials)},
          {"settings", settings_to_json(method.default_settings())}};
}

Json visibility_json(const VisibilityInfo& info) {
  return {{"name", info.name},
          {"help", info.help},
          {"citation", info.citation},
          {"binary", info.binary},
          {"unbiased", info.unbiased},
          {"deterministic", info.deterministic},
          {"settings", settings_to_json(info.settings)}};
}

// "unbiased" or "not unbiased".
std::string fact(std::string_view name, bool value) { return fmt::format("{}{}", value ? "" : "not ", name); }

std::string heading(const std::string& name, const std::string& help, const std::string& citation) {
  return citation.empty() ? fmt::format("{}: {}\n", name, help) : fmt::format("{}: {} [{}]\n", name, help, citation);
}

void print_visibility(const VisibilityInfo& info) {
  fmt::print("{}", heading(info.name, info.help, info.citation));
  fmt::print("  {}, {}, {}\n", fact("binary", info.binary), fact("unbiased", info.unbiased), fact("deterministic", info.deterministic));
  print_settings(info.settings);
}

void print_method(const Method& method) {
  const MethodInfo& info = method.info();
  fmt::print("{}", heading(info.name, info.help, info.citation));
  fmt::print("  {}, {}, {}, {}{}\n", fact("unbiased", info.unbiased), fact("consistent", info.consistent),
             fact("progressive", info.progressive), fact("deterministic", info.deterministic), info.needs_bake ? ", needs a bake" : "");
  print_settings(method.default_settings());
}

// Methods and visibilities have one list of names here.
Error unknown_name(const std::string& name) {
  std::vector<std::string> known;
  for (const Method* method : methods()) known.push_back(method->info().name);
  for (const VisibilityInfo& info : visibilities()) known.push_back(info.name);
  const std::string nearest = nearest_name(name, known);
  return usage_error(fmt::format("unknown method or visibility '{}'", name))
      .remedy(nearest.empty() ? fmt::format("known: {}", fmt::join(known, ", ")) : fmt::format("did you mean '{}'?", nearest));
}

}  // namespace

int run_methods(const CommandLine& line) {
  const std::string& name = line.methods.name;
  const VisibilityInfo* visibility = nullptr;
  for (const VisibilityInfo& info : visibilities()) {
    if (info.name == name) visibility = &info;
  }
  const Method* method = nullptr;
  for (const Method* known : methods()) {
    if (known->info().name == name) method = known;
  }
  if (!name.empty() && !visibility && !method) throw unknown_name(name);
  if (line.methods.json) {
    Json json;
    if (visibility) {
      json = visibility_json(*visibility);
    } else if (method) {
      json = method_json(*method);
    } else {
      json = {{"methods", Json::array()}, {"visibilities", Json::array()}};
      for (const Method* known : methods()) json["methods"].push_back(method_json(*known));
      for (const VisibilityInfo& info : visibilities()) json["visibilities"].push_back(visibility_json(info));
    }
    fmt::print("{}\n", json.dump(2));
    return kDone;
  }
  if (visibility) {
    print_visibility(*visibility);
  } else if (method) {
    print_method(*method);
  } else {
    fmt::print("Methods (--method):\n");
    for (const Method* known : methods()) fmt::print("  {:<18} {}\n", known->info().name, known->info().help);
    fmt::print("\nVisibilities (--visibility):\n");
    for (const VisibilityInfo& info : visibilities()) fmt::print("  {:<18} {}\n", info.name, info.help);
    fmt::print("\n'sightline methods NAME' lists the settings of one.\n");
  }
  return kDone;
}

}  // namespace sightline::app
