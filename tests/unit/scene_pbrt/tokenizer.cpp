#include "scene/load/pbrt/tokenizer.h"

#include "unit/scene_pbrt/pbrt_text.h"

namespace sightline::pbrt {
namespace {

TEST(PbrtTokenizer, SplitsWordsStringsAndBracketsWithTheirPlaces) {
  Tokenizer tokens("Shape\"a b\"[1 -2.5e3]# comment \" [\n  end", "f.pbrt");
  struct Expected {
    Token::Kind kind;
    std::string_view text;
    std::uint32_t line, column;
  };
  for (const Expected& e : {Expected{Token::Kind::word, "Shape", 1, 1}, Expected{Token::Kind::string, "a b", 1, 6},
                            Expected{Token::Kind::open_bracket, "[", 1, 11}, Expected{Token::Kind::word, "1", 1, 12},
                            Expected{Token::Kind::word, "-2.5e3", 1, 14}, Expected{Token::Kind::close_bracket, "]", 1, 20},
                            Expected{Token::Kind::word, "end", 2, 3}, Expected{Token::Kind::end, "", 2, 6}}) {
    const Token token = tokens.next();
    EXPECT_EQ(token.kind, e.kind);
    EXPECT_EQ(token.text, e.text);
    EXPECT_EQ(token.line, e.line);
    EXPECT_EQ(token.column, e.column);
  }
}

TEST(PbrtTokenizer, ResolvesEscapes) {
  Tokenizer tokens(R"("a\"b\\c\td")", "f.pbrt");
  EXPECT_EQ(tokens.next().text, "a\"b\\c\td");
}

TEST(PbrtTokenizer, PeekingTakesNothing) {
  Tokenizer tokens("one two", "f.pbrt");
  EXPECT_EQ(tokens.peek().text, "one");
  EXPECT_EQ(tokens.next().text, "one");
  EXPECT_EQ(tokens.next().text, "two");
}

TEST(PbrtTokenizer, AnUnclosedStringIsAnErrorWhereItBegins) {
  for (const char* text : {"a\n  \"open", "a\n  \"open\n\"", "a\n  \"open\\"}) {
    Tokenizer tokens(text, "f.pbrt");
    tokens.next();
    try {
      tokens.next();
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.place(), "f.pbrt:2:3");
    }
  }
}

}  // namespace
}  // namespace sightline::pbrt
