// Upsampling level by level, coarse to fine [Nichols2010].
#pragma once

#include <span>

#include "methods/fragments/upsample_cells.h"

namespace sightline {

/// Writes the tile as upsample() does. The image of level l holds the samples of cells of 2^l pixels; where cells are coarser, it is the
/// image of level l + 1, bilinearly interpolated with weights renormalised over the texels that have a value; where they are finer, it has
/// none. The image of level 0 is the result. As in the paper, geometry does not matter here, nor do additional samples.
void upsample_levels(const SignalCells& cells, const RootTile& tile, std::span<float* const> out);

}  // namespace sightline
