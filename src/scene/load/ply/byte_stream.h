// A file, or bytes in memory, seen through a moving window of bounded size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>

#include "base/core/error.h"

namespace sightline {

/// Reads forward in blocks, so that the file never lies in memory as a whole. Not a memory map: its pages would count as ours, and a file
/// that another process truncates would end the program with a bus error instead of an Error.
class ByteStream {
 public:
  /// Opens a regular file; throws Error{input} if it cannot be read.
  explicit ByteStream(const std::filesystem::path& path);
  /// The whole of `memory` is the window; `memory` must outlive the stream.
  ByteStream(std::span<const std::byte> memory, std::string name);

  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }
  /// Position of cursor() in the file.
  std::uint64_t offset() const { return window_offset_ + static_cast<std::uint64_t>(cursor_ - begin_); }
  std::uint64_t remaining() const { return size_ - offset(); }

  const char* cursor() const { return cursor_; }
  const char* end() const { return end_; }
  std::size_t available() const { return static_cast<std::size_t>(end_ - cursor_); }
  /// Moves the cursor inside the window.
  void set_cursor(const char* cursor) { cursor_ = cursor; }
  /// Makes the next `count` bytes available; false (and as many as there are) if the file ends before. Invalidates earlier pointers.
  bool ensure(std::size_t count) { return available() >= count || refill(count); }
  /// Moves the cursor anywhere; positions past the end mean the end.
  void seek(std::uint64_t offset);

  /// Line (from 1) of a position, found by reading the file again: only for messages.
  std::uint64_t line_at(std::uint64_t offset);

 private:
  bool refill(std::size_t count);

  std::string name_;
  std::uint64_t size_ = 0, window_offset_ = 0;
  const char *begin_ = nullptr, *cursor_ = nullptr, *end_ = nullptr;
  std::ifstream file_;
  std::unique_ptr<char[]> buffer_;
  std::size_t capacity_ = 0;
};

}  // namespace sightline
