// Where in a scene file something was said.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <string>

#include "base/core/error.h"

namespace sightline::pbrt {

struct Place {
  std::shared_ptr<const std::string> file;  ///< as it is named in messages
  std::uint32_t line = 1, column = 1;

  std::string text() const { return fmt::format("{}:{}:{}", file ? *file : std::string("pbrt"), line, column); }
};

/// The error of a malformed file, to be thrown.
inline Error error_at(const Place& place, std::string message) { return input_error(std::move(message)).at(place.text()); }

/// A name for a message: cut if a damaged file made it very long.
inline std::string shown(std::string_view name) {
  constexpr std::size_t kLongest = 60;
  return name.size() <= kLongest ? std::string(name) : std::string(name.substr(0, kLongest)) + "...";
}

}  // namespace sightline::pbrt
