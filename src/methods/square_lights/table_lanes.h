// The arithmetic of many tables at once: distances, projections, sums.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "methods/square_lights/distance_table.h"

namespace sightline::square_lights {

/// Squared distances of a table from `count` points of kTableCells floats each.
void table_distances(const std::int8_t* table, const float* points, std::size_t count, float* distances);
/// Dot products of (table - mean) with `count` vectors of kTableCells floats each; returns its squared length.
float project_table(const std::int8_t* table, const float* mean, const float* vectors, std::size_t count, float* dots);
/// Adds dots[j] * (table - mean) to each of `count` vectors.
void add_projected(const std::int8_t* table, const float* mean, const float* dots, std::size_t count, float* vectors);
/// Codes nearest to the sum of components[0] and weights[j] * components[1 + j], all binary16.
void expand_table(const std::uint16_t* components, const float* weights, std::size_t count, std::int8_t* table);

}  // namespace sightline::square_lights
