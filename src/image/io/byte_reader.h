// A cursor over the bytes of a file that never leaves them.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "base/core/error.h"

namespace sightline {

/// Error{input} at a byte offset.
inline Error input_error_at(std::size_t offset, std::string message) {
  return input_error(std::move(message)).at("byte " + std::to_string(offset));
}

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::size_t position() const { return position_; }
  std::size_t remaining() const { return bytes_.size() - position_; }

  /// The next `count` bytes; throws Error{input} if the file ends before.
  std::span<const std::byte> take(std::size_t count) {
    if (count > remaining())
      throw input_error_at(position_, "the file ends too early: " + std::to_string(count) + " bytes are needed, " +
                                          std::to_string(remaining()) + " are left");
    const auto result = bytes_.subspan(position_, count);
    position_ += count;
    return result;
  }
  std::uint8_t u8() { return static_cast<std::uint8_t>(take(1)[0]); }
  std::int32_t i32_little() {
    const auto b = take(4);
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(b[i]) << (8 * i);
    return std::bit_cast<std::int32_t>(value);
  }
  /// Text up to `end`, which is consumed and not returned; throws if `end` does not come within `limit` characters.
  std::string_view text_until(char end, std::size_t limit) {
    const auto rest = bytes_.subspan(position_, std::min(remaining(), limit + 1));
    const void* found = rest.empty() ? nullptr : std::memchr(rest.data(), end, rest.size());
    if (!found) throw input_error_at(position_, rest.size() <= limit ? "the file ends inside a text" : "a text is too long");
    const auto length = static_cast<std::size_t>(static_cast<const std::byte*>(found) - rest.data());
    position_ += length + 1;
    return {reinterpret_cast<const char*>(rest.data()), length};
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

}  // namespace sightline
