// Reads the values of a PLY body one by one, from text or from bytes of either order.
#pragma once

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "scene/load/ply/byte_stream.h"
#include "scene/load/ply/header.h"

namespace sightline::ply {

/// Text: values separated by white space. Line ends count as such, since files that break a row over lines exist.
class AsciiCursor {
 public:
  explicit AsciiCursor(ByteStream& stream) : stream_(stream) { load(); }

  float real(ScalarType) {
    next_token();
    float value = 0;
    const auto [end, failure] = fast_float::from_chars(p_ + (*p_ == '+'), end_, value);
    if (failure != std::errc{} && failure != std::errc::result_out_of_range) throw not_a_number();
    finish_token(end);
    return value;
  }

  std::int64_t integer(ScalarType type) {
    next_token();
    const char* p = p_;
    const bool negative = *p == '-';
    p += negative || *p == '+';
    // Up to 18 digits cannot overflow.
    const char* const last = p + std::min<std::ptrdiff_t>(end_ - p, 18);
    std::int64_t value = 0;
    const char* const first = p;
    for (; p != last && is_digit(*p); ++p) value = value * 10 + (*p - '0');
    if (p == first || (p != end_ && !is_space(*p))) return integer_written_as_real(type);
    p_ = p;
    return negative ? -value : value;
  }

  void skip(ScalarType, std::uint64_t count = 1) {
    for (std::uint64_t i = 0; i < count; ++i) {
      next_token();
      while (p_ != end_ && !is_space(*p_)) ++p_;
    }
  }

  /// Gives the position back to the stream; to be called before the stream is used again.
  void commit() { stream_.set_cursor(p_); }
  std::string place() {
    commit();
    return fmt::format("{}:{}", stream_.name(), stream_.line_at(stream_.offset()));
  }

 private:
  /// Longest number: more digits than anyone prints a double with.
  static constexpr std::ptrdiff_t kMaxToken = 1024;

  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  static bool is_digit(char c) { return c >= '0' && c <= '9'; }

  void load() {
    p_ = stream_.cursor();
    end_ = stream_.end();
  }
  /// Moves to the next value, with all of its text inside the window.
  void next_token() {
    for (;;) {
      if (end_ - p_ < kMaxToken) {
        commit();
        stream_.ensure(kMaxToken);
        load();
      }
      while (p_ != end_ && is_space(*p_)) ++p_;
      if (end_ - p_ >= kMaxToken || stream_at_end()) break;
    }
    if (p_ == end_) throw input_error("the file ends too early");
  }
  bool stream_at_end() {
    commit();
    return stream_.remaining() == stream_.available();
  }
  void finish_token(const char* end) {
    if (end != end_ && !is_space(*end)) throw not_a_number();
    p_ = end;
  }
  /// Some writers print every list entry as a real number.
  std::int64_t integer_written_as_real(ScalarType) {
    double value = 0;
    const auto [end, failure] = fast_float::from_chars(p_ + (*p_ == '+'), end_, value);
    if (failure != std::errc{} || !(std::fabs(value) < 9e15) || value != std::floor(value)) throw not_a_number();
    finish_token(end);
    return static_cast<std::int64_t>(value);
  }
  Error not_a_number() const {
    const char* end = p_;
    while (end != end_ && !is_space(*end) && end - p_ < 40) ++end;
    std::string shown(p_, end);
    for (char& c : shown) c = c >= ' ' && c <= '~' ? c : '?';
    return input_error(fmt::format("'{}' is not a number that fits here", shown));
  }

  ByteStream& stream_;
  const char *p_ = nullptr, *end_ = nullptr;
};

/// Bytes in the machine's order, or in the other one.
template <bool kSwap>
class BinaryCursor {
 public:
  explicit BinaryCursor(ByteStream& stream) : stream_(stream) { load(); }

  float real(ScalarType type) {
    switch (type) {
      case ScalarType::float32:
        return std::bit_cast<float>(raw<std::uint32_t>());
      case ScalarType::float64:
        return static_cast<float>(std::bit_cast<double>(raw<std::uint64_t>()));
      default:
        return static_cast<float>(integer(type));
    }
  }

  std::int64_t integer(ScalarType type) {
    switch (type) {
      case ScalarType::int8:
        return static_cast<std::int8_t>(raw<std::uint8_t>());
      case ScalarType::uint8:
        return raw<std::uint8_t>();
      case ScalarType::int16:
        return static_cast<std::int16_t>(raw<std::uint16_t>());
      case ScalarType::uint16:
        return raw<std::uint16_t>();
      case ScalarType::int32:
        return static_cast<std::int32_t>(raw<std::uint32_t>());
      case ScalarType::uint32:
        return raw<std::uint32_t>();
      default:
        break;
    }
    const double value = type == ScalarType::float32 ? real(type) : std::bit_cast<double>(raw<std::uint64_t>());
    if (!(std::fabs(value) < 9e15) || value != std::floor(value)) throw input_error(fmt::format("{} is not an integer", value));
    return static_cast<std::int64_t>(value);
  }

  void skip(ScalarType type, std::uint64_t count = 1) { skip_bytes(count * scalar_size(type)); }
  void skip_bytes(std::uint64_t bytes) {
    commit();
    if (bytes > stream_.remaining()) throw input_error("the file ends too early");
    stream_.seek(stream_.offset() + bytes);
    load();
  }

  void commit() { stream_.set_cursor(p_); }
  std::string place() {
    commit();
    return fmt::format("{}: byte {}", stream_.name(), stream_.offset());
  }

  /// Pointer to the next `bytes` bytes, which are consumed.
  const char* take(std::size_t bytes) {
    if (static_cast<std::size_t>(end_ - p_) < bytes) {
      commit();
      if (!stream_.ensure(bytes)) throw input_error("the file ends too early");
      load();
    }
    const char* result = p_;
    p_ += bytes;
    return result;
  }
  /// The next byte, which stays.
  const char* peek() {
    take(1);
    return --p_;
  }
  template <class T>
  static T decode(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    if constexpr (kSwap && sizeof(T) == 2) value = __builtin_bswap16(value);
    if constexpr (kSwap && sizeof(T) == 4) value = __builtin_bswap32(value);
    if constexpr (kSwap && sizeof(T) == 8) value = __builtin_bswap64(value);
    return value;
  }

 private:
  void load() {
    p_ = stream_.cursor();
    end_ = stream_.end();
  }
  template <class T>
  T raw() {
    return decode<T>(take(sizeof(T)));
  }

  ByteStream& stream_;
  const char *p_ = nullptr, *end_ = nullptr;
};

}  // namespace sightline::ply
