// How a bake lies in a file.
//
//   prefix         BakePrefix
//   table          one BakeEntry a section
//   sections       each from a multiple of 64 bytes on, with at least 64 zero bytes after it, so that vectors may read past the end
//
// Numbers are little-endian. Checksums are XXH3 (64 bits): one of prefix and table, one of each section.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "bake/bake_file.h"

namespace sightline::bake_format {

inline constexpr char kMagic[8] = {'S', 'L', 'B', 'A', 'K', 'E', '\r', '\n'};
inline constexpr std::uint32_t kFormatVersion = 1;
inline constexpr std::uint64_t kAlignment = 64, kSlack = 64;
inline constexpr std::size_t kMostSections = 4096;
inline constexpr std::size_t kKindBytes = 64, kNameBytes = 32;

struct BakePrefix {
  char magic[8];
  std::uint32_t format_version, section_count;
  std::uint64_t checksum;  ///< of all that follows in the prefix, and the table
  std::uint64_t file_bytes;
  std::uint64_t key[2];
  std::uint32_t kind_version, reserved;
  char kind[kKindBytes];
  char padding[8];
};
static_assert(sizeof(BakePrefix) == 128 && std::is_trivially_copyable_v<BakePrefix>);
inline constexpr std::size_t kChecksummedFrom = 24;

struct BakeEntry {
  char name[kNameBytes];
  std::uint64_t offset, bytes, checksum, reserved;
};
static_assert(sizeof(BakeEntry) == 64 && std::is_trivially_copyable_v<BakeEntry>);

/// Prefix and table of these sections as they begin a file. Throws Error{bug} for kinds and names that no file can hold.
std::vector<std::byte> encode_header(const BakeId& id, std::span<const BakeSection> sections);
/// Zero bytes between the end of a section at `end` and the next one, or the end of the file.
inline std::uint64_t padding_after(std::uint64_t end) { return (end + kSlack + kAlignment - 1) / kAlignment * kAlignment - end; }

std::uint64_t checksum_of(std::span<const std::byte> bytes);

/// What a header says, once it has been found consistent with the size of the file.
struct Header {
  BakeId id;
  struct Section {
    std::string name;
    std::uint64_t offset, bytes, checksum;
  };
  std::vector<Section> sections;
};
/// The part of the file that a section of its header names.
inline std::span<const std::byte> content_of(std::span<const std::byte> file, const Header::Section& section) {
  return file.subspan(static_cast<std::size_t>(section.offset), static_cast<std::size_t>(section.bytes));
}
inline bool is_intact(std::span<const std::byte> file, const Header::Section& section) {
  return checksum_of(content_of(file, section)) == section.checksum;
}
inline std::string damage_of(const Header::Section& section) { return "damaged: the checksum of section '" + section.name + "' differs"; }

/// Reads prefix and table from the start of a file of `bytes`. Throws Error{input} without a place.
Header decode_header(std::span<const std::byte> bytes);

}  // namespace sightline::bake_format
