// The cache where it pays, rays where it does not: measured in the first tiles of a picture.
#pragma once

#include "visibility/visibility.h"

namespace sightline {

VisibilityInfo automatic_visibility();

}  // namespace sightline
