// What is in a bake file, for people.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "bake/bake_file.h"

namespace sightline {

struct BakeDescription {
  BakeId id;
  std::uint64_t bytes = 0;
  struct Section {
    std::string name;
    std::uint64_t bytes = 0;
    bool damaged = false;
  };
  std::vector<Section> sections;
  std::string damage;  ///< what is wrong with it; empty where nothing is. With no kind the header is among it, and nothing else is known
};

/// Whether a file begins as bakes do.
bool is_bake(std::span<const std::byte> first_bytes);
/// Reads and checks the whole file. Damage is described, not thrown; throws Error{input} where the file cannot be read at all.
BakeDescription describe_bake(const std::filesystem::path& path);

}  // namespace sightline
