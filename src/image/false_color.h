// Numbers as colours, for pictures of errors.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math/vec.h"

namespace sightline {

/// Black over violet, red and orange to pale yellow for t from 0 to 1 (clamped); luma rises all the way, so it survives a grey print.
/// sRGB-encoded.
Color false_color(float t);
/// One interleaved 8-bit RGB triple a value: `low` is black, `high` pale yellow; NaN is green, which the map does not contain.
std::vector<std::uint8_t> false_color(std::span<const float> values, float low = 0, float high = 1);

}  // namespace sightline
