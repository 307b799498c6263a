#include "report/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "report/html.h"

namespace sightline {
namespace {

// Distinguishable on dark and on white ground, and for colour-blind readers by brightness as well.
constexpr std::array<const char*, 7> kColors{"#4f9dde", "#e8a33d", "#5fb76a", "#d9655f", "#a98bd8", "#8f8f8f", "#49b8b3"};
constexpr double kTextPx = 12;

const char* color_of_series(std::size_t i) { return kColors[i % kColors.size()]; }

// Maps values of one axis to pixels, linearly or by logarithm.
struct Axis {
  double low = 0, high = 1, start_px = 0, end_px = 1;
  bool logarithmic = false;

  bool accepts(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
  double pixel(double value) const {
    const auto scale = [&](double v) { return logarithmic ? std::log10(v) : v; };
    return start_px + (scale(value) - scale(low)) / (scale(high) - scale(low)) * (end_px - start_px);
  }
};

std::vector<double> ticks_of(const Axis& axis, int count) {
  if (!axis.logarithmic) return axis_ticks(axis.low, axis.high, count);
  std::vector<double> ticks;
  // Whole decades, thinned out where there are many; 2 and 5 times them where there are few.
  const int first = static_cast<int>(std::floor(std::log10(axis.low))), last = static_cast<int>(std::floor(std::log10(axis.high) + 1e-9));
  const int step = std::max(1, (last - first) / std::max(1, count));
  for (int exponent = first; exponent <= last; exponent += step) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double tick = factor * std::pow(10.0, exponent);
      const bool inside = tick >= axis.low * (1 - 1e-9) && tick <= axis.high * (1 + 1e-9);
      if (inside && (factor == 1 || last - first <= 3)) ticks.push_back(tick);
    }
  }
  if (ticks.size() < 2) return axis_ticks(axis.low, axis.high, count);
  return ticks;
}

// The range of all values, widened to something that can be drawn.
void fit(Axis& axis, double low, double high) {
  if (!(low <= high)) low = axis.logarithmic ? 1 : 0, high = axis.logarithmic ? 10 : 1;
  if (axis.logarithmic) {
    axis.low = std::pow(10.0, std::floor(std::log10(low) * 4) / 4);
    axis.high = std::pow(10.0, std::ceil(std::log10(high) * 4) / 4);
    if (axis.low == axis.high) axis.high *= 10;
    return;
  }
  if (low > 0 && low < 0.4 * high) low = 0;
  if (low == high) high = low + (low == 0 ? 1 : std::abs(low));
  const std::vector<double> ticks = axis_ticks(low, high, 6);
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : high - low;
  axis.low = std::floor(low / step + 1e-9) * step;
  axis.high = std::ceil(high / step - 1e-9) * step;
}

std::string number_text(double value) {
  if (value == 0) return "0";
  const double magnitude = std::abs(value);
  return magnitude >= 1e5 || magnitude < 1e-3 ? fmt::format("{:.3g}", value) : fmt::format("{:.4g}", value);
}

std::string text_at(double x, double y, std::string_view anchor, std::string_view text, std::string_view extra = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, extra, escape_html(text));
}

std::string start_svg(const ChartOptions& options, int height_px) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
      "font-family=\"system-ui, sans-serif\" font-size=\"{2}\" fill=\"#8c8c8c\">\n<title>{3}</title>\n",
      options.width_px, height_px, kTextPx, escape_html(options.title));
  if (!options.title.empty()) svg += text_at(options.width_px / 2.0, 18, "middle", options.title, " font-size=\"14\" font-weight=\"600\"");
  return svg;
}

}  // namespace

std::vector<double> axis_ticks(double low, double high, int count) {
  if (!(high > low) || !std::isfinite(low) || !std::isfinite(high)) return {low};
  const double rough = (high - low) / std::max(1, count);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double ratio = rough / power;
  const double step = power * (ratio < 1.5 ? 1 : ratio < 3.5 ? 2 : ratio < 7.5 ? 5 : 10);
  std::vector<double> ticks;
  // Multiples of the step rather than a running sum, so that 0 is 0 and 0.3 is 0.3.
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) ticks.push_back(k * step);
  return ticks;
}

std::string line_chart(const std::vector<ChartSeries>& series, const ChartOptions& options) {
  const bool legend = series.size() > 1;
  const double top = options.title.empty() ? 16 : 36, bottom = options.height_px - (options.x_label.empty() ? 28.0 : 46.0);
  Axis x{.start_px = options.y_label.empty() ? 56.0 : 74.0, .end_px = options.width_px - 18.0, .logarithmic = options.log_x};
  Axis y{.start_px = bottom, .end_px = top + (legend ? 22 : 0), .logarithmic = options.log_y};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double x_low = kInfinity, x_high = -kInfinity, y_low = kInfinity, y_high = -kInfinity;
  for (const ChartSeries& one : series) {
    for (const auto& [px, py] : one.points) {
      if (!x.accepts(px) || !y.accepts(py)) continue;
      x_low = std::min(x_low, px), x_high = std::max(x_high, px);
      y_low = std::min(y_low, py), y_high = std::max(y_high, py);
    }
  }
  fit(x, x_low, x_high);
  fit(y, y_low, y_high);

  std::string svg = start_svg(options, options.height_px);
  for (const double tick : ticks_of(y, 6)) {
    const double at = y.pixel(tick);
    svg += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#8c8c8c\" stroke-opacity=\"0.25\"/>\n",
                       x.start_px, at, x.end_px, at);
    svg += text_at(x.start_px - 6, at + 4, "end", number_text(tick));
  }
  for (const double tick : ticks_of(x, 8)) {
    const double at = x.pixel(tick);
    svg += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#8c8c8c\" stroke-opacity=\"0.6\"/>\n", at,
                       bottom, at, bottom + 4);
    svg += text_at(at, bottom + 17, "middle", number_text(tick));
  }
  svg += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#8c8c8c\"/>\n", x.start_px, bottom, x.end_px,
                     bottom);
  if (!options.x_label.empty()) svg += text_at((x.start_px + x.end_px) / 2, options.height_px - 10, "middle", options.x_label);
  if (!options.y_label.empty()) {
    const double middle = (y.start_px + y.end_px) / 2;
    svg += text_at(16, middle, "middle", options.y_label, fmt::format(" transform=\"rotate(-90 16 {:.1f})\"", middle));
  }

  double legend_x = x.start_px;
  for (std::size_t i = 0; i < series.size(); ++i) {
    std::string path, markers;
    for (const auto& [px, py] : series[i].points) {
      if (!x.accepts(px) || !y.accepts(py)) continue;
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : " L", x.pixel(px), y.pixel(py));
      markers += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"><title>{}: {}, {}</title></circle>\n", x.pixel(px),
                             y.pixel(py), color_of_series(i), escape_html(series[i].name), number_text(px), number_text(py));
    }
    if (!path.empty())
      svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n{}", path, color_of_series(i), markers);
    if (legend) {
      svg +=
          fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"12\" height=\"3\" fill=\"{}\"/>\n", legend_x, top + 3, color_of_series(i));
      svg += text_at(legend_x + 17, top + 8, "start", series[i].name);
      legend_x += 34 + 0.56 * kTextPx * static_cast<double>(series[i].name.size());
    }
  }
  return svg + "</svg>\n";
}

std::string bar_chart(const std::vector<ChartBar>& bars, const ChartOptions& options) {
  std::size_t longest = 1;
  double largest = 0;
  for (const ChartBar& bar : bars) {
    longest = std::max(longest, bar.name.size());
    if (std::isfinite(bar.value)) largest = std::max(largest, bar.value);
  }
  constexpr double kRowPx = 26;
  const double top = options.title.empty() ? 8 : 32,
               left = std::min(options.width_px * 0.45, 20 + 0.56 * kTextPx * static_cast<double>(longest));
  const int height_px = static_cast<int>(top + kRowPx * static_cast<double>(bars.size()) + (options.x_label.empty() ? 8 : 28));
  const Axis axis{.low = 0, .high = largest > 0 ? largest : 1, .start_px = left, .end_px = options.width_px - 84.0};
  std::string svg = start_svg(options, height_px);
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const double y = top + kRowPx * static_cast<double>(i);
    const double value = std::isfinite(bars[i].value) ? std::max(0.0, bars[i].value) : 0;
    svg += text_at(left - 8, y + 17, "end", bars[i].name);
    svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"2\" fill=\"{}\"/>\n", left, y + 4,
                       axis.pixel(value) - left, kRowPx - 8, color_of_series(i));
    svg += text_at(axis.pixel(value) + 6, y + 17, "start", number_text(bars[i].value));
  }
  if (!options.x_label.empty()) svg += text_at((axis.start_px + axis.end_px) / 2, height_px - 8.0, "middle", options.x_label);
  return svg + "</svg>\n";
}

}  // namespace sightline
