// Settings of plain shadow maps.
#pragma once

#include "base/settings/settings.h"

namespace sightline {

struct ShadowMapSettings {
  enum class Fill { automatic, whole, on_demand };

  int resolution = 1024;
  Fill fill = Fill::automatic;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("resolution", &ShadowMapSettings::resolution,
          {.help = "texels along an edge of a map: of each cube face of a point or spot light, of the one map of a directional light",
           .minimum = 16,
           .maximum = 8192,
           .unit = "texels"});
    visit(
        "fill", &ShadowMapSettings::fill,
        {.help = "whole: all maps before the first pass; on-demand: tiles of 32x32 texels when they are first asked for; automatic: whole "
                 "if the maps fit in memory. The picture is the same",
         .choices = {"automatic", "whole", "on-demand"}});
  }
};

}  // namespace sightline
