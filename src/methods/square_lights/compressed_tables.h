// Distance tables as a few numbers each: clustered principal components.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/core/aligned.h"
#include "base/core/context.h"
#include "methods/square_lights/distance_table.h"

namespace sightline::square_lights {

struct TableClusters;

inline constexpr std::size_t kMostVectors = 64;

struct CompressionOptions {
  int clusters = 256;
  int vectors = 8;  ///< n': eigenvectors a cluster; at most kMostVectors
  int iterations = 4;
  std::uint64_t seed = 0;
};

/// D = mean of the cluster + sum of weights times eigenvectors [Sloan2003], all numbers 16-bit floats.
class CompressedTables {
 public:
  /// Clusters and components of `count` tables (CPCA). The same for any number of threads.
  static CompressedTables cluster(std::span<const std::int8_t> tables, std::size_t count, const CompressionOptions& options,
                                  const Context& context);
  /// Principal components of groups fixed beforehand: group[i] < groups for every table.
  static CompressedTables groups(std::span<const std::int8_t> tables, std::span<const std::uint16_t> group, int groups, int vectors,
                                 const Context& context);

  std::size_t count() const { return cluster_.size(); }
  int vectors() const { return vectors_; }
  std::uint64_t bytes() const;
  /// The table as codes, for look-ups like those of raw ones.
  void expand(std::size_t i, std::span<std::int8_t, kTableCells> table) const;
  /// Sum of squared differences of codes from the tables given to cluster() or groups().
  double squared_error(std::span<const std::int8_t> tables, const Context& context) const;

  /// The arrays, for files.
  std::span<const std::uint16_t> cluster_of() const { return cluster_; }
  std::span<const std::uint16_t> weights() const { return weights_; }        ///< [table][vector], binary16
  std::span<const std::uint16_t> components() const { return components_; }  ///< [cluster][1 + vectors][cell], binary16
  /// Throws Error{input} where they do not fit each other.
  static CompressedTables from_arrays(std::span<const std::uint16_t> cluster, std::span<const std::uint16_t> weights,
                                      std::span<const std::uint16_t> components, int vectors);

 private:
  static CompressedTables store(std::span<const std::int8_t> tables, const TableClusters& clusters, std::size_t vectors,
                                const Context& context);

  int vectors_ = 0;
  std::vector<std::uint16_t> cluster_;
  AlignedVector<std::uint16_t> weights_, components_;
};

}  // namespace sightline::square_lights
