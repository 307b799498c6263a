// Words and numbers of the line-based formats OBJ and MTL.
#pragma once

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/core/error.h"

namespace sightline::obj {

/// Goes through a text line by line and through a line word by word, without copying. '#' begins a comment, '\' before a line end joins
/// lines. Errors carry name and line.
class LineReader {
 public:
  LineReader(std::string_view text, std::string_view name) : p_(text.data()), end_(p_ + text.size()), name_(name) {}

  /// Moves to the next line; false at the end of the text.
  bool next_line() {
    if (started_) {
      while (p_ != end_ && *p_ != '\n') skip_char();
      if (p_ == end_) return false;
      ++p_;
      ++line_;
    }
    started_ = true;
    return p_ != end_;
  }
  /// Next word of this line, empty at its end.
  std::string_view word() {
    skip_space();
    const char* begin = p_;
    while (p_ != end_ && !is_space(*p_) && *p_ != '\n' && !at_joint()) ++p_;
    return {begin, static_cast<std::size_t>(p_ - begin)};
  }
  bool at_line_end() {
    skip_space();
    return p_ == end_ || *p_ == '\n';
  }
  /// Rest of the line without white space at both ends: names and file names may hold spaces.
  std::string_view rest() {
    skip_space();
    const char* begin = p_;
    while (p_ != end_ && *p_ != '\n') ++p_;
    const char* last = p_;
    while (last != begin && is_space(last[-1])) --last;
    return {begin, static_cast<std::size_t>(last - begin)};
  }
  /// A number, or nothing (and no move) if the next word is none.
  std::optional<float> number() {
    skip_space();
    float value = 0;
    if (p_ == end_) return std::nullopt;
    const auto [after, failure] = fast_float::from_chars(p_ + (*p_ == '+'), end_, value);
    if (failure != std::errc{} && failure != std::errc::result_out_of_range) return std::nullopt;
    p_ = after;
    return value;
  }
  float require_number() {
    const std::optional<float> value = number();
    if (!value) throw error(fmt::format("'{}' is not a number", printable(word())));
    return *value;
  }
  Error error(std::string message) const { return input_error(std::move(message)).at(place()); }
  std::string place() const { return fmt::format("{}:{}", name_, line_); }
  std::uint64_t line() const { return line_; }

  static std::string printable(std::string_view text) {
    std::string shown(text.substr(0, 40));
    for (char& c : shown) c = c >= ' ' && c <= '~' ? c : '?';
    return shown;
  }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
  bool at_joint() const { return *p_ == '\\' && end_ - p_ > 1 && (p_[1] == '\n' || (p_[1] == '\r' && end_ - p_ > 2 && p_[2] == '\n')); }
  void skip_joint() {
    p_ += p_[1] == '\n' ? 2 : 3;
    ++line_;
  }
  void skip_char() {
    if (at_joint()) {
      skip_joint();
    } else {
      ++p_;
    }
  }
  void skip_space() {
    while (p_ != end_) {
      if (is_space(*p_)) {
        ++p_;
      } else if (at_joint()) {
        skip_joint();
      } else if (*p_ == '#') {
        while (p_ != end_ && *p_ != '\n') ++p_;
      } else {
        return;
      }
    }
  }

  const char *p_, *end_;
  std::string_view name_;
  std::uint64_t line_ = 1;
  bool started_ = false;
};

}  // namespace sightline::obj
