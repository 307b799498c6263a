// Continuous interpolation of cells of many sizes: the probes of fragments joined by bilinear patches.
#pragma once

#include <array>
#include <cstddef>

#include "methods/fragments/upsample_cells.h"

namespace sightline {

/// Writes the texels of `cell` that lie in the picture; out[c] points to the cell's first texel.
///
/// Along each border between cells runs a piecewise linear curve through nodes: the corners of the cells on both sides and the middle of
/// the smaller one's edge. The value of a node is the mean of the cells that touch it, weighted by 1 / size: linear interpolation across
/// the border. Both sides compute the same curve, so the picture is continuous. Inside the cell each quadrant is a Coons patch between the
/// curve on its two outer edges and the straight lines to the cell's sample in the middle. Among cells of one size, that is bilinear
/// interpolation of the samples. Additional samples at nodes count as much as four cells. Cells on other surfaces are left out of nodes;
/// across a geometric edge each side goes on as constant.
void interpolate_patch(const SignalCells& cells, const Cell& cell, const std::array<float*, 3>& out, std::size_t out_stride);

}  // namespace sightline
