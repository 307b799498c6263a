// Settings of next event estimation++.
#pragma once

#include "base/settings/settings.h"

namespace sightline {

struct NeePlusPlusSettings {
  int resolution = 16;
  int directions = 16;
  int min_tests = 32;
  float min_probability = 0.05f;
  float sure_from = 1;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("resolution", &NeePlusPlusSettings::resolution,
          {.help = "voxels along each axis of the scene's bounds; the table has a pair of counts for each two voxels",
           .minimum = 1,
           .maximum = 24});
    visit(
        "directions", &NeePlusPlusSettings::directions,
        {.help =
             "cells along each edge of the octahedral map of directions, for environments and directional lights; 0: rays without roulette",
         .minimum = 0,
         .maximum = 64});
    visit("min_tests", &NeePlusPlusSettings::min_tests,
          {.help = "rays between two voxels before their probability is believed; until then every query is a ray",
           .minimum = 1,
           .maximum = 1e6});
    visit(
        "min_probability", &NeePlusPlusSettings::min_probability,
        {.help = "least probability of tracing: bounds the weight of a visible answer by its inverse", .minimum = 1.0 / 256, .maximum = 1});
    visit("sure_from", &NeePlusPlusSettings::sure_from,
          {.help = "pairs of voxels that are visible with at least this probability are always traced: less noise, more rays",
           .minimum = 0,
           .maximum = 1});
  }
};

}  // namespace sightline
