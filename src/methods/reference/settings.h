// Settings of the reference method.
#pragma once

#include "base/settings/settings.h"

namespace sightline {

struct ReferenceSettings {
  enum class Mode { automatic, path, one_hit };

  Mode mode = Mode::automatic;
  int light_samples = 1;
  int roulette_start = 4;
  int pass_spp = 1;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("mode", &ReferenceSettings::mode,
          {.help = "path: light and BSDF sampling with MIS; one-hit: one primary ray through the pixel centre, light samples only; "
                   "automatic: one-hit for --spp 1 --light-samples N --max-bounces 0, else path",
           .choices = {"automatic", "path", "one-hit"}});
    visit("light_samples", &ReferenceSettings::light_samples,
          {.help = "light samples a shading point (--light-samples sets it)", .minimum = 1, .maximum = 65536, .symbol = "N"});
    visit("roulette_start", &ReferenceSettings::roulette_start,
          {.help = "bounce from which Russian roulette may end a path", .minimum = 0, .maximum = 1e6});
    visit("pass_spp", &ReferenceSettings::pass_spp,
          {.help = "samples a pixel that a visibility other than exact rays takes as one pass: what it may share, or learns from the last; "
                   "with 1 the picture does not depend on how samples are split",
           .minimum = 1,
           .maximum = 65536,
           .unit = "samples"});
  }
};

}  // namespace sightline
