// A glTF file being read: its JSON, its buffers, and what bounds the work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/context.h"
#include "scene/load/gltf/container.h"
#include "scene/load/gltf/json_view.h"
#include "scene/scene.h"

namespace sightline::gltf {

/// A range of a buffer. stride 0: elements are tightly packed.
struct BufferView {
  std::span<const std::byte> bytes;
  std::size_t stride = 0;
  std::string path;
};

/// The file as JSON sections and buffers. Buffers are fetched when first used. Not thread safe.
class Document {
 public:
  /// `file` must outlive the document. `folder`: where external files are looked up; null = external files are refused.
  Document(std::span<const std::byte> file, const std::filesystem::path* folder, const Context& context);
  ~Document();
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  JsonView root() const;
  /// Number of elements of a top-level array ("meshes"); 0 if it is absent.
  std::size_t count(std::string_view section) const;
  JsonView element(std::string_view section, std::size_t index) const;
  /// The element that `reference` (a JSON number) points to; an error at `reference` if there is none.
  std::size_t resolve(std::string_view section, const JsonView& reference) const;

  std::span<const std::byte> buffer(std::size_t index);
  BufferView buffer_view(std::size_t index);

  /// Folder for external files, or null.
  const std::filesystem::path* folder() const { return folder_; }
  const Context& context() const { return context_; }

  /// Takes `bytes` of decoded data from the budget, which is a small multiple of the file: accessors may overlap, so that a short file
  /// could otherwise ask for any amount of memory.
  void charge(std::uint64_t bytes, const std::string& path);

 private:
  struct Json;
  void add_file_bytes(std::uint64_t bytes);

  std::unique_ptr<const Json> json_;
  Container container_;
  const std::filesystem::path* folder_;
  const Context& context_;
  std::map<std::size_t, std::vector<std::byte>> owned_buffers_;
  std::map<std::size_t, std::span<const std::byte>> buffers_;
  std::map<std::string, std::shared_ptr<const std::vector<std::byte>>> external_files_;
  std::uint64_t budget_bytes_ = 0, spent_bytes_ = 0;
};

}  // namespace sightline::gltf
