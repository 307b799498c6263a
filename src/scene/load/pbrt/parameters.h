// The parameters of a directive: "type name" followed by one value or a list.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math/vec.h"
#include "scene/load/pbrt/place.h"
#include "scene/load/pbrt/tokenizer.h"

namespace sightline::pbrt {

struct Parameter {
  std::string type;  ///< as pbrt-v4 names it: "rgb", "float", "point3", ...
  std::string name;
  Place place;
  std::vector<float> numbers;  ///< of every numeric type but integer
  std::vector<std::int32_t> integers;
  std::vector<std::string> strings;  ///< string, texture, and named or filed spectra
  std::vector<bool> booleans;
  mutable bool used = false;
};

/// Typed look-up that remembers what was asked for, so that the rest can be reported.
class ParameterList {
 public:
  /// Reads parameters up to the next directive. `is_old_type` is set if a pbrt-v3 type name was met.
  static ParameterList parse(Tokenizer& tokens, bool* old_type_names);

  /// The parameter of that name and one of these types (space separated); null if absent. Marks it as used.
  const Parameter* find(std::string_view name, std::string_view types) const;
  bool has(std::string_view name) const;

  float number(std::string_view name, float fallback) const;
  int integer(std::string_view name, int fallback) const;
  bool boolean(std::string_view name, bool fallback) const;
  std::string text(std::string_view name, std::string_view fallback) const;
  std::optional<Vec3> point(std::string_view name) const;
  std::span<const float> numbers(std::string_view name, std::string_view types) const;
  std::span<const std::int32_t> integers(std::string_view name) const;

  /// Known, but without an effect here: not to be reported.
  void ignore(std::initializer_list<std::string_view> names) const;
  /// Parameters that nobody asked for.
  std::vector<const Parameter*> unused() const;
  /// Names asked for so far that are not in the list: what a misspelt one may have meant.
  std::vector<std::string> asked() const { return asked_; }

  /// Adds those of `defaults` (the Attribute directive) that are not set here.
  void add_defaults(const std::vector<Parameter>& defaults);
  const std::vector<Parameter>& all() const { return parameters_; }
  bool empty() const { return parameters_.empty(); }

 private:
  std::vector<Parameter> parameters_;
  mutable std::vector<std::string> asked_;
};

/// The number that a word spells; throws Error{input} at its place.
double parse_number(const Tokenizer& tokens, const Token& token);

}  // namespace sightline::pbrt
