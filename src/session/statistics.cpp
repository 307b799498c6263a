#include "session/statistics.h"

#include <nlohmann/json.hpp>

#include "sightline/version.h"

namespace sightline {
namespace {

using Json = nlohmann::ordered_json;

// "4" → 4, "true" → true, "rbf" → "rbf".
Json value_of_text(const std::string& text) {
  const Json parsed = Json::parse(text, nullptr, false);
  return parsed.is_number() || parsed.is_boolean() ? parsed : Json(text);
}

Json visibility_json(const VisibilityCounts& counts) {
  // Depths beyond the last at which anything was answered say nothing.
  std::size_t depths = counts.answered_at_depth.size();
  while (depths > 0 && counts.answered_at_depth[depths - 1] == 0) --depths;
  Json answered = Json::array();
  for (std::size_t d = 0; d < depths; ++d) answered.push_back(counts.answered_at_depth[d]);
  return {{"queries", counts.queries},    {"traced", counts.traced},
          {"cached", counts.cached},      {"lookups", counts.lookups},
          {"rejected", counts.rejected},  {"residual", counts.residual},
          {"filling", counts.filling},    {"filling_seconds", counts.filling_seconds},
          {"answered_at_depth", answered}};
}

}  // namespace

Json settings_json(const std::vector<std::pair<std::string, std::string>>& settings, const Schema&) {
  Json json = Json::object();
  for (const auto& [name, text] : settings) json[name] = value_of_text(text);
  return json;
}

Json statistics_json(const RenderResult& result, const World& world, const Context& context) {
  Json json;
  json["sightline"] = kVersion;
  json["method"] = result.method;
  json["visibility_name"] = result.visibility;
  json["settings"] = settings_json(result.settings, {});
  json["scene"] = {{"triangles", instanced_triangle_count(world.scene())},
                   {"instances", world.scene().instances.size() + world.scene().spheres.size()},
                   {"lights", world.lights().size()},
                   {"warnings", world.scene().warnings.size()},
                   {"dropped_triangles", world.scene().dropped_triangles}};
  json["size"] = {result.frame.width(), result.frame.height()};
  json["spp"] = result.spp;
  json["samples_done"] = result.frame.samples_done();
  json["max_bounces"] = result.max_bounces;
  json["seed"] = context.seed;
  json["threads"] = context.thread_count();
  json["simd"] = simd_target_name();
  json["stop"] = name_of(result.stop);
  json["seconds"] = {{"load", result.seconds.load},     {"build", result.seconds.build}, {"prepare", result.seconds.prepare},
                     {"render", result.seconds.render}, {"write", result.seconds.write}, {"total", result.seconds.total}};
  json["seconds"]["stages"] = Json::object();
  for (const auto& [name, seconds] : result.statistics.stage_seconds) json["seconds"]["stages"][name] = seconds;
  json["rays"] = {{"closest", result.statistics.rays.closest}, {"occlusion", result.statistics.rays.occlusion}};
  json["visibility"] = visibility_json(result.statistics.visibility);
  json["memory"] = {{"peak_rss_bytes", peak_resident_bytes()},    {"scene_bytes", scene_bytes(world.scene())},
                    {"accel_bytes", world.acceleration_bytes()},  {"accel_peak_bytes", world.tracer().memory().peak_build_bytes},
                    {"frame_bytes", result.frame.memory_bytes()}, {"bake_bytes", result.bake_bytes}};
  json["image"] = {{"mean_luminance", result.frame.mean_luminance()},
                   {"nonfinite_samples", result.frame.nonfinite_samples()},
                   {"nonfinite_pixels", 0},
                   {"saturated_samples", result.frame.saturated_samples()}};
  if (result.error) json["image"]["estimated_relative_error"] = *result.error;
  json["method_statistics"] = Json::object();
  for (const auto& [name, value] : result.statistics.method_statistics) json["method_statistics"][name] = value;
  return json;
}

}  // namespace sightline
