// Visibility queries as structures of arrays: what methods ask and what every Visibility answers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/core/aligned.h"
#include "base/math/vec.h"
#include "trace/ray_batch.h"

namespace sightline {

/// What the light end of a query is: decides how a cache may share the answer.
enum class QuerySemantic : std::uint8_t {
  point,        ///< a point light: the position itself
  direction,    ///< a directional light: `position` holds the unit direction towards it
  surface,      ///< a point of a surface: area lights, virtual point lights, path vertices
  solid_angle,  ///< a direction with extent: environments; `position` holds the unit direction
};
constexpr bool is_infinite(QuerySemantic s) { return s == QuerySemantic::direction || s == QuerySemantic::solid_angle; }

/// How a cache divides the patch that C_E² queries share between both ends.
enum class QuerySplit : std::uint8_t {
  eye,        ///< the eye end takes all of it: many eye points, few lights [Popov2013, Eq. 7]
  symmetric,  ///< both ends alike: connections of path tracing [Popov2013, Eq. 6]
};

/// What the light ends of semantic `surface` of a batch are: a cache may allow each kind an error of its own.
enum class SurfaceEnds : std::uint8_t {
  area_light,     ///< points of emitting surfaces
  virtual_light,  ///< virtual point lights
  path_vertex,    ///< vertices of light sub-paths
};

/// Ends of queries on one side, structure of arrays, padded to kLanes. Several queries may share an end: its part of a cache key is then
/// made once.
struct QueryEnds {
  Vec3Batch position;          ///< or unit direction, see QuerySemantic
  Vec3Batch normal;            ///< unit geometric normal on the side that the path arrived from; 0 for points and directions
  AlignedVector<float> error;  ///< absolute error bound of `position`, per component
  /// Area of the surface that one sample stands for: 1 / (N_S P(p_e)) on the eye side, N_S / (N_P P(p_l)) on the light side, in world
  /// units²; steradians for solid_angle. 0 = not known: the query is answered by a ray of its own.
  AlignedVector<float> cell_area;
  AlignedVector<std::uint32_t> id;  ///< hash of pixel, sample and vertex: reproducible random numbers for those who need them
  std::size_t size = 0;

  void resize(std::size_t n) {
    size = n;
    position.resize(n), normal.resize(n);
    error.resize(padded(n)), cell_area.resize(padded(n)), id.resize(padded(n));
  }
  void set(std::size_t i, const Vec3& p, const Vec3& n, float position_error, float area, std::uint32_t identity) {
    position.x[i] = p.x, position.y[i] = p.y, position.z[i] = p.z;
    normal.x[i] = n.x, normal.y[i] = n.y, normal.z[i] = n.z;
    error[i] = position_error, cell_area[i] = area, id[i] = identity;
  }
};

/// Query i asks whether eye end eye_of[i] sees light end light_of[i]. The order of the queries is part of the question: where answers are
/// shared, the earlier one is traced. A query with light_of[i] == kNoQuery is a gap (answer 0, not counted): with gaps a caller composes
/// the packets of rays itself, as coherent packets need it (see BatchKind).
struct QueryBatch {
  QueryEnds eye, light;
  AlignedVector<std::uint8_t> semantic;  ///< QuerySemantic of each light end
  AlignedVector<std::uint32_t> eye_of, light_of;
  /// What each query would carry if nothing were in the way, over the mean of those asked together: how much a wrong answer matters.
  /// Empty: not known, all alike.
  AlignedVector<float> importance;
  std::size_t size = 0;
  BatchKind kind = BatchKind::shadow_diffuse;
  QuerySplit split = QuerySplit::eye;
  SurfaceEnds surface_ends = SurfaceEnds::area_light;

  void resize_lights(std::size_t n) {
    light.resize(n);
    semantic.resize(padded(n));
  }
  void resize_queries(std::size_t n) {
    size = n;
    eye_of.resize(padded(n)), light_of.resize(padded(n));
  }
};
inline constexpr std::uint32_t kNoQuery = 0xffffffffu;

/// What became of the queries. Rays of a residual are in `traced` too; those that fill maps stand apart.
struct VisibilityCounts {
  static constexpr std::size_t kMaxDepth = 16;
  std::uint64_t queries = 0;                                 ///< asked
  std::uint64_t traced = 0;                                  ///< rays
  std::uint64_t cached = 0;                                  ///< answered without a ray
  std::uint64_t lookups = 0;                                 ///< of a table, neighbours included
  std::uint64_t rejected = 0;                                ///< slots that held another key (digest mismatch)
  std::uint64_t residual = 0;                                ///< rays of the unbiased residual
  std::uint64_t filling = 0;                                 ///< rays that filled maps beforehand or on demand; not of any query
  double filling_seconds = 0;                                ///< spent on them, summed over threads
  std::array<std::uint64_t, kMaxDepth> answered_at_depth{};  ///< cached answers by depth of refinement

  VisibilityCounts& operator+=(const VisibilityCounts& o) {
    queries += o.queries, traced += o.traced, cached += o.cached, lookups += o.lookups, rejected += o.rejected, residual += o.residual;
    filling += o.filling, filling_seconds += o.filling_seconds;
    for (std::size_t d = 0; d < kMaxDepth; ++d) answered_at_depth[d] += o.answered_at_depth[d];
    return *this;
  }
};

}  // namespace sightline
