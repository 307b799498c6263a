// Whether two points see each other: asked in batches, answered by rays, caches or approximations.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/core/context.h"
#include "base/settings/settings.h"
#include "visibility/query_batch.h"
#include "world/world.h"

namespace sightline {

/// The pass that the following queries belong to: what may be shared within it and must not be mixed up with another's.
struct VisibilityPass {
  std::uint32_t first_sample = 0;  ///< absolute index: salts caches, so that passes are independent
  std::uint32_t frame = 0;         ///< of an animation
};

/// Answers of one thread; the state it keeps between batches belongs to one scope (a tile of a pass).
class VisibilityWorker {
 public:
  virtual ~VisibilityWorker() = default;
  /// Begins scope `scope` of the pass: answers may be shared within it and depend on nothing outside it.
  virtual void begin(std::uint32_t scope) = 0;
  /// Every query of the scope is a ray: who asks may order them as rays trace fastest.
  virtual bool exact() const { return false; }
  /// One answer a query: 0 or 1 where the visibility is binary, else unbiased estimates that may leave [0, 1]. `weights` has at least
  /// padded(queries.size) elements; what lies beyond queries.size may be overwritten.
  virtual void visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) = 0;
};

/// Queries of a whole pass, in three steps with barriers between: answers are shared between all batches of all waves of the pass, and do
/// not depend on the number of threads.
class VisibilityWave {
 public:
  virtual ~VisibilityWave() = default;
  /// Takes in batch `slot`, which must live until resolve(slot). Different slots may be taken in by different threads.
  virtual void look_up(std::size_t slot, const QueryBatch& queries, RayCounts& rays, VisibilityCounts& counts) = 0;
  /// Traces what no slot could answer; for one thread, after all look_up calls. Uses the threads of `context`.
  virtual void trace(const Context& context, RayCounts& rays, VisibilityCounts& counts) = 0;
  /// Answers of batch `slot`, in any thread. `weights` has at least padded(size) elements.
  virtual void resolve(std::size_t slot, std::span<float> weights) = 0;
};

/// Answers queries over one World. Workers and waves may be made and used by many threads; begin_pass is for one thread while none is in
/// use.
class Visibility {
 public:
  virtual ~Visibility() = default;
  virtual bool binary() const { return true; }
  /// Every query is a ray: callers that can trace their own packets may skip the interface.
  virtual bool exact() const { return false; }
  /// Answers in a pass depend on that pass alone. If not, parts of a picture made apart do not add up to the picture made in one go.
  virtual bool passes_are_independent() const { return true; }
  /// Edge of the screen area whose queries may share an answer, in eye samples (C_E): who asks can spread out its first queries.
  virtual float cluster_edge() const { return 1; }
  virtual void begin_pass(const VisibilityPass& pass, const Context& context);
  virtual std::unique_ptr<VisibilityWorker> worker() = 0;
  /// `slots` batches a wave. By default each batch is answered by a worker with the slot as its scope.
  virtual std::unique_ptr<VisibilityWave> wave(std::size_t slots);
  /// Bytes held by tables and maps.
  virtual std::uint64_t memory_bytes() const { return 0; }
};

/// How a visibility is made: name, help, settings, factory.
struct VisibilityInfo {
  std::string name, help, citation;
  bool binary = true;         ///< answers are 0 or 1
  bool unbiased = true;       ///< answers are right in the mean
  bool deterministic = true;  ///< same seed, same answers, whatever the number of threads
  SettingsValue settings;
  std::unique_ptr<Visibility> (*make)(std::shared_ptr<const World> world, const SettingsValue& settings, const Context& context);
  /// Bytes of tables that it will have with these settings, whatever the scene; null: none, or what the memory budget leaves.
  std::uint64_t (*table_bytes)(const SettingsValue& settings, const Context& context) = nullptr;
};

/// The explicit table; names are unique.
const std::vector<VisibilityInfo>& visibilities();
const VisibilityInfo& find_visibility(std::string_view name);  ///< Error{usage} with the nearest name

}  // namespace sightline
