// Refinement by comparing neighbours, the predecessor of probes inside fragments [Nichols2010, as described in Koa2017].
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/core/context.h"
#include "methods/fragments/centre_test.h"
#include "methods/fragments/reach.h"
#include "methods/fragments/refiner.h"

namespace sightline {

/// A square of the level that is being refined.
struct NicholsCell {
  std::uint64_t mask = 0;  ///< which points of the light its centre sees
  bool known = false;      ///< its centre is a surface to interpolate on
  bool fragment = false;   ///< it is a fragment of this level, not a part of a larger one or cut into smaller ones
};

/// Whether the fragment in the middle of 3 x 3 cells splits: if one of its eight neighbours differs by more than `threshold` points, or by
/// diagonal refinement. That is: where two fragments touch at a corner and differ, the two beside both of them split too.
bool nichols_splits(const std::array<NicholsCell, 9>& cells, int threshold);

/// One light over the whole picture, level by level from the coarsest, with all threads: neighbours may lie in other root tiles.
///
/// All fragments ask the same 64 points, else masks could not be compared; so shadows have bands instead of noise. Each square is asked
/// once a level, whether it is a fragment or only a fragment's neighbour. A pixel of level 0 is its own centre: its mask is its 64 rays,
/// and those count as rays of level 0 while all others are rays of tests.
class NicholsRefiner {
 public:
  static constexpr std::uint32_t kRays = 64;

  NicholsRefiner(const View& view, Visibility& visibility, const FragmentOptions& options, const Context& context);

  /// From now on tests are written to `map`, which must live as long as this.
  void watch(StageMap& map);

  /// Refines the fragments that geometry left, by root tile, and writes `signal`. `writers`, one a thread, know the light and its points;
  /// of these the first set is used.
  RefinementCounts refine(const GBuffer& g, const std::vector<std::vector<Fragment>>& fragments, const AreaLight& light,
                          const LightPoints& points, std::span<const std::unique_ptr<Refiner>> writers, LightSignal& signal,
                          PassStatistics& statistics);

 private:
  /// Buffers of one thread.
  struct Worker {
    CentreTest test;
    ReachPyramid reach;
    std::vector<Fragment> fragments;
    std::vector<std::uint64_t> masks;
    PassStatistics statistics;
    RefinementCounts counts;
  };
  struct Root {
    /// Makes the fragments of a level the current ones: those that waited, and the children of the last.
    void gather(const GBuffer& g, int level);
    std::vector<Fragment> current, next;
    std::array<std::vector<Fragment>, kRootLevel + 1> waiting;  ///< by level
  };
  struct Grid {
    int level = 0, columns = 0, rows = 0;  ///< cells, those without a pixel in the picture left out
    std::size_t stride = 0;
    std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x); }
  };
  template <class Body>
  void for_roots(const GBuffer& g, Body body);
  void cull(const GBuffer& g, std::size_t root, std::span<const Fragment> fragments, const AreaLight& light, const Refiner& writer,
            LightSignal& signal, Worker& worker);
  void begin_level(const GBuffer& g, std::size_t root, const Grid& grid);
  void ask(const GBuffer& g, std::size_t root, const Grid& grid, Worker& worker);
  void map_questions(const GBuffer& g, const Worker& worker, std::span<const Fragment> fragments);
  void split(const GBuffer& g, std::size_t root, const Grid& grid, const Refiner& writer, LightSignal& signal, Worker& worker);
  void finish(const GBuffer& g, std::size_t root, const Refiner& writer, LightSignal& signal, Worker& worker);

  const FragmentOptions& options_;
  const Context& context_;
  std::vector<Worker> workers_;
  std::vector<Root> roots_;
  std::vector<NicholsCell> cells_;
  StageMap* map_ = nullptr;
};

}  // namespace sightline
