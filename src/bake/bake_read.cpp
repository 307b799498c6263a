// Bakes in from files, through a memory map, and bakes that live in memory alone.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "bake/bake_format.h"
#include "bake/mapped_file.h"
#include "base/core/aligned.h"
#include "base/core/error.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;

/// A header and the bytes that it describes.
class View : public BakeView {
 public:
  const BakeId& id() const override { return header_.id; }
  std::vector<std::string> section_names() const override {
    std::vector<std::string> names;
    names.reserve(header_.sections.size());
    for (const auto& section : header_.sections) names.push_back(section.name);
    return names;
  }
  std::span<const std::byte> section(std::string_view name) const override {
    for (const auto& section : header_.sections) {
      if (section.name == name) return bake_format::content_of(bytes_, section);
    }
    return {};
  }
  std::uint64_t bytes() const override { return bytes_.size(); }

 protected:
  bake_format::Header header_;
  std::span<const std::byte> bytes_;
};

class FileView final : public View {
 public:
  explicit FileView(const fs::path& path) : file_(path) {
    bytes_ = file_.bytes();
    header_ = bake_format::decode_header(bytes_);
    for (const auto& section : header_.sections) {
      if (!bake_format::is_intact(bytes_, section)) throw input_error(bake_format::damage_of(section));
    }
  }

 private:
  MappedFile file_;
};

class MemoryView final : public View {
 public:
  MemoryView(const BakeId& id, std::span<const BakeSection> sections) {
    const std::vector<std::byte> header = bake_format::encode_header(id, sections);
    std::uint64_t total = header.size();
    for (const BakeSection& section : sections) {
      total += section.bytes.size();
      total += bake_format::padding_after(total);
    }
    memory_.resize(static_cast<std::size_t>(total));
    std::memcpy(memory_.data(), header.data(), header.size());
    bytes_ = memory_;
    header_ = bake_format::decode_header(bytes_);
    for (std::size_t i = 0; i < sections.size(); ++i) {
      if (!sections[i].bytes.empty())
        std::memcpy(memory_.data() + header_.sections[i].offset, sections[i].bytes.data(), sections[i].bytes.size());
    }
  }

 private:
  AlignedVector<std::byte> memory_;
};

void check_expected(const BakeId& found, const BakeId& expected) {
  if (found.kind != expected.kind) throw input_error(fmt::format("a bake of '{}', not of '{}'", found.kind, expected.kind));
  if (found.version != expected.version)
    throw input_error(fmt::format("stale: version {} of '{}'; version {} is needed", found.version, found.kind, expected.version));
  if (found.key != expected.key)
    throw input_error(fmt::format("stale: made from other data (key {}; needed {})", found.key_text(), expected.key_text()));
}

}  // namespace

const void* BakeView::checked(std::string_view name, std::size_t element) const {
  const std::vector<std::string> names = section_names();
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw input_error(fmt::format("the bake of '{}' has no section '{}'", id().kind, name));
  const std::span<const std::byte> bytes = section(name);
  if (bytes.size() % element != 0)
    throw input_error(
        fmt::format("section '{}' of the bake of '{}' has {} bytes, no multiple of {}", name, id().kind, bytes.size(), element));
  return bytes.data();
}

std::shared_ptr<const BakeView> open_bake(const fs::path& path, const std::optional<BakeId>& expected) {
  try {
    auto view = std::make_shared<const FileView>(path);
    if (expected) check_expected(view->id(), *expected);
    return view;
  } catch (Error& error) {
    error.at(path.string());
    throw;
  }
}

std::shared_ptr<const BakeView> bake_in_memory(const BakeId& id, std::span<const BakeSection> sections) {
  return std::make_shared<const MemoryView>(id, sections);
}

}  // namespace sightline
