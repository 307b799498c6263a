// sightline compare
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/core/error.h"
#include "base/settings/settings.h"
#include "commands.h"
#include "image/false_color.h"
#include "image/io/image_io.h"
#include "image/metrics/metrics.h"
#include "image/tone_map.h"
#include "report/compare_report.h"

namespace sightline::app {
namespace {

using Json = nlohmann::ordered_json;

struct Picture {
  std::string name;
  LayeredImage layers;
  ColorImage color;
  std::string statistics;
};

Picture load_picture(const std::string& path) {
  Picture picture{std::filesystem::path(path).filename().string(), read_layered_image(path), {}, {}};
  picture.color = color_of(picture.layers);
  for (const auto& [key, value] : picture.layers.metadata) {
    if (key == "sightline.statistics") picture.statistics = value;
  }
  return picture;
}

// Pixels whose samples all hit a surface that does not emit (docs/metrics.md).
std::vector<std::uint8_t> surface_mask(const Picture& reference, const std::string& path) {
  const Channel* surface = reference.layers.find("surface.S");
  if (!surface) throw usage_error("--mask needs a surface layer in the reference").at(path).remedy("render it with --aov surface");
  std::vector<std::uint8_t> mask(surface->values.size());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = surface->values[i] > 0.999f;
  return mask;
}

struct Threshold {
  const Metric* metric;
  double value;
};

Threshold parse_threshold(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) throw usage_error(fmt::format("--fail-over '{}' is not METRIC=VALUE", text));
  return {&find_metric(text.substr(0, equals)), parse_real("--fail-over", text.substr(equals + 1), SettingInfo{})};
}

void write_difference(const std::string& path, const ColorImage& reference, const ColorImage& image, const MetricOptions& options) {
  const std::vector<std::uint8_t> pixels = false_color(flip_map(reference, image, options));
  write_file(path, encode_png(reference.width, reference.height, 3, pixels));
}

}  // namespace

int run_compare(const CommandLine& line, Console& console, Context&) {
  const CompareCommand& command = line.compare;
  std::vector<Threshold> thresholds;
  thresholds.reserve(command.fail_over.size());
  for (const std::string& text : command.fail_over) thresholds.push_back(parse_threshold(text));
  for (const std::string& path : {command.html, command.difference, command.json}) {
    if (!path.empty() && path != "-") check_writable(path);
  }
  const Picture reference = load_picture(command.reference);
  std::vector<std::uint8_t> mask;
  if (command.mask) mask = surface_mask(reference, command.reference);
  MetricOptions options;
  options.exposure_ev = command.exposure_ev;
  options.mask = mask;

  ReportInput report;
  report.title = "Comparison with " + reference.name;
  report.reference = {reference.name, reference.color, {}, reference.statistics};
  if (command.mask) report.notes.push_back("Background and emitters of the reference are left out of the metrics.");
  if (command.exposure_ev != 0)
    report.notes.push_back(fmt::format("Metrics of tone-mapped pictures are taken after {} stops of exposure.", command.exposure_ev));
  report.command = line.render.command_line;

  Json json = {{"reference", command.reference}, {"images", Json::array()}};
  bool failed = false;
  for (const std::string& path : command.images) {
    const Picture picture = load_picture(path);
    if (picture.color.width != reference.color.width || picture.color.height != reference.color.height)
      throw input_error(fmt::format("{}x{} pixels, but the reference has {}x{}", picture.color.width, picture.color.height,
                                    reference.color.width, reference.color.height))
          .at(path);
    Json values = Json::object();
    std::vector<ReportMetric> rows;
    for (const Metric& metric : metrics()) {
      const double value = metric.compute(reference.color, picture.color, options);
      values[metric.name] = value;
      rows.push_back({metric.name, value, metric.larger_is_better, metric.formula});
      for (const Threshold& threshold : thresholds) {
        if (threshold.metric->name != metric.name) continue;
        const bool worse = metric.larger_is_better ? value < threshold.value : value > threshold.value;
        // A metric that is not a number is never good enough.
        if (!worse && !std::isnan(value)) continue;
        failed = true;
        console.log(LogLevel::error, fmt::format("{}: {} = {:.6g} is worse than {:.6g}", path, metric.name, value, threshold.value));
      }
    }
    json["images"].push_back({{"file", path}, {"metrics", values}});
    if (command.json != "-") {
      fmt::print("{}\n", path);
      for (const ReportMetric& row : rows) fmt::print("  {:<8} {:.6g}\n", row.name, row.value);
    }
    if (!command.difference.empty() && &path == &command.images.front())
      write_difference(command.difference, reference.color, picture.color, options);
    report.images.push_back({picture.name, picture.color, std::move(rows), picture.statistics});
  }
  if (!command.json.empty()) write_text(command.json, json.dump(2) + "\n");
  if (!command.html.empty()) write_text(command.html, compare_report(report));
  return failed ? kOverThreshold : kDone;
}

}  // namespace sightline::app
