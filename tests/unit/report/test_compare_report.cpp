#include <gtest/gtest.h>

#include <limits>

#include "base/core/error.h"
#include "report/compare_report.h"

namespace sightline {
namespace {

ReportInput small_input() {
  ReportInput input;
  input.reference = {"ref", ColorImage(4, 3, Color(0.5f)), {}, ""};
  input.images.push_back(
      {"image", ColorImage(4, 3, Color(0.25f)), {{"psnr", std::numeric_limits<double>::infinity(), true, "10 log10"}}, "{\"rays\": 1}"});
  return input;
}

TEST(CompareReport, HoldsEverythingItself) {
  const std::string page = compare_report(small_input());
  EXPECT_EQ(page.find("http"), page.find("http-equiv"));
  EXPECT_EQ(page.find("http:"), std::string::npos);
  EXPECT_EQ(page.find("https:"), std::string::npos);
  EXPECT_EQ(page.find("src="), std::string::npos);
}

TEST(CompareReport, InfiniteMetricsTravelAsText) { EXPECT_NE(compare_report(small_input()).find("\"value\":\"inf\""), std::string::npos); }

TEST(CompareReport, HostileNamesCannotLeaveTheData) {
  ReportInput input = small_input();
  input.images[0].name = "</script><script>alert(1)</script>\xff";
  input.images[0].statistics_json = "not </script> json";
  const std::string page = compare_report(input);
  EXPECT_EQ(page.find("alert(1)</script>"), std::string::npos);
  // The two scripts of the page itself end, nothing else does.
  std::size_t ends = 0;
  for (std::size_t at = page.find("</script>"); at != std::string::npos; at = page.find("</script>", at + 1)) ++ends;
  EXPECT_EQ(ends, 2u);
}

TEST(CompareReport, NamesThePictureOfAnotherSize) {
  ReportInput input = small_input();
  input.images[0].image = ColorImage(5, 3);
  try {
    compare_report(input);
    FAIL() << "sizes differ";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_EQ(error.place(), "image");
    EXPECT_NE(error.message().find("5x3"), std::string::npos);
    EXPECT_NE(error.message().find("4x3"), std::string::npos);
  }
}

TEST(CompareReport, SameInputGivesTheSamePage) { EXPECT_EQ(compare_report(small_input()), compare_report(small_input())); }

}  // namespace
}  // namespace sightline
