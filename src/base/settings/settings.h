// Settings are declared once: a struct with member defaults, and one `describe` that names each member.
//
//   struct ReferenceSettings {
//     int light_samples = 1;
//     template <class Visitor> static void describe(Visitor&& visit) {
//       visit("light_samples", &ReferenceSettings::light_samples, {.help = "shadow rays a shading point", .minimum = 1});
//     }
//   };
//
// A Schema made from it drives --set, --help, `methods --json`, JSON settings, Python keywords and the reference pages.
#pragma once

#include <algorithm>
#include <any>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace sightline {

/// What is known about one setting besides name, type and default.
struct SettingInfo {
  std::string help{};  ///< one line
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  std::string unit{};                  ///< "px", "rad", "s", ... or empty
  std::string symbol{};                ///< the paper's symbol, or empty
  std::vector<std::string> choices{};  ///< allowed values of a text setting; for an enum the names of its values from 0 on
};

enum class SettingType { boolean, integer, real, text };

/// One setting, type-erased over the struct it belongs to.
struct Setting {
  std::string name;
  SettingType type;
  SettingInfo info;
  std::function<std::string(const void*)> get;       ///< value as text, round-trips through `set`
  std::function<void(void*, std::string_view)> set;  ///< throws Error{usage} on a bad or out-of-range value
};

/// Converters used by Schema; text is what the command line and JSON carry.
std::string setting_to_text(bool value);
std::string setting_to_text(std::int64_t value);
std::string setting_to_text(double value);
std::string setting_to_text(float value);
bool parse_boolean(std::string_view name, std::string_view text);
std::int64_t parse_integer(std::string_view name, std::string_view text, const SettingInfo& info);
double parse_real(std::string_view name, std::string_view text, const SettingInfo& info);
/// Index of `text` in info.choices; throws Error{usage} that lists them.
std::size_t parse_choice(std::string_view name, std::string_view text, const SettingInfo& info);

/// The settings of one struct type. A value; cheap to copy.
class Schema {
 public:
  std::span<const Setting> settings() const { return settings_; }
  /// Setting of that name; throws Error{usage} that names the nearest known key.
  const Setting& find(std::string_view name) const;
  /// Applies "key=value".
  void apply(void* object, std::string_view assignment) const;

  template <class S>
  static Schema of() {
    Schema schema;
    S::describe([&]<class M>(const std::string& name, M S::* member, const SettingInfo& info) { schema.add<S, M>(name, member, info); });
    return schema;
  }

 private:
  template <class S, class M>
  void add(const std::string& name, M S::* member, const SettingInfo& info);

  std::vector<Setting> settings_;
};

/// Throws Error{usage} that names the nearest key of several schemas.
[[noreturn]] void throw_unknown_setting(std::string_view name, const std::vector<const Schema*>& schemas);

/// The known name closest to `name` (edit distance at most a third of its length), or empty.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

/// A settings struct together with its schema, type-erased: what methods and visibilities take, and what the command line fills.
class SettingsValue {
 public:
  SettingsValue() = default;
  template <class S>
  static SettingsValue of(S value = {}) {
    SettingsValue result;
    result.schema_ = Schema::of<S>();
    result.value_ = std::move(value);
    result.pointer_ = [](std::any& any) -> void* { return std::any_cast<S>(&any); };
    return result;
  }
  template <class S>
  const S& as() const {
    return std::any_cast<const S&>(value_);
  }
  const Schema& schema() const { return schema_; }
  void apply(std::string_view assignment) { schema_.apply(pointer_(value_), assignment); }
  /// All settings as name and text, in order of declaration.
  std::vector<std::pair<std::string, std::string>> to_text() const;

 private:
  Schema schema_;
  std::any value_;
  void* (*pointer_)(std::any&) = nullptr;
};

template <class S, class M>
void Schema::add(const std::string& name, M S::* member, const SettingInfo& info) {
  Setting setting{name, SettingType::text, info, {}, {}};
  if constexpr (std::is_same_v<M, bool>) {
    setting.type = SettingType::boolean;
    setting.get = [member](const void* s) { return setting_to_text(static_cast<const S*>(s)->*member); };
    setting.set = [member, name](void* s, std::string_view text) { static_cast<S*>(s)->*member = parse_boolean(name, text); };
  } else if constexpr (std::is_enum_v<M>) {
    setting.get = [member, info](const void* s) { return info.choices.at(static_cast<std::size_t>(static_cast<const S*>(s)->*member)); };
    setting.set = [member, name, info](void* s, std::string_view text) {
      static_cast<S*>(s)->*member = static_cast<M>(parse_choice(name, text, info));
    };
  } else if constexpr (std::is_integral_v<M>) {
    setting.type = SettingType::integer;
    if (std::is_unsigned_v<M> && setting.info.minimum < 0) setting.info.minimum = 0;
    setting.get = [member](const void* s) { return setting_to_text(static_cast<std::int64_t>(static_cast<const S*>(s)->*member)); };
    // What the type cannot hold is out of range as well, though help need not say so.
    SettingInfo limits = setting.info;
    limits.minimum = std::max(limits.minimum, static_cast<double>(std::numeric_limits<M>::min()));
    limits.maximum = std::min(limits.maximum, static_cast<double>(std::numeric_limits<M>::max()));
    setting.set = [member, name, limits](void* s, std::string_view text) {
      static_cast<S*>(s)->*member = static_cast<M>(parse_integer(name, text, limits));
    };
  } else if constexpr (std::is_floating_point_v<M>) {
    setting.type = SettingType::real;
    setting.get = [member](const void* s) { return setting_to_text(static_cast<const S*>(s)->*member); };
    setting.set = [member, name, info](void* s, std::string_view text) {
      static_cast<S*>(s)->*member = static_cast<M>(parse_real(name, text, info));
    };
  } else {
    static_assert(std::is_same_v<M, std::string>, "a setting is a bool, integer, floating-point number, enum or string");
    setting.get = [member](const void* s) { return static_cast<const S*>(s)->*member; };
    setting.set = [member, name, info](void* s, std::string_view text) {
      if (!info.choices.empty()) parse_choice(name, text, info);
      static_cast<S*>(s)->*member = std::string(text);
    };
  }
  settings_.push_back(std::move(setting));
}

}  // namespace sightline
