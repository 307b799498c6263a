#include "bench/visibility_cache/tables.h"

#include <gtest/gtest.h>

#include <limits>

#include "bench/visibility_cache/aims.h"
#include "bench/visibility_cache/cache_bench.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

Json results_with_one_curve(double reduction) {
  Json row = {{"ce", 8},        {"seconds", 0.5}, {"speed_up", 2.0},       {"share_traced", 0.02},  {"ray_reduction", reduction},
              {"linf", 0.0125}, {"flip", 0.034},  {"signed_error", 0.001}, {"rejected_share", 0.0}, {"occlusion_rays_kept", 0.03},
              {"l2", 0.1},      {"queries", 100}, {"traced", 2},           {"lookups_per_query", 5}};
  Json json = {{"sightline", "0"}, {"threads", 1}, {"simd", "AVX3"}, {"quick", true}};
  for (const char* part : {"curves", "equal_time", "shadow_maps", "lookup", "flicker", "ablations"}) json[part] = Json::array();
  json["curves"].push_back(
      {{"view", "a<b"}, {"size", {4, 3}}, {"samples", {{{"spp", 1}, {"exact", {{"seconds", 1.0}}}, {"cached", {row}}}}}});
  return json;
}

TEST(CacheTables, MarkdownHasOneRowAMeasurementWithAsManyCellsAsTheHeader) {
  const std::vector<BenchTable> tables = cache_bench_tables(results_with_one_curve(49), "curves");
  ASSERT_EQ(tables.size(), 1u);
  ASSERT_EQ(tables[0].rows.size(), 1u);
  EXPECT_EQ(tables[0].rows[0].size(), tables[0].header.size());
  const std::string text = cache_bench_markdown(results_with_one_curve(49));
  EXPECT_NE(text.find("| 2.00 % | 49.0 |"), std::string::npos) << text;
  EXPECT_NE(text.find("| 1.25 % | +0.10 % | 0.0340 |"), std::string::npos) << text;
}

TEST(CacheTables, AReductionWithoutAnyRayIsADashAlsoOnceItWasWritten) {
  const Json infinite = results_with_one_curve(std::numeric_limits<double>::infinity());
  EXPECT_EQ(cache_bench_tables(infinite, "curves")[0].rows[0][4], "–");
  const Json read = Json::parse(infinite.dump());
  EXPECT_EQ(cache_bench_tables(read, "curves")[0].rows[0][4], "–");
}

TEST(CacheTables, PartsThatWereNotMeasuredHaveNoTables) {
  EXPECT_TRUE(cache_bench_tables(results_with_one_curve(1), "ablations").empty());
  EXPECT_TRUE(cache_bench_tables(Json::object(), "curves").empty());
}

TEST(CacheTables, ThePageHasTheFourChartsAndEscapesNames) {
  BenchResults results;
  results.json = results_with_one_curve(49);
  const std::string page = cache_bench_html(results);
  std::size_t charts = 0;
  for (std::size_t at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1)) ++charts;
  EXPECT_EQ(charts, 4u);
  EXPECT_NE(page.find("a&lt;b"), std::string::npos);
  EXPECT_EQ(page.find("a<b"), std::string::npos);
}

TEST(CacheAims, OnlyWhatWasMeasuredIsJudged) {
  Json json = results_with_one_curve(49);
  EXPECT_TRUE(cache_bench_aims(json).empty());
  json["curves"][0]["view"] = "conference-9";
  const Json aims = cache_bench_aims(json);
  ASSERT_EQ(aims.size(), 2u);
  // 2 % of at most 7 % traced, but 1.25 % of at most 1 % error.
  EXPECT_TRUE(aims[0]["met"].get<bool>()) << aims;
  EXPECT_FALSE(aims[1]["met"].get<bool>()) << aims;
}

TEST(CacheAims, TheCacheIsHeldAgainstTheBestShadowMap) {
  Json json = results_with_one_curve(49);
  const auto row = [](double flip) { return Json{{"name", "x"}, {"flip", flip}}; };
  json["shadow_maps"].push_back(
      {{"view", "v"}, {"ce", 14}, {"samples", {{{"spp", 1}, {"rows", {row(0), row(0.02), row(0.03), row(0.01)}}}}}});
  const Json aims = cache_bench_aims(json);
  ASSERT_EQ(aims.size(), 1u);
  EXPECT_EQ(aims[0]["aim"], 0.01);
  EXPECT_FALSE(aims[0]["met"].get<bool>());
}

TEST(CacheAims, SpeedCountsOnlyWhereTheErrorIsSmall) {
  Json json = results_with_one_curve(49);
  json["curves"][0]["view"] = "kitchen-vpl";
  Json& rows = json["curves"][0]["samples"][0]["cached"];
  rows.push_back(rows[0]);
  rows[1]["ce"] = 64, rows[1]["speed_up"] = 9, rows[1]["linf"] = 0.2;
  const Json aims = cache_bench_aims(json);
  ASSERT_EQ(aims.size(), 1u);
  EXPECT_EQ(aims[0]["measured"], 2.0);
  EXPECT_TRUE(aims[0]["met"].get<bool>());
}

}  // namespace
}  // namespace sightline
