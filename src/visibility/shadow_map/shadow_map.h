// Plain shadow maps: what the cache is compared with, not a rival in quality. See README.md beside this file.
#pragma once

#include "visibility/visibility.h"

namespace sightline {

VisibilityInfo shadow_map_visibility();

}  // namespace sightline
