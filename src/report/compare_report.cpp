#include "report/compare_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/error.h"
#include "report/assets.h"
#include "report/html.h"
#include "report/packed_image.h"

namespace sightline {
namespace {

using OrderedJson = nlohmann::ordered_json;

// JSON has no infinity (the PSNR of equal pictures is one), so such values travel as text.
OrderedJson number(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

OrderedJson describe(const ReportImage& entry) {
  const PackedImage packed = pack_image(entry.image);
  OrderedJson metrics = OrderedJson::array();
  for (const ReportMetric& metric : entry.metrics)
    metrics.push_back({{"name", metric.name},
                       {"value", number(metric.value)},
                       {"larger_is_better", metric.larger_is_better},
                       {"formula", metric.formula}});
  OrderedJson statistics = OrderedJson::parse(entry.statistics_json, nullptr, false);
  if (statistics.is_discarded())
    statistics = entry.statistics_json.empty() ? OrderedJson(nullptr) : OrderedJson{{"text", entry.statistics_json}};
  return {{"name", entry.name},
          {"pixels", packed.base64},
          {"mean_luminance", packed.mean_luminance},
          {"metrics", std::move(metrics)},
          {"statistics", std::move(statistics)}};
}

void check_size(const ReportImage& entry, const ReportImage& reference) {
  const ColorImage &own = entry.image, &expected = reference.image;
  if (own.width == expected.width && own.height == expected.height && own.width > 0 && own.height > 0 &&
      own.pixels.size() == static_cast<std::size_t>(own.width) * static_cast<std::size_t>(own.height))
    return;
  throw input_error(fmt::format("the picture is {}x{}, but the reference {}x{}", own.width, own.height, expected.width, expected.height))
      .at(entry.name)
      .during("writing the report");
}

constexpr std::string_view kBody = R"~html~(<body class="compare">
<header><h1 id="title"></h1><p id="subtitle"></p></header>
<main>
<aside id="pictures" aria-label="Pictures"></aside>
<section class="stage">
  <div class="toolbar">
    <div class="segments" id="modes" role="group" aria-label="View"></div>
    <label class="tone-only">Exposure <input id="exposure" type="range" min="-10" max="10" step="0.1" value="0"><output id="exposure-value">0.0</output></label>
    <label class="tone-only">Tone map <select id="tonemap"></select></label>
    <label class="error-only">Error <select id="error-kind"></select></label>
    <label class="error-only">Range <input id="error-range" type="range" min="-12" max="6" step="0.25" value="0"><output id="error-range-value"></output></label>
    <span class="spring"></span>
    <button id="fit" title="Whole picture (F)">Fit</button><button id="pixels" title="One picture pixel is one screen pixel (1:1)">1:1</button>
  </div>
  <canvas id="viewport" tabindex="0" aria-label="Picture"></canvas>
  <div class="status"><span id="zoom"></span><span id="probe"></span></div>
</section>
</main>
<section class="sheet" id="metrics"></section>
<section class="sheet" id="statistics"></section>
<section class="sheet notes" id="notes"></section>
<footer id="footer"></footer>
<noscript><p class="problem">This page draws its pictures with a script; please allow it.</p></noscript>
)~html~";

}  // namespace

std::string compare_report(const ReportInput& input) {
  OrderedJson data{
      {"title", input.title}, {"width", input.reference.image.width}, {"height", input.reference.image.height}, {"command", input.command},
      {"notes", input.notes}, {"images", OrderedJson::array()}};
  check_size(input.reference, input.reference);
  data["images"].push_back(describe(input.reference));
  for (const ReportImage& entry : input.images) {
    check_size(entry, input.reference);
    data["images"].push_back(describe(entry));
  }

  std::string page = page_head(input.title);
  page += kBody;
  page += "<script type=\"application/json\" id=\"data\">";
  // Names of files may hold any bytes; what is no UTF-8 is replaced instead of refused.
  page += escape_script(data.dump(-1, ' ', false, OrderedJson::error_handler_t::replace));
  page += "</script>\n<script>\n(() => {\n'use strict';\n";
  for (const std::string_view script :
       {assets::decode_js, assets::tone_js, assets::colormap_js, assets::viewport_js, assets::tables_js, assets::compare_js})
    page += script;
  page += "})();\n</script>\n</body>\n</html>\n";
  return page;
}

}  // namespace sightline
