// Groups of similar tables, each near a few directions through its mean.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/core/context.h"
#include "methods/square_lights/components.h"
#include "methods/square_lights/compressed_tables.h"

namespace sightline::square_lights {

struct TableClusters {
  std::vector<std::uint16_t> cluster;  ///< of each table
  std::vector<Components> components;  ///< of each cluster
};

/// Clustered principal components [Sloan2003]: k-means, then in turn the components of each cluster and the cluster of each table by what
/// its components leave over.
TableClusters cluster_tables(std::span<const std::int8_t> tables, const CompressionOptions& options, const Context& context);
/// The components of clusters that are given.
TableClusters fit_groups(std::span<const std::int8_t> tables, std::span<const std::uint16_t> group, std::size_t groups, std::size_t vectors,
                         const Context& context);

}  // namespace sightline::square_lights
