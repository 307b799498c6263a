// Which of the paper's figures are made of which view.
#pragma once

#include <string>
#include <vector>

namespace sightline {

struct FigureSet {
  const char* view;
  bool lights = false;           ///< Figure 6
  const char* counts = nullptr;  ///< title of a row over numbers of lights (Figures 9 and 10); null: none
  const char* motion = nullptr;  ///< Figures 13 and 14
  bool materials = false;        ///< Figure 15
  bool local_light = false;      ///< Figure 16, left
  bool deforming = false;        ///< Figure 16, right
};

/// Views that have figures.
std::vector<std::string> figure_views();
/// Of a view that has none of its own: all of them.
FigureSet figures_of(const std::string& view);

}  // namespace sightline
