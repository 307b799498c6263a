#include <gtest/gtest.h>

#include "report/index_report.h"

namespace sightline {
namespace {

TEST(IndexReport, ShowsTitleCaptionFactsAndPicture) {
  IndexInput input{.title = "Demo & more", .text = "words", .sections = {}, .footer = "end"};
  GalleryItem item{
      .title = "cornell", .caption = "64 spp", .image = ColorImage(4, 4, Color(0.5f)), .link = "a b.html", .facts = {{"seconds", "1.5"}}};
  input.sections.push_back({.title = "Boxes", .text = "", .items = {item}, .figure = "<svg></svg>"});
  const std::string page = index_report(input);
  for (const char* part : {"Demo &amp; more", "cornell", "64 spp", "<dt>seconds</dt><dd>1.5</dd>", "data:image/png;base64,",
                           "href=\"a b.html\"", "<svg></svg>"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_EQ(page.find("<script"), std::string::npos);
}

TEST(IndexReport, ItemsWithoutPictureHaveNone) {
  IndexInput input;
  input.sections.push_back({.title = "", .text = "", .items = {GalleryItem{.title = "only words"}}, .figure = ""});
  EXPECT_EQ(index_report(input).find("<img"), std::string::npos);
}

}  // namespace
}  // namespace sightline
