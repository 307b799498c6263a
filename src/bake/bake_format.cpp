#include "bake/bake_format.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/core/error.h"

namespace sightline::bake_format {
namespace {

static_assert(std::endian::native == std::endian::little, "bake files are little-endian");

bool is_word_of(std::string_view text, std::string_view others, std::size_t longest) {
  return !text.empty() && text.size() <= longest && std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || others.find(c) != std::string_view::npos;
  });
}
bool is_kind(std::string_view text) { return is_word_of(text, ".-", kKindBytes - 1); }
bool is_section_name(std::string_view text) { return is_word_of(text, ".-_", kNameBytes - 1); }

/// The text of a field that is filled with zeros; nothing if it has no end or goes on after it.
template <std::size_t N>
std::optional<std::string_view> text_of(const char (&field)[N]) {
  const char* const end = std::find(field, field + N, '\0');
  if (end == field + N || std::any_of(end, field + N, [](char c) { return c != '\0'; })) return std::nullopt;
  return std::string_view(field, static_cast<std::size_t>(end - field));
}

}  // namespace

std::uint64_t checksum_of(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

std::vector<std::byte> encode_header(const BakeId& id, std::span<const BakeSection> sections) {
  const auto bug = [&](const std::string& why) { return Error(ErrorCode::bug, why).during("storing a bake of '" + id.kind + "'"); };
  if (!is_kind(id.kind)) throw bug("the kind of a bake is at most 63 characters of [a-z0-9.-]");
  if (sections.size() > kMostSections) throw bug("too many sections");
  std::vector<BakeEntry> table(sections.size());
  std::uint64_t at = sizeof(BakePrefix) + table.size() * sizeof(BakeEntry);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const BakeSection& section = sections[i];
    if (!is_section_name(section.name)) throw bug(fmt::format("'{}' is no name of a section", section.name));
    const auto same = [&](const BakeSection& other) { return other.name == section.name; };
    if (std::any_of(sections.begin(), sections.begin() + static_cast<std::ptrdiff_t>(i), same))
      throw bug(fmt::format("there are two sections '{}'", section.name));
    BakeEntry& entry = table[i];
    std::memset(&entry, 0, sizeof entry);
    std::memcpy(entry.name, section.name.data(), section.name.size());
    entry.offset = at, entry.bytes = section.bytes.size(), entry.checksum = checksum_of(section.bytes);
    at += entry.bytes + padding_after(at + entry.bytes);
  }

  BakePrefix prefix;
  std::memset(&prefix, 0, sizeof prefix);
  std::memcpy(prefix.magic, kMagic, sizeof kMagic);
  prefix.format_version = kFormatVersion;
  prefix.section_count = static_cast<std::uint32_t>(table.size());
  prefix.file_bytes = at;
  prefix.key[0] = id.key[0], prefix.key[1] = id.key[1];
  prefix.kind_version = id.version;
  std::memcpy(prefix.kind, id.kind.data(), id.kind.size());

  std::vector<std::byte> header(sizeof prefix + table.size() * sizeof(BakeEntry));
  std::memcpy(header.data(), &prefix, sizeof prefix);
  if (!table.empty()) std::memcpy(header.data() + sizeof prefix, table.data(), table.size() * sizeof(BakeEntry));
  const std::uint64_t checksum = checksum_of(std::span(header).subspan(kChecksummedFrom));
  std::memcpy(header.data() + offsetof(BakePrefix, checksum), &checksum, sizeof checksum);
  return header;
}

Header decode_header(std::span<const std::byte> bytes) {
  // What is not a bake at all is told apart from bakes that were cut short or changed.
  BakePrefix prefix;
  const std::size_t magic_bytes = std::min(bytes.size(), sizeof kMagic);
  if (magic_bytes == 0 || std::memcmp(bytes.data(), kMagic, magic_bytes) != 0) throw input_error("not a bake");
  if (bytes.size() < sizeof prefix) throw input_error("cut short: the header of a bake is longer than the file");
  std::memcpy(&prefix, bytes.data(), sizeof prefix);
  if (prefix.format_version != kFormatVersion)
    throw input_error(
        fmt::format("a bake in version {} of the file format; this program reads version {}", prefix.format_version, kFormatVersion));
  if (prefix.section_count > kMostSections) throw input_error("damaged: the header names too many sections");
  const std::size_t header_bytes = sizeof prefix + prefix.section_count * sizeof(BakeEntry);
  if (bytes.size() < header_bytes) throw input_error("cut short: the header of the bake is longer than the file");
  if (checksum_of(bytes.subspan(kChecksummedFrom, header_bytes - kChecksummedFrom)) != prefix.checksum)
    throw input_error("damaged: the checksum of the header differs");
  if (prefix.file_bytes != bytes.size())
    throw input_error(fmt::format("{}: {} bytes of {}",
                                  prefix.file_bytes > bytes.size() ? "cut short" : "damaged: longer than it was written", bytes.size(),
                                  prefix.file_bytes));

  Header header;
  const auto kind = text_of(prefix.kind);
  if (!kind || !is_kind(*kind)) throw input_error("damaged: the header names no kind");
  header.id = {std::string(*kind), prefix.kind_version, {prefix.key[0], prefix.key[1]}};

  // Sections must follow each other as the writer lays them out, which also bounds them.
  std::uint64_t at = header_bytes;
  header.sections.reserve(prefix.section_count);
  for (std::size_t i = 0; i < prefix.section_count; ++i) {
    BakeEntry entry;
    std::memcpy(&entry, bytes.data() + sizeof prefix + i * sizeof entry, sizeof entry);
    const auto name = text_of(entry.name);
    if (!name || !is_section_name(*name)) throw input_error("damaged: a section has no name");
    if (entry.offset != at || entry.bytes > bytes.size() - at)
      throw input_error(fmt::format("damaged: section '{}' lies elsewhere", *name));
    at += entry.bytes;
    const std::uint64_t padding = padding_after(at);
    if (padding > bytes.size() - at) throw input_error(fmt::format("damaged: section '{}' reaches the end of the file", *name));
    at += padding;
    for (const Header::Section& other : header.sections) {
      if (other.name == *name) throw input_error(fmt::format("damaged: there are two sections '{}'", *name));
    }
    header.sections.push_back({std::string(*name), entry.offset, entry.bytes, entry.checksum});
  }
  if (at != bytes.size()) throw input_error("damaged: the sections do not fill the file");
  return header;
}

}  // namespace sightline::bake_format
