#include "methods/fragments/nichols_refiner.h"

#include <algorithm>
#include <bit>

#include "base/core/stopwatch.h"
#include "base/parallel/parallel.h"

namespace sightline {
namespace {

bool differ(const NicholsCell& a, const NicholsCell& b, int threshold) {
  return a.known && b.known && std::popcount(a.mask ^ b.mask) > threshold;
}

}  // namespace

bool nichols_splits(const std::array<NicholsCell, 9>& cells, int threshold) {
  const NicholsCell& middle = cells[4];
  if (std::ranges::any_of(cells, [&](const NicholsCell& other) { return differ(middle, other, threshold); })) return true;
  // Cells left and above of it touch at a corner, and so on.
  for (const std::size_t column : {3u, 5u}) {
    for (const std::size_t row : {1u, 7u}) {
      if ((cells[column].fragment || cells[row].fragment) && differ(cells[column], cells[row], threshold)) return true;
    }
  }
  return false;
}

NicholsRefiner::NicholsRefiner(const View& view, Visibility& visibility, const FragmentOptions& options, const Context& context)
    : options_(options), context_(context) {
  for (int i = 0; i < context.thread_count(); ++i) workers_.push_back({CentreTest(view, visibility), {}, {}, {}, {}, {}});
}

void NicholsRefiner::watch(StageMap& map) {
  map_ = &map;
  for (Worker& worker : workers_) worker.test.count_questions();
}

void NicholsRefiner::map_questions(const GBuffer& g, const Worker& worker, std::span<const Fragment> fragments) {
  for (std::size_t i = 0; map_->wants_rays() && i < fragments.size(); ++i) map_->add_rays(g, fragments[i], worker.test.asked()[i]);
}

template <class Body>
void NicholsRefiner::for_roots(const GBuffer& g, Body body) {
  parallel_for(context_, g.root_count(), 1, [&](std::size_t begin, std::size_t end) {
    const Stopwatch stopwatch;
    const std::size_t thread = static_cast<std::size_t>(worker_index()) % workers_.size();
    for (std::size_t root = begin; root < end; ++root) body(root, thread);
    workers_[thread].statistics.stage_seconds["visibility"] += stopwatch.seconds();
  });
}

RefinementCounts NicholsRefiner::refine(const GBuffer& g, const std::vector<std::vector<Fragment>>& fragments, const AreaLight& light,
                                        const LightPoints& points, std::span<const std::unique_ptr<Refiner>> writers, LightSignal& signal,
                                        PassStatistics& statistics) {
  for (Worker& worker : workers_) {
    worker.test.set_light(light, points);
    worker.statistics = {}, worker.counts = {};
  }
  roots_.resize(g.root_count());
  for_roots(
      g, [&](std::size_t root, std::size_t thread) { cull(g, root, fragments[root], light, *writers[thread], signal, workers_[thread]); });
  for (int level = options_.geometry.coarsest; level > 0; --level) {
    const int w = 1 << level;
    const Grid grid{level, (g.width + w - 1) / w, (g.height + w - 1) / w, static_cast<std::size_t>(g.stride / w)};
    cells_.assign(grid.stride * static_cast<std::size_t>(g.rows / w), {});
    for_roots(g, [&](std::size_t root, std::size_t) { begin_level(g, root, grid); });
    for_roots(g, [&](std::size_t root, std::size_t thread) { ask(g, root, grid, workers_[thread]); });
    for_roots(g, [&](std::size_t root, std::size_t thread) { split(g, root, grid, *writers[thread], signal, workers_[thread]); });
  }
  for_roots(g, [&](std::size_t root, std::size_t thread) { finish(g, root, *writers[thread], signal, workers_[thread]); });

  RefinementCounts counts;
  for (const Worker& worker : workers_) {
    statistics += worker.statistics;
    counts.fragments += worker.counts.fragments, counts.finest += worker.counts.finest;
    counts.test_rays += worker.counts.test_rays, counts.finest_rays += worker.counts.finest_rays;
  }
  return counts;
}

// What the light cannot reach is done; what it reaches in part is cut until it does in full.
void NicholsRefiner::cull(const GBuffer& g, std::size_t root, std::span<const Fragment> fragments, const AreaLight& light,
                          const Refiner& writer, LightSignal& signal, Worker& worker) {
  const RootTile tile = g.root(root);
  writer.clear(g, tile, signal);
  worker.reach.build(g, tile, light);
  worker.fragments.assign(fragments.begin(), fragments.end());
  Root& own = roots_[root];
  own.next.clear();
  for (auto& waiting : own.waiting) waiting.clear();
  for (std::size_t i = 0; i < worker.fragments.size(); ++i) {
    const Fragment f = worker.fragments[i];
    if (f.x >= g.width || f.y >= g.height) continue;
    const ReachPyramid::Reach reach = worker.reach.of(f);
    if (reach == ReachPyramid::Reach::mixed) {
      subdivide(f, 0, worker.fragments);
    } else if (reach == ReachPyramid::Reach::none) {
      writer.write_level(g, f, LightSignal::kUnlit, signal), writer.write_constant(g, f, 0, signal);
      ++worker.counts.fragments;
    } else {
      own.waiting[f.level].push_back(f);
    }
  }
}

void NicholsRefiner::Root::gather(const GBuffer& g, int level) {
  current = waiting[static_cast<std::size_t>(level)];
  for (const Fragment& f : next) {
    if (f.x < g.width && f.y < g.height) current.push_back(f);
  }
  next.clear();
}

void NicholsRefiner::begin_level(const GBuffer& g, std::size_t root, const Grid& grid) {
  Root& own = roots_[root];
  own.gather(g, grid.level);
  for (const Fragment& f : own.current) cells_[grid.at(f.x >> grid.level, f.y >> grid.level)].fragment = true;
}

// Fragments of the level and their neighbours.
void NicholsRefiner::ask(const GBuffer& g, std::size_t root, const Grid& grid, Worker& worker) {
  const RootTile tile = g.root(root);
  const auto wanted = [&](int x, int y) {
    for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, grid.rows - 1); ++ny) {
      for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, grid.columns - 1); ++nx) {
        if (cells_[grid.at(nx, ny)].fragment) return true;
      }
    }
    return false;
  };
  worker.fragments.clear();
  for (int y = tile.y0 >> grid.level; y << grid.level < tile.y1; ++y) {
    for (int x = tile.x0 >> grid.level; x << grid.level < tile.x1; ++x) {
      const Fragment f{static_cast<std::uint16_t>(x << grid.level), static_cast<std::uint16_t>(y << grid.level),
                       static_cast<std::uint8_t>(grid.level)};
      const IVec2 pixel = centre_pixel(g, f);
      const PixelKind kind = g.kind[g.at(pixel.x, pixel.y)];
      if ((kind == PixelKind::diffuse || kind == PixelKind::analytic) && wanted(x, y)) worker.fragments.push_back(f);
    }
  }
  const std::uint64_t before = worker.statistics.rays.occlusion;
  worker.test.begin(static_cast<std::uint32_t>(root));
  worker.test.test(g, worker.fragments, worker.masks, worker.statistics);
  worker.counts.test_rays += worker.statistics.rays.occlusion - before;
  if (map_) map_questions(g, worker, worker.fragments);
  for (std::size_t i = 0; i < worker.fragments.size(); ++i) {
    NicholsCell& cell = cells_[grid.at(worker.fragments[i].x >> grid.level, worker.fragments[i].y >> grid.level)];
    cell.mask = worker.masks[i], cell.known = true;
  }
}

void NicholsRefiner::split(const GBuffer& g, std::size_t root, const Grid& grid, const Refiner& writer, LightSignal& signal,
                           Worker& worker) {
  Root& own = roots_[root];
  for (const Fragment& f : own.current) {
    const int x = f.x >> grid.level, y = f.y >> grid.level;
    std::array<NicholsCell, 9> cells;
    for (int i = 0; i < 9; ++i) {
      const int nx = x + i % 3 - 1, ny = y + i / 3 - 1;
      if (nx >= 0 && ny >= 0 && nx < grid.columns && ny < grid.rows) cells[static_cast<std::size_t>(i)] = cells_[grid.at(nx, ny)];
    }
    if (map_ && map_->wants_gradients()) {
      int steepest = 0;
      for (const NicholsCell& other : cells)
        steepest = std::max(steepest, other.known && cells[4].known ? std::popcount(other.mask ^ cells[4].mask) : 0);
      map_->set_gradient(g, f, static_cast<float>(steepest) / static_cast<float>(kRays));
    }
    if (nichols_splits(cells, options_.nichols_threshold)) {
      subdivide(f, 0, own.next);
      continue;
    }
    writer.write_level(g, f, 0, signal);
    writer.write_centre(g, f, cells[4].mask, signal);
    ++worker.counts.fragments;
  }
}

void NicholsRefiner::finish(const GBuffer& g, std::size_t root, const Refiner& writer, LightSignal& signal, Worker& worker) {
  Root& own = roots_[root];
  own.gather(g, 0);
  const std::uint64_t before = worker.statistics.rays.occlusion;
  worker.test.begin(static_cast<std::uint32_t>(root));
  worker.test.test(g, own.current, worker.masks, worker.statistics);
  worker.counts.finest_rays += worker.statistics.rays.occlusion - before;
  if (map_) map_questions(g, worker, own.current);
  for (std::size_t i = 0; i < own.current.size(); ++i) {
    writer.write_level(g, own.current[i], 0, signal);
    writer.write_centre(g, own.current[i], worker.masks[i], signal);
  }
  worker.counts.fragments += own.current.size(), worker.counts.finest += own.current.size();
}

}  // namespace sightline
