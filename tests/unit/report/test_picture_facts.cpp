#include <gtest/gtest.h>

#include "report/picture_facts.h"

namespace sightline {
namespace {

using Facts = std::vector<std::pair<std::string, std::string>>;

TEST(PictureFacts, ShowWhatTheStatisticsHold) {
  const Facts facts = picture_facts(
      R"({"method": "reference", "size": [640, 480], "samples_done": 16, "scene": {"triangles": 2850000},
          "seconds": {"render": 2.0}, "rays": {"closest": 3000000, "occlusion": 1000000}, "memory": {"peak_rss_bytes": 104857600}})");
  EXPECT_EQ(facts, (Facts{{"method", "reference"},
                          {"size", "640 × 480"},
                          {"samples a pixel", "16"},
                          {"triangles", "2.85 M"},
                          {"render time", "2 s"},
                          {"rays", "4 M (2 M/s)"},
                          {"peak memory", "100 MiB"}}));
}

TEST(PictureFacts, LeaveOutWhatIsMissingOrMalformed) {
  EXPECT_TRUE(picture_facts("").empty());
  EXPECT_TRUE(picture_facts("no JSON").empty());
  EXPECT_TRUE(picture_facts("[1, 2]").empty());
  EXPECT_TRUE(picture_facts(R"({"method": 3, "size": "large", "seconds": 2, "rays": {"closest": "many"}})").empty());
}

TEST(PictureFacts, ShortNumbersHaveThreeDigitsAndAUnit) {
  EXPECT_EQ(short_number(0), "0");
  EXPECT_EQ(short_number(999), "999");
  EXPECT_EQ(short_number(999.6), "1 k");
  EXPECT_EQ(short_number(12345), "12.3 k");
  EXPECT_EQ(short_number(2.5e9), "2.5 G");
}

}  // namespace
}  // namespace sightline
