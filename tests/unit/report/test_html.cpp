#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "report/html.h"

namespace sightline {
namespace {

std::string base64_of(std::string_view text) { return base64(std::as_bytes(std::span(text.data(), text.size()))); }

// The test vectors of RFC 4648, section 10.
TEST(Html, Base64AgreesWithTheStandardsVectors) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foob"), "Zm9vYg==");
  EXPECT_EQ(base64_of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64_of("\xff\xfe\xfd"), "//79");
}

TEST(Html, MarkupInTextStaysText) {
  EXPECT_EQ(escape_html("<a href=\"x\">'&'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
}

TEST(Html, JsonCannotEndItsScript) {
  const std::string escaped = escape_script(R"({"name": "</script><!--"})");
  EXPECT_EQ(escaped.find('<'), std::string::npos);
  EXPECT_EQ(escaped, R"({"name": "\u003c/script>\u003c!--"})");
}

TEST(Html, PagesForbidTheNetwork) { EXPECT_NE(page_head("t").find("default-src 'none'"), std::string::npos); }

}  // namespace
}  // namespace sightline
