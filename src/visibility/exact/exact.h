// One ray a query: the truth that every other visibility is compared with.
#pragma once

#include "visibility/visibility.h"

namespace sightline {

struct ExactVisibilitySettings {
  template <class Visitor>
  static void describe(Visitor&&) {}
};

VisibilityInfo exact_visibility();

}  // namespace sightline
