// A whole file, mapped to be read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace sightline {

class MappedFile {
 public:
  /// Throws Error{input}, without a place, for what is no regular file or cannot be read.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace sightline
