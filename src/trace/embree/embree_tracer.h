// Access to what an Embree tracer built, for benchmarks that call Embree themselves.
#pragma once

#include "trace/embree/packets.h"
#include "trace/tracer.h"

namespace sightline {

/// The scenes of an Embree tracer; nullptr for other tracers. Valid as long as the tracer.
const EmbreeScenes* embree_scenes(const Tracer& tracer);

}  // namespace sightline
