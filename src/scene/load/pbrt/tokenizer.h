// Splits the text of a pbrt file into tokens, one at a time.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <string_view>

#include "scene/load/pbrt/place.h"

namespace sightline::pbrt {

struct Token {
  enum class Kind { end, word, string, open_bracket, close_bracket };
  Kind kind = Kind::end;
  std::string_view text;  ///< a string without its quotes, escapes resolved
  std::uint32_t line = 1, column = 1;
};

/// Reads forward through a text that it does not own. Views in tokens live as long as the text and the Tokenizer.
class Tokenizer {
 public:
  Tokenizer(std::string_view text, std::string file_name);

  /// The next token; Kind::end at the end. Throws Error{input} for a string that does not end on its line.
  Token next();
  /// The next token without taking it.
  const Token& peek();

  Place place(const Token& token) const { return {file_, token.line, token.column}; }
  Place here() const { return {file_, line_, column_of(position_)}; }

 private:
  void skip_blanks();
  Token scan();
  Token scan_string();
  std::uint32_t column_of(std::size_t position) const { return static_cast<std::uint32_t>(position - line_start_ + 1); }

  std::string_view text_;
  std::shared_ptr<const std::string> file_;
  std::size_t position_ = 0, line_start_ = 0;
  std::uint32_t line_ = 1;
  bool has_peeked_ = false;
  Token peeked_;
  std::deque<std::string> unescaped_;  ///< the few strings that cannot be views of the text
};

}  // namespace sightline::pbrt
