// Connections of a batch's subpaths: what each would carry, and the queries that decide whether it does.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "methods/bidirectional/subpaths.h"
#include "methods/media.h"
#include "visibility/visibility.h"

namespace sightline::bidirectional {

class VertexDensity;

/// Queries of one kind, and what to add where they are answered with 1.
struct ConnectionQueries {
  QueryBatch queries;
  std::vector<Color> contribution;
  std::vector<std::uint32_t> path;
  std::vector<std::uint8_t> direct;  ///< at most one surface between light and camera
  std::vector<MediumId> medium;      ///< at the eye's end; empty without media

  void clear();
  void add_answers(std::span<const float> weights, SampleBatch& batch) const;
};

struct Connections {
  ConnectionQueries light_samples;  ///< s = 1, t >= 2
  ConnectionQueries vertices;       ///< s >= 2, t >= 2
  /// Room for the answers of either.
  std::size_t weights_size() const { return std::max(padded(light_samples.queries.size), padded(vertices.queries.size)); }
};

/// Makes the queries of a batch whose subpaths a tracer holds. One a thread.
class Connector {
 public:
  /// `density` (may be null) tells a cache how densely vertices lie.
  Connector(const World& world, const CameraImportance& camera, const PathOptions& options, const VertexDensity* density);

  void connect_light_samples(const SampleBatch& batch, const SubpathTracer& paths, ConnectionQueries& out);
  void connect_vertices(const SampleBatch& batch, const SubpathTracer& paths, ConnectionQueries& out);
  /// t = 1, with rays of its own: adds to the batch's splats what is seen.
  /// Beer-Lambert along the connections whose answer is not 0.
  void absorb(std::span<const float> weights, ConnectionQueries& queries, RayCounts& rays);
  void connect_camera(SampleBatch& batch, const SubpathTracer& paths, RayCounts& rays, VisibilityCounts& counts);

 private:
  bool connect_pair(const PathVertex& eye, const PathVertex& light, Color& contribution) const;
  bool connect_sample(const PathVertex& eye, std::size_t lane, Color& contribution) const;
  void splat(const PathVertex* light, const LightEnd& end, std::uint32_t path, const Vec2& lens);

  const World& world_;
  const CameraImportance& camera_;
  PathOptions options_;
  const VertexDensity* density_;
  MediumRays medium_rays_;

  // Light samples of one depth after the other.
  Vec3Batch position_, normal_;
  AlignedVector<std::uint32_t> key_, index_;
  AlignedVector<float> u_pick_, u0_, u1_;
  LightSampleBatch samples_;
  std::vector<std::uint32_t> vertex_of_;
  RayBatch arriving_;  ///< of connections that light passes, in a scene with media
  std::vector<MediumId> medium_;
  std::vector<std::uint32_t> connection_;

  // Rays to the camera and what they carry.
  RayBatch rays_;
  std::vector<Splat> candidates_;
  std::vector<Ray> candidate_rays_;
  AlignedVector<std::uint8_t> occluded_;
  std::vector<std::uint32_t> light_end_of_;
};

}  // namespace sightline::bidirectional
