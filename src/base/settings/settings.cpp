#include "base/settings/settings.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/core/error.h"

namespace sightline {
namespace {

void check_range(std::string_view name, double value, const SettingInfo& info) {
  if (value >= info.minimum && value <= info.maximum) return;
  throw usage_error(fmt::format("setting {} = {} is outside [{}, {}]", name, value, info.minimum, info.maximum));
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string setting_to_text(bool value) { return value ? "true" : "false"; }
std::string setting_to_text(std::int64_t value) { return fmt::format("{}", value); }
std::string setting_to_text(double value) { return fmt::format("{}", value); }
std::string setting_to_text(float value) { return fmt::format("{}", value); }

bool parse_boolean(std::string_view name, std::string_view text) {
  if (text == "true" || text == "on" || text == "yes" || text == "1") return true;
  if (text == "false" || text == "off" || text == "no" || text == "0") return false;
  throw usage_error(fmt::format("setting {} = '{}' is not true or false", name, text));
}

std::int64_t parse_integer(std::string_view name, std::string_view text, const SettingInfo& info) {
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size())
    throw usage_error(fmt::format("setting {} = '{}' is not a whole number", name, text));
  check_range(name, static_cast<double>(value), info);
  return value;
}

double parse_real(std::string_view name, std::string_view text, const SettingInfo& info) {
  double value = 0;
  const auto [end, status] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size() || std::isnan(value))
    throw usage_error(fmt::format("setting {} = '{}' is not a number", name, text));
  check_range(name, value, info);
  return value;
}

std::size_t parse_choice(std::string_view name, std::string_view text, const SettingInfo& info) {
  const auto found = std::find(info.choices.begin(), info.choices.end(), text);
  if (found == info.choices.end())
    throw usage_error(fmt::format("setting {} = '{}' is none of {}", name, text, fmt::join(info.choices, ", ")));
  return static_cast<std::size_t>(found - info.choices.begin());
}

std::string nearest_name(std::string_view name, std::span<const std::string> known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

const Setting& Schema::find(std::string_view name) const {
  for (const Setting& setting : settings_) {
    if (setting.name == name) return setting;
  }
  throw_unknown_setting(name, {this});
}

void throw_unknown_setting(std::string_view name, const std::vector<const Schema*>& schemas) {
  std::vector<std::string> known;
  for (const Schema* schema : schemas) {
    for (const Setting& setting : schema->settings()) known.push_back(setting.name);
  }
  Error error = usage_error(fmt::format("unknown setting '{}'", name));
  if (const std::string nearest = nearest_name(name, known); !nearest.empty())
    error.remedy(fmt::format("did you mean '{}'?", nearest));
  else
    error.remedy(known.empty() ? "there are none here" : fmt::format("known: {}", fmt::join(known, ", ")));
  throw error;
}

void Schema::apply(void* object, std::string_view assignment) const {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos)
    throw usage_error(fmt::format("'{}' is not KEY=VALUE", assignment)).remedy("write for example light_samples=4");
  find(assignment.substr(0, equals)).set(object, assignment.substr(equals + 1));
}

std::vector<std::pair<std::string, std::string>> SettingsValue::to_text() const {
  std::vector<std::pair<std::string, std::string>> result;
  if (!pointer_) return result;
  const void* object = pointer_(const_cast<std::any&>(value_));
  for (const Setting& setting : schema_.settings()) result.emplace_back(setting.name, setting.get(object));
  return result;
}

}  // namespace sightline
