#include "scene/load/pbrt/tokenizer.h"

#include <array>

namespace sightline::pbrt {
namespace {

/// True for the characters that end a word.
constexpr std::array<bool, 256> kEndsWord = [] {
  std::array<bool, 256> table{};
  for (const char c : {' ', '\t', '\r', '\n', '"', '[', ']', '#'}) table[static_cast<unsigned char>(c)] = true;
  return table;
}();

char unescape(char c) {
  switch (c) {
    case 'b':
      return '\b';
    case 'f':
      return '\f';
    case 'n':
      return '\n';
    case 'r':
      return '\r';
    case 't':
      return '\t';
    default:
      return c;
  }
}

}  // namespace

Tokenizer::Tokenizer(std::string_view text, std::string file_name)
    : text_(text), file_(std::make_shared<const std::string>(std::move(file_name))) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text_.starts_with(kByteOrderMark)) position_ = line_start_ = kByteOrderMark.size();
}

Token Tokenizer::next() {
  if (!has_peeked_) return scan();
  has_peeked_ = false;
  return peeked_;
}

const Token& Tokenizer::peek() {
  if (!has_peeked_) {
    peeked_ = scan();
    has_peeked_ = true;
  }
  return peeked_;
}

void Tokenizer::skip_blanks() {
  while (position_ < text_.size()) {
    const char c = text_[position_];
    if (c == '\n') {
      ++line_;
      line_start_ = ++position_;
    } else if (c == ' ' || c == '\t' || c == '\r') {
      ++position_;
    } else if (c == '#') {
      position_ = std::min(text_.find('\n', position_), text_.size());
    } else {
      return;
    }
  }
}

Token Tokenizer::scan() {
  skip_blanks();
  Token token;
  token.line = line_;
  token.column = column_of(position_);
  if (position_ == text_.size()) return token;
  const char c = text_[position_];
  if (c == '"') return scan_string();
  if (c == '[' || c == ']') {
    token.kind = c == '[' ? Token::Kind::open_bracket : Token::Kind::close_bracket;
    token.text = text_.substr(position_++, 1);
    return token;
  }
  const std::size_t start = position_;
  while (position_ < text_.size() && !kEndsWord[static_cast<unsigned char>(text_[position_])]) ++position_;
  token.kind = Token::Kind::word;
  token.text = text_.substr(start, position_ - start);
  return token;
}

Token Tokenizer::scan_string() {
  Token token;
  token.kind = Token::Kind::string;
  token.line = line_;
  token.column = column_of(position_);
  const std::size_t start = ++position_;
  bool has_escapes = false;
  for (; position_ < text_.size() && text_[position_] != '"'; ++position_) {
    if (text_[position_] == '\n') break;
    if (text_[position_] == '\\') {
      has_escapes = true;
      if (++position_ == text_.size()) break;
    }
  }
  if (position_ >= text_.size() || text_[position_] == '\n') throw error_at(place(token), "a string is not closed");
  token.text = text_.substr(start, position_++ - start);
  if (has_escapes) {
    std::string plain;
    for (std::size_t i = 0; i < token.text.size(); ++i) {
      if (token.text[i] != '\\')
        plain += token.text[i];
      else if (++i < token.text.size())
        plain += unescape(token.text[i]);
    }
    token.text = unescaped_.emplace_back(std::move(plain));
  }
  return token;
}

}  // namespace sightline::pbrt
