// Which samples a cell's texels are interpolated from by radial basis functions.
#pragma once

#include <array>
#include <cstddef>

#include "methods/fragments/upsample_cells.h"
#include "methods/fragments/upsample_rbf.h"

namespace sightline {

/// Writes the texels of `cell` that lie in the picture; out[c] points to the cell's first texel.
///
/// Each quadrant of the cell has two edges in common with it. A texel takes the nearest sample on either: additional samples on the edge
/// itself, and the samples of cells across it [Koa2017, §3.6]. With `corners`, also the nearest at the corner where the edges meet, so
/// that equal cells make sets of four around each corner.
void interpolate_nearest(const SignalCells& cells, const Cell& cell, bool adaptive, bool corners, const std::array<float*, 3>& out,
                         std::size_t out_stride);

/// The same with the corners of the texel's quadrant as samples: the cell's centre, the middles of two edges, and its corner. Both sides
/// of an edge use the same two samples, so that little is to be seen of it.
void interpolate_corners(const SignalCells& cells, const Cell& cell, bool adaptive, const std::array<float*, 3>& out,
                         std::size_t out_stride);

/// Sets the texels of `cell` that lie in the picture to `value`.
void fill_cell(const SignalCells& cells, const Cell& cell, const std::array<float, 3>& value, const std::array<float*, 3>& out,
               std::size_t out_stride);

}  // namespace sightline
