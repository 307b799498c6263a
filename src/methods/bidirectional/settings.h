// Settings of the method bidirectional.
#pragma once

#include "base/settings/settings.h"

namespace sightline {

struct BidirectionalSettings {
  enum class Heuristic { power, balance };
  enum class Density { marginal, conditional };

  Heuristic heuristic = Heuristic::power;
  bool light_image = true;
  int roulette_start = 4;
  Density density = Density::marginal;
  int pass_spp = 1;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("heuristic", &BidirectionalSettings::heuristic,
          {.help = "how strategies are weighed against each other: by their densities squared, or as they are",
           .choices = {"power", "balance"}});
    visit("light_image", &BidirectionalSettings::light_image,
          {.help = "connect light paths to the camera (t = 1): caustics seen directly"});
    visit("roulette_start", &BidirectionalSettings::roulette_start,
          {.help = "bounce from which Russian roulette may end a path, on both sides", .minimum = 0, .maximum = 1e6});
    visit("density", &BidirectionalSettings::density,
          {.help = "density of vertices by which a visibility cache sizes its cells: counted in a grid, or that of the last step alone "
                   "(finer cells)",
           .symbol = "P",
           .choices = {"marginal", "conditional"}});
    visit("pass_spp", &BidirectionalSettings::pass_spp,
          {.help = "samples a pixel that share the answers of a visibility cache: more of them, finer cells; sample ranges are best "
                   "multiples of it",
           .minimum = 1,
           .maximum = 64});
  }
};

}  // namespace sightline
