#include <gtest/gtest.h>

#include <algorithm>

#include "bench/square_lights/aims.h"
#include "bench/square_lights/square_bench.h"
#include "bench/square_lights/tables.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

Json empty_results() {
  Json json = {{"sightline", "0"}, {"threads", 1}, {"simd", "AVX3"}, {"quick", true}};
  for (const std::string& part : square_bench_parts()) json[part] = Json::array();
  return json;
}

Json error_row(const char* basis, int lights, double l2) {
  const bool squares = std::string_view(basis) == "squares";
  return {{"basis", basis},
          {"name", std::string(basis) + " " + std::to_string(lights)},
          {"lights", lights},
          {"seconds", 0.5},
          {"l2_tables", squares ? Json(l2 / 2) : Json()},
          {"l2", l2},
          {"nmse", l2},
          {"flip", 0.01}};
}

/// Squares with `l2` at 30 and a quarter of it at 100, wavelets with half a percent and a tenth.
Json error_view(const std::string& name, double l2) {
  return {{"view", name},
          {"size", {8, 6}},
          {"vertices", 12345},
          {"material", "plain"},
          {"cube", 8},
          {"rows",
           {error_row("squares", 30, l2), error_row("squares", 100, l2 / 4), error_row("haar", 30, 5e-3), error_row("haar", 100, 1e-3)}}};
}

Json aim_named(const Json& aims, const std::string& part_of_name) {
  for (const Json& row : aims) {
    if (row["figure"].get<std::string>().find(part_of_name) != std::string::npos) return row;
  }
  return {};
}

TEST(SquareTables, RowsHaveAsManyCellsAsTheHeaderAndErrorsArePercent) {
  Json json = empty_results();
  json["errors"].push_back(error_view("a<b-sky", 0.0035));
  const std::vector<BenchTable> tables = square_bench_tables(json, "errors");
  ASSERT_EQ(tables.size(), 1u);
  for (const std::vector<std::string>& row : tables[0].rows) EXPECT_EQ(row.size(), tables[0].header.size());
  const std::string text = square_bench_markdown(json);
  EXPECT_NE(text.find("| 0.175 % | 0.350 % |"), std::string::npos) << text;
  EXPECT_NE(text.find("| – | 0.500 % |"), std::string::npos) << text;
  BenchResults results;
  results.json = json;
  const std::string page = square_bench_html(results);
  EXPECT_NE(page.find("a&lt;b-sky"), std::string::npos);
  EXPECT_EQ(page.find("a<b-sky"), std::string::npos);
}

TEST(SquareTables, PartsThatWereNotMeasuredHaveNoTables) {
  const Json json = empty_results();
  for (const std::string& part : square_bench_parts()) EXPECT_TRUE(square_bench_tables(json, part).empty()) << part;
  EXPECT_TRUE(square_bench_markdown(json).empty());
  EXPECT_TRUE(square_bench_aims(json).empty());
}

TEST(SquareAims, TheSunHasABarOfItsOwn) {
  Json json = empty_results();
  json["errors"] = {error_view("x-sky", 0.008), error_view("x-sky-sun", 0.008)};
  const Json aims = square_bench_aims(json);
  EXPECT_FALSE(aim_named(aims, "x-sky: l2 of 30 squares")["met"].get<bool>());
  EXPECT_TRUE(aim_named(aims, "x-sky-sun: l2 of 30 squares")["met"].get<bool>());
  EXPECT_TRUE(aim_named(aims, "x-sky-sun: l2 of splitting the light into 30")["met"].get<bool>());
  EXPECT_FALSE(aim_named(aims, "x-sky: l2 of 30 squares, below 30 wavelets")["met"].get<bool>());
}

// At 100 terms squares have to win in three environments of four; fewer than four say nothing.
TEST(SquareAims, EnvironmentsInWhichSquaresBeatWaveletsAreCounted) {
  Json json = empty_results();
  json["errors"] = {error_view("x-sky", 0.003), error_view("x-sky-sun", 0.003), error_view("x-sky-window", 0.003)};
  EXPECT_TRUE(aim_named(square_bench_aims(json), "environments of four").is_null());
  json["errors"].push_back(error_view("x-sky-grace", 0.005));
  const Json aim = aim_named(square_bench_aims(json), "environments of four");
  EXPECT_EQ(aim["measured"], 3);
  EXPECT_TRUE(aim["met"].get<bool>());
}

TEST(SquareAims, ARayWhileFramesAreMadeMissesTheAim) {
  Json json = empty_results();
  Json view = {{"view", "v"}, {"parts", 5}, {"frames_per_second", 12}, {"shading_frames_per_second", 20}, {"occlusion_rays", 0}};
  json["speed"].push_back(view);
  EXPECT_TRUE(aim_named(square_bench_aims(json), "rays")["met"].get<bool>());
  json["speed"][0]["occlusion_rays"] = 1;
  const Json aims = square_bench_aims(json);
  EXPECT_FALSE(aim_named(aims, "rays")["met"].get<bool>());
  EXPECT_TRUE(aim_named(aims, "5 moving parts")["met"].get<bool>());
  EXPECT_TRUE(aim_named(aims, "nothing moving").is_null());
}

TEST(SquareAims, StorageIsJudgedWhereThePaperQuotesIt) {
  Json json = empty_results();
  const auto row = [](const char* name, bool compressed, double each, double ratio) {
    return Json{{"name", name}, {"compressed", compressed}, {"bytes_each", each}, {"ratio", ratio}, {"more_points", 0.01}};
  };
  json["storage"].push_back({{"view", "v"},
                             {"tables_of", "vertices"},
                             {"rows",
                              {row("raw bytes", false, 1024, 4), row("256 clusters, 16 vectors", true, 200, 20),
                               row("256 clusters, 8 vectors", true, 120, 34)}}});
  const Json aims = square_bench_aims(json);
  EXPECT_EQ(aims.size(), 3u);
  EXPECT_TRUE(std::ranges::all_of(aims, [](const Json& aim) { return aim["met"].get<bool>(); })) << aims;
}

}  // namespace
}  // namespace sightline
