#include "bake/bake_description.h"

#include <cstring>

#include "bake/bake_format.h"
#include "bake/mapped_file.h"
#include "base/core/error.h"

namespace sightline {

bool is_bake(std::span<const std::byte> first_bytes) {
  return first_bytes.size() >= sizeof bake_format::kMagic &&
         std::memcmp(first_bytes.data(), bake_format::kMagic, sizeof bake_format::kMagic) == 0;
}

BakeDescription describe_bake(const std::filesystem::path& path) try {
  const MappedFile file(path);
  BakeDescription description;
  description.bytes = file.bytes().size();
  bake_format::Header header;
  try {
    header = bake_format::decode_header(file.bytes());
  } catch (const Error& error) {
    description.damage = error.message();
    return description;
  }
  description.id = header.id;
  for (const auto& section : header.sections) {
    const bool damaged = !bake_format::is_intact(file.bytes(), section);
    description.sections.push_back({section.name, section.bytes, damaged});
    if (damaged && description.damage.empty()) description.damage = bake_format::damage_of(section);
  }
  return description;
} catch (Error& error) {
  error.at(path.string());
  throw;
}

}  // namespace sightline
