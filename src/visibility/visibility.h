// Whether two points see each other: asked in batches, answered by rays, caches or approximations.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/settings/settings.h"
#include "trace/ray_batch.h"
#include "world/world.h"

namespace sightline {

/// What the far end of a query is: decides how a cache may share the answer.
enum class QuerySemantic : std::uint8_t { surface, point, direction, solid_angle };

/// Does X see Y (or infinity along direction Y)? Cell areas say how large a patch may share the answer: 0 = none, an exact answer.
struct Query {
  Vec3 x{0}, x_normal{0};
  float x_error = 0;       ///< absolute error bound of x
  float x_cell_area = 0;   ///< world units², on the surface
  Vec3 y{0}, y_normal{0};  ///< point, or unit direction for direction and solid_angle
  float y_error = 0;
  float y_cell_area = 0;  ///< world units², or steradians for solid_angle
  QuerySemantic semantic = QuerySemantic::surface;
  std::uint32_t id = 0;  ///< order of queries: makes shared answers independent of threads
};

struct VisibilityCounts {
  std::uint64_t queries = 0, traced = 0, cached = 0;
  VisibilityCounts& operator+=(const VisibilityCounts& o) {
    queries += o.queries, traced += o.traced, cached += o.cached;
    return *this;
  }
};

/// Answers queries over one World. `weights` are 0 or 1 where binary(), else unbiased estimates that may leave [0, 1].
class Visibility {
 public:
  virtual ~Visibility() = default;
  virtual void visible(std::span<const Query> queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) const = 0;
  virtual bool binary() const = 0;
};

/// How a visibility is made: name, help, settings, factory.
struct VisibilityInfo {
  std::string name, help;
  SettingsValue settings;
  std::unique_ptr<Visibility> (*make)(std::shared_ptr<const World> world, const SettingsValue& settings);
};

/// The explicit table; names are unique.
const std::vector<VisibilityInfo>& visibilities();
const VisibilityInfo& find_visibility(std::string_view name);  ///< Error{usage} with the nearest name

}  // namespace sightline
