// The shadow ray of a query: one definition for every visibility.
#pragma once

#include <cstdint>
#include <span>

#include "visibility/query_batch.h"
#include "world/world.h"

namespace sightline {

/// The ray that decides query i, moved off both surfaces by their error bounds. t_far < t_near for a gap.
Ray query_ray(const QueryBatch& queries, std::size_t i);
/// The ray of a query between two ends.
Ray query_ray(const QueryBatch& queries, std::size_t eye, std::size_t light);

/// One ray for each query in packets of `queries.kind`, gaps included; weights 0 or 1.
class QueryTracer {
 public:
  explicit QueryTracer(const World& world) : world_(&world) {}
  void trace_all(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts);
  /// The listed queries as incoherent packets: occluded[k] for which[k].
  std::span<const std::uint8_t> trace(const QueryBatch& queries, std::span<const std::uint32_t> which, RayCounts& rays,
                                      VisibilityCounts& counts);

 private:
  const World* world_;
  RayBatch batch_;
  AlignedVector<std::uint8_t> occluded_;
};

}  // namespace sightline
