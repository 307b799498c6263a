// One batch of samples from camera rays to sums: no threads, no files.
#pragma once

#include <memory>

#include "methods/bidirectional/connections.h"
#include "methods/bidirectional/sample_batch.h"
#include "methods/bidirectional/subpaths.h"
#include "methods/method.h"

namespace sightline::bidirectional {

/// Scratch of one thread.
class Kernel {
 public:
  static constexpr std::size_t kBatch = 1024;

  Kernel(const World& world, const View& view, const CameraImportance& camera, const PathOptions& options, const VertexDensity* density,
         std::uint64_t seed);

  /// Traces the subpaths of a batch, adds what needs no query, and writes the queries for the rest.
  void trace(const BatchRange& range, bool guides, SampleBatch& batch, Connections& connections, PassStatistics& statistics);
  /// Adds the answers to `queries` of that batch.
  void add_answers(std::span<const float> weights, ConnectionQueries& queries, SampleBatch& batch, RayCounts& rays);
  /// The first half of it alone; the vertices are in paths().
  void trace_subpaths(const BatchRange& range, SampleBatch& batch, RayCounts& rays);
  const SubpathTracer& paths() const { return paths_; }

 private:
  const View& view_;
  SubpathTracer paths_;
  Connector connector_;
  std::uint64_t seed_;
};

/// Adds those samples of a finished batch that lie in `wanted` to the frame. Splats land in any tile: for one thread at a time.
void commit(const SampleBatch& batch, const CameraImportance& camera, Frame& frame, SampleRange wanted);

}  // namespace sightline::bidirectional
