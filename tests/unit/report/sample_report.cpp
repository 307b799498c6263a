// Writes the pages that the browser test opens: sample_report KIND FILE.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>

#include "report/chart.h"
#include "report/compare_report.h"
#include "report/index_report.h"

namespace {

using namespace sightline;

// A sky with a sun above a checkered ground: smooth parts, edges and values far above 1.
ColorImage synthetic_picture(int width, int height) {
  ColorImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                  v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
      if (v < 0.55f) {
        const float sun = std::exp(-400.0f * ((u - 0.7f) * (u - 0.7f) + (v - 0.22f) * (v - 0.22f)));
        image.at(x, y) = Color(0.25f, 0.42f, 0.8f) * (0.4f + v) + Color(60.0f, 48.0f, 30.0f) * sun;
      } else {
        const float depth = 0.12f / (v - 0.5f);
        const bool light = (static_cast<int>(std::floor((u - 0.5f) * depth * 20)) + static_cast<int>(std::floor(depth * 14))) % 2 == 0;
        image.at(x, y) = light ? Color(0.62f, 0.6f, 0.55f) : Color(0.11f, 0.1f, 0.09f);
      }
    }
  }
  return image;
}

// Multiplicative noise from a hash of the pixel, and a bias.
ColorImage with_noise(ColorImage image, float strength, float bias) {
  std::uint32_t state = 12345;
  for (Color& pixel : image.pixels) {
    state = state * 1664525u + 1013904223u;
    pixel *= 1 + bias + strength * (static_cast<float>(state >> 8) * 0x1p-24f - 0.5f);
  }
  return image;
}

ReportImage entry(std::string name, ColorImage image, double mse, const char* statistics) {
  ReportImage result{std::move(name), std::move(image), {}, statistics};
  result.metrics = {{"mse", mse, false, "mean of (I - R)^2"},
                    {"rmse", std::sqrt(mse), false, "root of mse"},
                    {"psnr", -10 * std::log10(mse), true, "10 log10(1 / mse)"}};
  return result;
}

ReportInput compare_input(int width, int height) {
  ReportInput input;
  input.title = "Sky over a chessboard: <b>not bold</b> & \"quoted\"";
  input.command = "sightline compare ref.exr noisy.exr biased.exr --html report.html";
  const ColorImage picture = synthetic_picture(width, height);
  input.reference = {
      "reference.exr",
      picture,
      {},
      R"({"seconds": {"render": 96.5, "total": 97.2}, "rays": {"closest": 31457280, "occlusion": 125829120}, "memory": {"peak_rss_bytes": 402653184}})"};
  input.images.push_back(entry(
      "noisy.exr", with_noise(picture, 0.6f, 0), 4.2e-3,
      R"({"seconds": {"render": 1.25, "total": 1.9}, "rays": {"closest": 1228800, "occlusion": 4915200}, "memory": {"peak_rss_bytes": 301989888}, "settings": {"mode": "one-hit"}})"));
  ColorImage biased = with_noise(picture, 0.05f, -0.12f);
  biased.at(3, 3) = Color(NAN, 1, 1);
  input.images.push_back(entry("biased </script> & co.exr", std::move(biased), 9.1e-4, "no JSON at all"));
  input.notes = {"Metrics leave out background and emitters (--mask).", "One pixel of biased.exr is not a number."};
  return input;
}

IndexInput index_input() {
  IndexInput input{
      .title = "Sightline demo", .text = "Built-in scenes, every registered method.", .sections = {}, .footer = "sightline 0.1.0"};
  GallerySection section{.title = "cornell", .text = "A box with a lamp.", .items = {}, .figure = {}};
  for (int i = 0; i < 3; ++i) {
    section.items.push_back({.title = "picture " + std::to_string(i),
                             .caption = "64 samples a pixel",
                             .image = with_noise(synthetic_picture(320, 200), 0.2f * static_cast<float>(i), 0),
                             .link = "compare.html",
                             .facts = {{"seconds", "1.3"}, {"rays", "12.4 M"}}});
  }
  section.figure = line_chart(
      {{"reference", {{0.1, 0.5}, {1, 0.16}, {10, 0.05}, {100, 0.016}}}, {"another", {{0.1, 0.2}, {1, 0.05}, {10, 0.02}, {100, 0.015}}}},
      {.title = "Error over time", .x_label = "seconds", .y_label = "relative error", .log_x = true, .log_y = true});
  section.figure += bar_chart({{"primary", 17.7}, {"shadow", 20.1}, {"diffuse bounce", 5.3}}, {.title = "Rays", .x_label = "Mray/s"});
  input.sections.push_back(std::move(section));
  return input;
}

std::string replaced(std::string page, std::string_view from, std::string_view to) {
  page.replace(page.find(from), from.size(), to);
  return page;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: sample_report compare|single|index|damaged|throwing FILE\n");
    return 2;
  }
  const std::string_view kind = argv[1];
  std::string page;
  if (kind == "index") {
    page = index_report(index_input());
  } else if (kind == "single") {
    ReportInput input = compare_input(1, 1 + 2);
    input.images.clear();
    page = compare_report(input);
  } else if (kind == "damaged") {
    // Other pictures than those whose means were written down.
    page = replaced(compare_report(compare_input(64, 48)), "\"mean_luminance\":", "\"mean_luminance\":1");
  } else if (kind == "throwing") {
    page = replaced(compare_report(compare_input(64, 48)), "'use strict';", "'use strict'; document.body.missing.call();");
  } else {
    page = compare_report(compare_input(640, 400));
  }
  std::ofstream(argv[2], std::ios::binary) << page;
  return 0;
}
