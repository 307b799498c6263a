// Filter functions that make holes of alpha-masked surfaces transparent to Embree's rays, and interfaces to shadow rays.
#pragma once

#include <cstdint>
#include <vector>

#include "trace/embree/embree_compat.h"

namespace sightline {

/// From Embree's geometry ids to Scene::instances.
struct GeometryTables {
  std::vector<std::uint32_t> static_instances;  ///< by geomID in the static scene
  std::vector<std::uint32_t> top_instances;     ///< by instID in the top-level scene
};

/// Rejects hits in holes. The data is found through the EmbreeQuery that the context is part of.
void reject_holes(const RTCFilterFunctionNArguments* arguments);
/// The same for rays of occlusion, which interfaces let pass too.
void reject_holes_and_interfaces(const RTCFilterFunctionNArguments* arguments);

}  // namespace sightline
