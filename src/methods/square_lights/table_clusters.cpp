#include "methods/square_lights/table_clusters.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <limits>
#include <numeric>
#include <random>

#include "base/parallel/parallel.h"
#include "methods/square_lights/table_lanes.h"

namespace sightline::square_lights {
namespace {

constexpr int kMeansRounds = 10;
// Sweeps of subspace iteration from nothing, and from the vectors of the last round.
constexpr int kFirstSweeps = 12, kLaterSweeps = 6;
// Clusters that a table may go to after the first round: those of the nearest means.
constexpr std::size_t kNear = 16;
// k-means++ looks at this many tables for each cluster, spread over all.
constexpr std::size_t kSeedsPerCluster = 16;
constexpr std::size_t kAssignedAtOnce = 64;

using Tables = std::span<const std::int8_t>;
const std::int8_t* table_of(Tables tables, std::size_t i) { return tables.data() + i * kTableCells; }

/// Steps done of all, whatever they are steps of.
class Steps {
 public:
  Steps(const Context& context, double total) : context_(context), total_(total) {}
  void done(double steps) {
    done_ += steps;
    context_.report("compressing tables", done_, total_);
  }

 private:
  const Context& context_;
  double done_ = 0, total_;
};

/// First means: tables far from each other, drawn by squared distance from those drawn before (k-means++).
AlignedVector<float> first_means(Tables tables, std::size_t clusters, std::uint64_t seed, const Context& context) {
  const std::size_t count = tables.size() / kTableCells;
  const std::size_t step = std::max<std::size_t>(1, count / (clusters * kSeedsPerCluster));
  const std::size_t candidates = (count + step - 1) / step;
  std::mt19937_64 random(seed);
  std::vector<double> distance(candidates, std::numeric_limits<double>::infinity());
  AlignedVector<float> means(clusters * kTableCells);
  std::size_t chosen = random() % candidates;
  for (std::size_t k = 0; k < clusters; ++k) {
    float* const mean = means.data() + k * kTableCells;
    std::copy_n(table_of(tables, chosen * step), kTableCells, mean);
    parallel_for(context, candidates, kAssignedAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        float d;
        table_distances(table_of(tables, i * step), mean, 1, &d);
        distance[i] = std::min(distance[i], static_cast<double>(d));
      }
    });
    distance[chosen] = -1;  // never twice
    double all = 0;
    for (const double d : distance) all += std::max(d, 0.0);
    // Where all that is left has been drawn already, the first that has not.
    double left = static_cast<double>(random() >> 11) * 0x1p-53 * all;
    chosen = candidates;
    for (std::size_t i = 0; i < candidates; ++i) {
      if (distance[i] < 0) continue;
      if (chosen == candidates || left > 0) chosen = i;
      left -= distance[i];
      if (left <= 0 && all > 0 && distance[i] > 0) break;
      if (all == 0) break;
    }
    if (chosen == candidates) chosen = 0;
  }
  return means;
}

std::vector<std::vector<std::uint32_t>> members_of(std::span<const std::uint16_t> cluster, std::size_t clusters) {
  std::vector<std::vector<std::uint32_t>> members(clusters);
  for (std::size_t i = 0; i < cluster.size(); ++i) members[cluster[i]].push_back(static_cast<std::uint32_t>(i));
  return members;
}

/// Gives each empty cluster the table that fits its own worst.
void fill_empty(std::vector<std::uint16_t>& cluster, std::vector<float>& misfit, std::size_t clusters) {
  std::vector<std::size_t> size(clusters, 0);
  for (const std::uint16_t k : cluster) ++size[k];
  std::vector<std::uint32_t> worst;
  std::size_t next = 0;
  for (std::size_t k = 0; k < clusters; ++k) {
    if (size[k] > 0) continue;
    if (worst.empty()) {
      worst.resize(cluster.size());
      std::iota(worst.begin(), worst.end(), 0u);
      std::stable_sort(worst.begin(), worst.end(), [&](std::uint32_t a, std::uint32_t b) { return misfit[a] > misfit[b]; });
    }
    while (next < worst.size() && size[cluster[worst[next]]] < 2) ++next;
    if (next == worst.size()) return;
    --size[cluster[worst[next]]];
    cluster[worst[next]] = static_cast<std::uint16_t>(k), misfit[worst[next]] = 0;
    ++size[k], ++next;
  }
}

/// Lloyd's iteration. Returns the cluster of each table.
std::vector<std::uint16_t> k_means(Tables tables, AlignedVector<float>& means, Steps& steps, const Context& context) {
  const std::size_t count = tables.size() / kTableCells, clusters = means.size() / kTableCells;
  std::vector<std::uint16_t> cluster(count, 0);
  std::vector<float> misfit(count);
  for (int round = 0; round < kMeansRounds; ++round) {
    std::atomic<bool> changed{round == 0};
    parallel_for(context, count, kAssignedAtOnce, [&](std::size_t begin, std::size_t end) {
      AlignedVector<float> distances(clusters);
      for (std::size_t i = begin; i < end; ++i) {
        table_distances(table_of(tables, i), means.data(), clusters, distances.data());
        const auto nearest = std::min_element(distances.begin(), distances.end());
        const auto k = static_cast<std::uint16_t>(nearest - distances.begin());
        misfit[i] = *nearest;
        if (k != cluster[i]) changed = true;
        cluster[i] = k;
      }
    });
    fill_empty(cluster, misfit, clusters);
    const auto members = members_of(cluster, clusters);
    parallel_for(context, clusters, 1, [&](std::size_t k, std::size_t) {
      Components mean;
      fit_components(tables, members[k], 0, 0, mean);
      std::copy(mean.mean.begin(), mean.mean.end(), means.begin() + static_cast<std::ptrdiff_t>(k * kTableCells));
    });
    steps.done(1);
    if (!changed) {
      steps.done(kMeansRounds - 1 - round);
      break;
    }
  }
  return cluster;
}

/// What the cluster's components leave of a table: squared length of its offset from the mean less that of its projection.
float residual(const std::int8_t* table, const Components& components, std::size_t vectors, float* dots) {
  float left = project_table(table, components.mean.data(), components.vectors.data(), vectors, dots);
  for (std::size_t j = 0; j < vectors; ++j) left -= dots[j] * dots[j];
  return left;
}

/// Each table to the cluster that fits it best: of all, or of its own and those with the nearest means.
void assign(Tables tables, bool all, std::size_t vectors, TableClusters& result, const Context& context) {
  const std::size_t count = tables.size() / kTableCells, clusters = result.components.size();
  AlignedVector<float> means(clusters * kTableCells);
  for (std::size_t k = 0; k < clusters; ++k)
    std::copy(result.components[k].mean.begin(), result.components[k].mean.end(),
              means.begin() + static_cast<std::ptrdiff_t>(k * kTableCells));
  std::vector<float> misfit(count);
  parallel_for(context, count, kAssignedAtOnce, [&](std::size_t begin, std::size_t end) {
    AlignedVector<float> distances(clusters), dots(vectors + 1);
    std::vector<std::size_t> order(clusters);
    for (std::size_t i = begin; i < end; ++i) {
      const std::int8_t* const table = table_of(tables, i);
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::size_t tried = clusters;
      if (!all && clusters > kNear) {
        table_distances(table, means.data(), clusters, distances.data());
        tried = kNear;
        std::partial_sort(order.begin(), order.begin() + kNear, order.end(), [&](std::size_t a, std::size_t b) {
          return distances[a] < distances[b] || (distances[a] == distances[b] && a < b);
        });
      }
      // The own cluster is left only for a better one, so that no round makes the fit worse.
      std::uint16_t best = result.cluster[i];
      float least = residual(table, result.components[best], vectors, dots.data());
      for (std::size_t n = 0; n < tried; ++n) {
        if (order[n] == result.cluster[i]) continue;
        const float left = residual(table, result.components[order[n]], vectors, dots.data());
        if (left < least) least = left, best = static_cast<std::uint16_t>(order[n]);
      }
      result.cluster[i] = best, misfit[i] = least;
    }
  });
  fill_empty(result.cluster, misfit, clusters);
}

void update(Tables tables, std::size_t vectors, int sweeps, TableClusters& result, const Context& context) {
  const auto members = members_of(result.cluster, result.components.size());
  // The largest first, or the last one to start would be waited for.
  std::vector<std::size_t> order(members.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return members[a].size() > members[b].size(); });
  parallel_for(context, order.size(), 1, [&](std::size_t n, std::size_t) {
    fit_components(tables, members[order[n]], vectors, sweeps, result.components[order[n]]);
  });
}

}  // namespace

TableClusters cluster_tables(Tables tables, const CompressionOptions& options, const Context& context) {
  const std::size_t count = tables.size() / kTableCells, vectors = static_cast<std::size_t>(std::max(options.vectors, 0));
  TableClusters result;
  if (count == 0) return result;
  const std::size_t clusters = std::min({static_cast<std::size_t>(std::max(options.clusters, 1)), count, std::size_t{65535}});
  Steps steps(context, kMeansRounds + 4.0 * (options.iterations + 1));
  AlignedVector<float> means = first_means(tables, clusters, options.seed, context);
  result.cluster = k_means(tables, means, steps, context);
  result.components.resize(clusters);
  update(tables, vectors, kFirstSweeps, result, context);
  steps.done(4);
  for (int round = 0; round < options.iterations; ++round) {
    assign(tables, round == 0, vectors, result, context);
    update(tables, vectors, kLaterSweeps, result, context);
    steps.done(4);
  }
  return result;
}

TableClusters fit_groups(Tables tables, std::span<const std::uint16_t> group, std::size_t groups, std::size_t vectors,
                         const Context& context) {
  TableClusters result;
  result.cluster.assign(group.begin(), group.end());
  result.components.resize(groups);
  const auto members = members_of(group, groups);
  std::atomic<std::size_t> done{0};
  parallel_for(context, groups, 1, [&](std::size_t k, std::size_t) {
    fit_components(tables, members[k], vectors, kFirstSweeps, result.components[k]);
    context.report("compressing tables", static_cast<double>(++done), static_cast<double>(groups));
  });
  return result;
}

}  // namespace sightline::square_lights
