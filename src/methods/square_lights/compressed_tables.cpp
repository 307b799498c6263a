#include "methods/square_lights/compressed_tables.h"

#include <algorithm>
#include <cassert>

#include "base/core/error.h"
#include "base/parallel/parallel.h"
#include "methods/square_lights/binary16.h"
#include "methods/square_lights/table_clusters.h"
#include "methods/square_lights/table_lanes.h"

namespace sightline::square_lights {
namespace {

constexpr std::size_t kExpandedAtOnce = 256;

}  // namespace

CompressedTables CompressedTables::store(std::span<const std::int8_t> tables, const TableClusters& clusters, std::size_t vectors,
                                         const Context& context) {
  CompressedTables result;
  result.vectors_ = static_cast<int>(vectors);
  result.cluster_ = clusters.cluster;
  result.components_.resize(clusters.components.size() * (1 + vectors) * kTableCells);
  result.weights_.resize(clusters.cluster.size() * vectors);
  // Weights are found for what is stored: rounded means and vectors.
  const std::size_t stride = (1 + vectors) * kTableCells;
  AlignedVector<float> rounded(result.components_.size());
  parallel_for(context, clusters.components.size(), 1, [&](std::size_t k, std::size_t) {
    const Components& from = clusters.components[k];
    for (std::size_t i = 0; i < stride; ++i) {
      const float value = i < kTableCells ? from.mean[i] : from.vectors[i - kTableCells];
      const std::uint16_t half = half_from_float(value);
      result.components_[k * stride + i] = half;
      rounded[k * stride + i] = float_from_half(half);
    }
  });
  parallel_for(context, result.count(), kExpandedAtOnce, [&](std::size_t begin, std::size_t end) {
    AlignedVector<float> weights(vectors + 1);
    for (std::size_t i = begin; i < end; ++i) {
      const float* const mean = rounded.data() + result.cluster_[i] * stride;
      project_table(tables.data() + i * kTableCells, mean, mean + kTableCells, vectors, weights.data());
      for (std::size_t j = 0; j < vectors; ++j) result.weights_[i * vectors + j] = half_from_float(weights[j]);
    }
  });
  return result;
}

CompressedTables CompressedTables::cluster(std::span<const std::int8_t> tables, std::size_t count, const CompressionOptions& options,
                                           const Context& context) {
  tables = tables.first(count * kTableCells);
  return store(tables, cluster_tables(tables, options, context), static_cast<std::size_t>(std::max(options.vectors, 0)), context);
}

CompressedTables CompressedTables::groups(std::span<const std::int8_t> tables, std::span<const std::uint16_t> group, int groups,
                                          int vectors, const Context& context) {
  assert(std::all_of(group.begin(), group.end(), [groups](std::uint16_t g) { return g < groups; }));
  tables = tables.first(group.size() * kTableCells);
  const auto vector_count = static_cast<std::size_t>(std::max(vectors, 0));
  return store(tables, fit_groups(tables, group, static_cast<std::size_t>(groups), vector_count, context), vector_count, context);
}

std::uint64_t CompressedTables::bytes() const { return (cluster_.size() + weights_.size() + components_.size()) * sizeof(std::uint16_t); }

void CompressedTables::expand(std::size_t i, std::span<std::int8_t, kTableCells> table) const {
  const auto vectors = static_cast<std::size_t>(vectors_);
  std::array<float, kMostVectors> weights;
  for (std::size_t j = 0; j < vectors; ++j) weights[j] = float_from_half(weights_[i * vectors + j]);
  expand_table(components_.data() + cluster_[i] * (1 + vectors) * kTableCells, weights.data(), vectors, table.data());
}

double CompressedTables::squared_error(std::span<const std::int8_t> tables, const Context& context) const {
  const std::size_t chunks = (count() + kExpandedAtOnce - 1) / kExpandedAtOnce;
  std::vector<double> sums(chunks, 0);
  parallel_for(context, count(), kExpandedAtOnce, [&](std::size_t begin, std::size_t end) {
    std::array<std::int8_t, kTableCells> table;
    for (std::size_t i = begin; i < end; ++i) {
      expand(i, table);
      std::int64_t sum = 0;
      for (std::size_t c = 0; c < kTableCells; ++c) {
        const int difference = table[c] - tables[i * kTableCells + c];
        sum += difference * difference;
      }
      sums[begin / kExpandedAtOnce] += static_cast<double>(sum);
    }
  });
  double sum = 0;
  for (const double s : sums) sum += s;
  return sum;
}

CompressedTables CompressedTables::from_arrays(std::span<const std::uint16_t> cluster, std::span<const std::uint16_t> weights,
                                               std::span<const std::uint16_t> components, int vectors) {
  // Arrays of a file are checked once, so that look-ups need not be.
  if (vectors < 0 || static_cast<std::size_t>(vectors) > kMostVectors) throw input_error("compressed tables have too many vectors");
  const auto vector_count = static_cast<std::size_t>(vectors);
  const std::size_t stride = (1 + vector_count) * kTableCells, clusters = components.size() / stride;
  if (components.size() % stride != 0 || weights.size() != cluster.size() * vector_count)
    throw input_error("the arrays of compressed tables do not fit each other");
  if (std::any_of(cluster.begin(), cluster.end(), [clusters](std::uint16_t k) { return k >= clusters; }))
    throw input_error("compressed tables name a cluster that is not there");
  CompressedTables result;
  result.vectors_ = vectors;
  result.cluster_.assign(cluster.begin(), cluster.end());
  result.weights_.assign(weights.begin(), weights.end());
  result.components_.assign(components.begin(), components.end());
  return result;
}

}  // namespace sightline::square_lights
