// Subpaths from both ends, a batch at a time: every bounce is traced for all paths before the next begins.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "methods/bidirectional/camera.h"
#include "methods/bidirectional/sample_batch.h"
#include "methods/bidirectional/vertex.h"
#include "methods/media.h"
#include "methods/shadow_terminator.h"
#include "world/world.h"

namespace sightline::bidirectional {

struct PathOptions {
  int max_bounces = 8;
  int roulette_start = 4;
  Heuristic heuristic;
  bool light_image = true;  ///< light subpaths are connected to the camera
};

/// What stands at the far end of the ray that a subpath sends out.
struct Walk {
  std::uint32_t path = 0, vertex = kNoVertex;  ///< the vertex it left; none: camera or light
  std::uint32_t depth = 0;                     ///< of that vertex
  Vec3 from{0}, normal{0};                     ///< of the vertex it left; normal 0 for pinholes and points
  bool from_infinity = false;                  ///< densities do not fall with the distance
  Color beta{1};
  double pdf = 0;  ///< of the ray, by solid angle; by area across the beam from infinity
  MisVertex mis;   ///< of the vertex to come, as far as it is known
  MediumId medium;
  float cone_width = 0, cone_spread = 0;
  float scale = 1;  ///< makes throughputs comparable for Russian roulette
};

/// Where a light subpath begins.
struct LightEnd {
  EmissionSample sample;
  MediumId medium;  ///< around it
  bool valid = false;
};

/// Traces one batch after the other; the vertices of the last one are here. One a thread.
class SubpathTracer {
 public:
  SubpathTracer(const World& world, const View& view, const CameraImportance& camera, const PathOptions& options);

  void trace_light_paths(const SampleBatch& batch, RayCounts& counts);
  /// Adds to the batch what eye subpaths find by themselves (s = 0), and its guides.
  void trace_eye_paths(SampleBatch& batch, RayCounts& counts);

  std::span<const PathVertex> eye_vertices() const { return eye_; }
  std::span<const PathVertex> light_vertices() const { return light_; }
  /// Last vertex of each path's light subpath, or kNoVertex; PathVertex::previous leads on.
  std::span<const std::uint32_t> last_light_vertex() const { return last_light_; }
  std::span<const LightEnd> light_ends() const { return ends_; }

 private:
  enum class Side { eye, light };
  void trace(BatchKind kind, RayCounts& counts);
  void random_numbers(const SampleBatch& batch, std::uint32_t pair, AlignedVector<float>& u, AlignedVector<float>& v);
  template <Side side>
  void make_vertices(SampleBatch* batch, std::span<const float> u_mix, std::vector<PathVertex>& vertices);
  template <Side side>
  void scatter(std::vector<PathVertex>& vertices, std::size_t first, bool roulette);
  void add_emission(SampleBatch& batch, std::size_t i);
  void add_environment(SampleBatch& batch, std::size_t i);
  void start_vertex(std::size_t i, float u_mix, PathVertex& vertex) const;

  const World& world_;
  const View& view_;
  const CameraImportance& camera_;
  PathOptions options_;
  bool has_mix_;
  MediumRays medium_rays_;
  MediumId camera_medium_;
  ShadowTerminator terminator_;

  std::vector<PathVertex> eye_, light_;
  std::vector<std::uint32_t> last_light_;
  std::vector<LightEnd> ends_;

  std::vector<Walk> walks_;  ///< one a ray
  std::vector<MediumId> medium_;
  RayBatch rays_;
  HitBatch hits_;
  SurfaceBatch surfaces_;
  AlignedVector<std::uint32_t> key_, index_;
  AlignedVector<float> u0_, u1_, u2_, u3_, u4_, u5_;
};

}  // namespace sightline::bidirectional
