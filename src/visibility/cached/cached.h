// Answers shared by all queries of a cluster [Popov2013]: one shadow ray where fifty were asked. See README.md.
#pragma once

#include "visibility/cached/settings.h"
#include "visibility/visibility.h"

namespace sightline {

VisibilityInfo cached_visibility();

}  // namespace sightline
