#include "scene/load/gltf/json_view.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/core/error.h"

namespace sightline::gltf {

void JsonView::fail_type(std::string_view wanted) const {
  throw input_error(fmt::format("{} is expected here, not {}", wanted, value_->type_name())).at(path_.empty() ? "/" : path_);
}

bool JsonView::is_object() const { return value_->is_object(); }

std::optional<JsonView> JsonView::find(std::string_view key) const {
  if (!value_->is_object()) fail_type("an object");
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return JsonView(*found, fmt::format("{}/{}", path_, key));
}

JsonView JsonView::require(std::string_view key) const {
  if (std::optional<JsonView> member = find(key)) return *member;
  throw input_error(fmt::format("'{}' is missing", key)).at(path_.empty() ? "/" : path_);
}

std::vector<std::string> JsonView::keys() const {
  if (!value_->is_object()) fail_type("an object");
  std::vector<std::string> keys;
  for (const auto& item : value_->items()) keys.push_back(item.key());
  return keys;
}

std::size_t JsonView::size() const {
  if (!value_->is_array()) fail_type("an array");
  return value_->size();
}

JsonView JsonView::at(std::size_t index) const {
  if (index >= size()) throw input_error(fmt::format("index {} is out of range, there are {}", index, size())).at(path_);
  return {(*value_)[index], fmt::format("{}/{}", path_, index)};
}

double JsonView::as_number() const {
  if (!value_->is_number()) fail_type("a number");
  const auto number = value_->get<double>();
  if (!(std::fabs(number) <= static_cast<double>(std::numeric_limits<float>::max()))) {
    throw input_error(fmt::format("{} is too large", number)).at(path_);
  }
  return number;
}

std::uint64_t JsonView::as_unsigned() const {
  constexpr std::uint64_t kLimit = std::uint64_t{1} << 53;
  if (value_->is_number_unsigned()) {
    const auto number = value_->get<std::uint64_t>();
    if (number < kLimit) return number;
    throw input_error(fmt::format("{} is too large", number)).at(path_);
  }
  // JSON knows one kind of number: 3.0 is as good as 3.
  if (value_->is_number()) {
    const auto number = value_->get<double>();
    if (number >= 0 && number < static_cast<double>(kLimit) && number == std::floor(number)) return static_cast<std::uint64_t>(number);
    throw input_error(fmt::format("{} is not a whole number that is 0 or larger", number)).at(path_);
  }
  fail_type("a whole number");
}

bool JsonView::as_bool() const {
  if (!value_->is_boolean()) fail_type("true or false");
  return value_->get<bool>();
}

const std::string& JsonView::as_string() const {
  if (!value_->is_string()) fail_type("a string");
  return value_->get_ref<const std::string&>();
}

void JsonView::read_vector(std::span<float> out) const {
  if (size() != out.size()) throw input_error(fmt::format("{} numbers are expected, not {}", out.size(), size())).at(path_);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<float>(at(i).as_number());
}

float JsonView::number_or(std::string_view key, float fallback) const {
  const std::optional<JsonView> member = find(key);
  return member ? static_cast<float>(member->as_number()) : fallback;
}

std::uint64_t JsonView::unsigned_or(std::string_view key, std::uint64_t fallback) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->as_unsigned() : fallback;
}

bool JsonView::bool_or(std::string_view key, bool fallback) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->as_bool() : fallback;
}

std::string JsonView::string_or(std::string_view key, std::string_view fallback) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->as_string() : std::string(fallback);
}

void JsonView::vector_or(std::string_view key, std::span<float> out) const {
  if (const std::optional<JsonView> member = find(key)) member->read_vector(out);
}

std::string JsonView::name() const {
  constexpr std::size_t kMaxLength = 128;
  std::string text = string_or("name", path_);
  if (text.size() > kMaxLength) {
    // Not within a UTF-8 sequence: its following bytes begin with the bits 10.
    std::size_t length = kMaxLength;
    while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xc0u) == 0x80u) --length;
    text.resize(length);
  }
  return text;
}

std::optional<JsonView> JsonView::extension(std::string_view name) const {
  const std::optional<JsonView> extensions = find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

}  // namespace sightline::gltf
