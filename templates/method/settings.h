// Settings of the example method.
#pragma once

#include "base/settings/settings.h"

namespace sightline {

struct ExampleSettings {
  float brightness = 1;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("brightness", &ExampleSettings::brightness, {.help = "multiplies the picture", .minimum = 0, .maximum = 1e6, .symbol = "k"});
  }
};

}  // namespace sightline
