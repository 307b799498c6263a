#include "scene/load/pbrt/parameters.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace sightline::pbrt {
namespace {

enum class ValueKind { number, integer, boolean, string, spectrum };

struct TypeName {
  std::string_view name, v4_name;
  ValueKind kind;
  int multiple;  ///< the number of values is a multiple of it
};

constexpr std::array kTypes = {
    TypeName{"float", "float", ValueKind::number, 1},
    TypeName{"integer", "integer", ValueKind::integer, 1},
    TypeName{"bool", "bool", ValueKind::boolean, 1},
    TypeName{"string", "string", ValueKind::string, 1},
    TypeName{"texture", "texture", ValueKind::string, 1},
    TypeName{"rgb", "rgb", ValueKind::number, 3},
    TypeName{"spectrum", "spectrum", ValueKind::spectrum, 1},
    TypeName{"blackbody", "blackbody", ValueKind::number, 1},
    TypeName{"point2", "point2", ValueKind::number, 2},
    TypeName{"vector2", "vector2", ValueKind::number, 2},
    TypeName{"point3", "point3", ValueKind::number, 3},
    TypeName{"vector3", "vector3", ValueKind::number, 3},
    TypeName{"normal", "normal", ValueKind::number, 3},
    TypeName{"normal3", "normal", ValueKind::number, 3},
    // pbrt-v3 names
    TypeName{"color", "rgb", ValueKind::number, 3},
    TypeName{"point", "point3", ValueKind::number, 3},
    TypeName{"vector", "vector3", ValueKind::number, 3},
    TypeName{"xyz", "xyz", ValueKind::number, 3},
};

bool is_old(const TypeName& type) { return type.name != type.v4_name && type.name != "normal3"; }

/// Splits "type name"; throws if it is not two words.
std::pair<std::string_view, std::string_view> split_declaration(const Tokenizer& tokens, const Token& token) {
  const std::string_view text = token.text;
  constexpr std::string_view kBlanks = " \t";
  const std::size_t type_start = text.find_first_not_of(kBlanks);
  const std::size_t type_end = text.find_first_of(kBlanks, std::min(type_start, text.size()));
  const std::size_t name_start = text.find_first_not_of(kBlanks, std::min(type_end, text.size()));
  const std::size_t name_end = text.find_first_of(kBlanks, std::min(name_start, text.size()));
  const std::size_t rest = text.find_first_not_of(kBlanks, std::min(name_end, text.size()));
  if (name_start == std::string_view::npos || rest != std::string_view::npos) {
    throw error_at(tokens.place(token), fmt::format("\"{}\" is not a parameter of the form \"type name\"", shown(text)));
  }
  return {text.substr(type_start, type_end - type_start), text.substr(name_start, std::min(name_end, text.size()) - name_start)};
}

std::int32_t parse_integer(const Tokenizer& tokens, const Token& token) {
  std::int32_t value = 0;
  const char* const end = token.text.data() + token.text.size();
  const char* const start = token.text.data() + (token.text.starts_with('+') ? 1 : 0);
  const auto [stop, status] = std::from_chars(start, end, value);
  if (status == std::errc{} && stop == end) return value;
  // Some exporters write whole numbers as 3.0.
  const double number = parse_number(tokens, token);
  if (number != std::floor(number) || std::fabs(number) > std::numeric_limits<std::int32_t>::max()) {
    throw error_at(tokens.place(token), fmt::format("'{}' is not a whole number", shown(token.text)));
  }
  return static_cast<std::int32_t>(number);
}

void add_value(Parameter& parameter, ValueKind kind, const Tokenizer& tokens, const Token& token) {
  const bool is_string = token.kind == Token::Kind::string;
  const auto wrong = [&] {
    return error_at(tokens.place(token), fmt::format("'{}' is no value for \"{} {}\"", shown(token.text), parameter.type, parameter.name));
  };
  switch (kind) {
    case ValueKind::number:
      if (is_string) throw wrong();
      parameter.numbers.push_back(static_cast<float>(parse_number(tokens, token)));
      return;
    case ValueKind::integer:
      if (is_string) throw wrong();
      parameter.integers.push_back(parse_integer(tokens, token));
      return;
    case ValueKind::boolean:
      if (token.text != "true" && token.text != "false") throw wrong();
      parameter.booleans.push_back(token.text == "true");
      return;
    case ValueKind::string:
      if (!is_string) throw wrong();
      parameter.strings.emplace_back(token.text);
      return;
    case ValueKind::spectrum:  // a name or file, or wavelength-value pairs
      if (is_string)
        parameter.strings.emplace_back(token.text);
      else
        parameter.numbers.push_back(static_cast<float>(parse_number(tokens, token)));
      return;
  }
}

}  // namespace

double parse_number(const Tokenizer& tokens, const Token& token) {
  double value = 0;
  const char* const end = token.text.data() + token.text.size();
  const char* const start = token.text.data() + (token.text.starts_with('+') ? 1 : 0);
  const auto [stop, status] = fast_float::from_chars(start, end, value);
  if (token.kind != Token::Kind::word || status != std::errc{} || stop != end) {
    const std::string what = token.kind == Token::Kind::end ? "the file ends where a number is expected"
                                                            : fmt::format("'{}' is not a number", shown(token.text));
    throw error_at(tokens.place(token), what);
  }
  return value;
}

ParameterList ParameterList::parse(Tokenizer& tokens, bool* old_type_names) {
  ParameterList list;
  while (tokens.peek().kind == Token::Kind::string) {
    const Token declaration = tokens.next();
    const auto [type_name, name] = split_declaration(tokens, declaration);
    const auto type = std::find_if(kTypes.begin(), kTypes.end(), [t = type_name](const TypeName& known) { return known.name == t; });
    if (type == kTypes.end()) {
      throw error_at(tokens.place(declaration), fmt::format("unknown parameter type '{}'", shown(type_name)));
    }
    if (is_old(*type) && old_type_names != nullptr) *old_type_names = true;
    Parameter parameter;
    parameter.type = type->v4_name;
    parameter.name = name;
    parameter.place = tokens.place(declaration);

    const Token first = tokens.next();
    if (first.kind == Token::Kind::open_bracket) {
      while (true) {
        const Token value = tokens.next();
        if (value.kind == Token::Kind::close_bracket) break;
        if (value.kind != Token::Kind::word && value.kind != Token::Kind::string) {
          throw error_at(tokens.place(value), fmt::format("the list of \"{} {}\" is not closed", parameter.type, shown(name)));
        }
        add_value(parameter, type->kind, tokens, value);
      }
    } else if (first.kind == Token::Kind::word || first.kind == Token::Kind::string) {
      add_value(parameter, type->kind, tokens, first);
    } else {
      throw error_at(tokens.place(first), fmt::format("\"{} {}\" has no value", parameter.type, shown(name)));
    }
    if (type->kind == ValueKind::number && parameter.numbers.size() % static_cast<std::size_t>(type->multiple) != 0) {
      throw error_at(parameter.place, fmt::format("\"{} {}\" has {} numbers, not a multiple of {}", parameter.type, shown(name),
                                                  parameter.numbers.size(), type->multiple));
    }
    list.parameters_.push_back(std::move(parameter));
  }
  return list;
}

const Parameter* ParameterList::find(std::string_view name, std::string_view types) const {
  for (const Parameter& parameter : parameters_) {
    if (parameter.name != name) continue;
    for (std::string_view rest = types; !rest.empty();) {
      const std::string_view type = rest.substr(0, rest.find(' '));
      rest.remove_prefix(std::min(type.size() + 1, rest.size()));
      if (parameter.type != type) continue;
      parameter.used = true;
      return &parameter;
    }
  }
  if (std::find(asked_.begin(), asked_.end(), name) == asked_.end()) asked_.emplace_back(name);
  return nullptr;
}

bool ParameterList::has(std::string_view name) const {
  return std::any_of(parameters_.begin(), parameters_.end(), [&](const Parameter& p) { return p.name == name; });
}

float ParameterList::number(std::string_view name, float fallback) const {
  const Parameter* const found = find(name, "float");
  return found != nullptr && !found->numbers.empty() ? found->numbers.front() : fallback;
}

int ParameterList::integer(std::string_view name, int fallback) const {
  const Parameter* const found = find(name, "integer");
  return found != nullptr && !found->integers.empty() ? found->integers.front() : fallback;
}

bool ParameterList::boolean(std::string_view name, bool fallback) const {
  const Parameter* const found = find(name, "bool");
  return found != nullptr && !found->booleans.empty() ? found->booleans.front() : fallback;
}

std::string ParameterList::text(std::string_view name, std::string_view fallback) const {
  const Parameter* const found = find(name, "string");
  return found != nullptr && !found->strings.empty() ? found->strings.front() : std::string(fallback);
}

std::optional<Vec3> ParameterList::point(std::string_view name) const {
  const std::span<const float> values = numbers(name, "point3 vector3");
  if (values.size() < 3) return std::nullopt;
  return Vec3(values[0], values[1], values[2]);
}

std::span<const float> ParameterList::numbers(std::string_view name, std::string_view types) const {
  const Parameter* const found = find(name, types);
  return found != nullptr ? std::span<const float>(found->numbers) : std::span<const float>();
}

std::span<const std::int32_t> ParameterList::integers(std::string_view name) const {
  const Parameter* const found = find(name, "integer");
  return found != nullptr ? std::span<const std::int32_t>(found->integers) : std::span<const std::int32_t>();
}

void ParameterList::ignore(std::initializer_list<std::string_view> names) const {
  for (const Parameter& parameter : parameters_) {
    if (std::find(names.begin(), names.end(), parameter.name) != names.end()) parameter.used = true;
  }
}

std::vector<const Parameter*> ParameterList::unused() const {
  std::vector<const Parameter*> result;
  for (const Parameter& parameter : parameters_) {
    if (!parameter.used) result.push_back(&parameter);
  }
  return result;
}

void ParameterList::add_defaults(const std::vector<Parameter>& defaults) {
  for (const Parameter& parameter : defaults) {
    if (has(parameter.name)) continue;
    parameters_.push_back(parameter);
    parameters_.back().used = true;  // a default for many directives need not suit each
  }
}

}  // namespace sightline::pbrt
