#include "bench/square_lights/figures.h"

#include <array>

namespace sightline {
namespace {

constexpr const char *kNine = "Figure 9", *kTen = "Figure 10";

constexpr std::array<FigureSet, 12> kFigures = {{{.view = "armadillo-sky", .lights = true, .counts = kNine, .local_light = true},
                                                 {.view = "armadillo-sky-sun", .lights = true, .counts = kNine},
                                                 {.view = "armadillo-sky-window", .lights = true, .counts = kNine},
                                                 {.view = "armadillo-sky-grace", .lights = true, .counts = kNine},
                                                 {.view = "teapot-sky", .counts = kTen},
                                                 {.view = "teapot-sky-sun", .counts = kTen},
                                                 {.view = "teapot-sky-window", .counts = kTen},
                                                 {.view = "teapot-sky-grace", .counts = kTen, .materials = true},
                                                 {.view = "movers-12-sky", .motion = "Figure 13"},
                                                 {.view = "movers-5-sky", .motion = "Figure 14"},
                                                 {.view = "pair-sky-sun", .motion = "Two objects"},
                                                 {.view = "man-sky", .deforming = true}}};

}  // namespace

std::vector<std::string> figure_views() {
  std::vector<std::string> views;
  views.reserve(kFigures.size());
  for (const FigureSet& figures : kFigures) views.emplace_back(figures.view);
  return views;
}

FigureSet figures_of(const std::string& view) {
  for (const FigureSet& figures : kFigures) {
    if (view == figures.view) return figures;
  }
  return {.view = "",
          .lights = true,
          .counts = "Numbers of lights",
          .motion = "Motion",
          .materials = true,
          .local_light = true,
          .deforming = true};
}

}  // namespace sightline
