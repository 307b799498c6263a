// Next event estimation++: Russian roulette of shadow rays by the visibility between voxels. See README.md beside this file.
#pragma once

#include "visibility/visibility.h"

namespace sightline {

VisibilityInfo nee_plus_plus_visibility();

}  // namespace sightline
