// Typed reading of untrusted JSON: every wrong type, missing member or out-of-range number is an error that names its JSON path.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sightline::gltf {

/// A value of a JSON document and the path that leads to it ("/meshes/3/primitives/0"). The document must outlive it.
class JsonView {
 public:
  JsonView(const nlohmann::json& value, std::string path) : value_(&value), path_(std::move(path)) {}

  const std::string& path() const { return path_; }

  bool is_object() const;
  /// The member, or nothing if it is absent; an error where this is no object.
  std::optional<JsonView> find(std::string_view key) const;
  JsonView require(std::string_view key) const;
  /// Member names of an object.
  std::vector<std::string> keys() const;

  /// Elements of an array; an error where this is none.
  std::size_t size() const;
  JsonView at(std::size_t index) const;

  double as_number() const;           ///< finite as a float
  std::uint64_t as_unsigned() const;  ///< a whole number below 2^53
  bool as_bool() const;
  const std::string& as_string() const;
  /// An array of exactly out.size() finite numbers.
  void read_vector(std::span<float> out) const;

  // Optional members with their default.
  float number_or(std::string_view key, float fallback) const;
  std::uint64_t unsigned_or(std::string_view key, std::uint64_t fallback) const;
  bool bool_or(std::string_view key, bool fallback) const;
  std::string string_or(std::string_view key, std::string_view fallback) const;
  /// Leaves `out` alone if the member is absent.
  void vector_or(std::string_view key, std::span<float> out) const;
  /// The member `name`, else the path; cut off where it is so long that copies of it would matter.
  std::string name() const;
  /// The member `extensions`/name, if it is there.
  std::optional<JsonView> extension(std::string_view name) const;

 private:
  [[noreturn]] void fail_type(std::string_view wanted) const;

  const nlohmann::json* value_;
  std::string path_;
};

}  // namespace sightline::gltf
