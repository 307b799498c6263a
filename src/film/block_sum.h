// Exact sums over the samples of 16 pixels at once: the fast way into ExactSum for values of ordinary size.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/core/aligned.h"

namespace sightline {

/// Samples that may be summed in one go without leaving 64 bits.
inline constexpr std::size_t kMaxBlockSamples = 128;
/// The sums are integers in units of 2^-kBlockSumBits.
inline constexpr int kBlockSumBits = 40;

/// sums[lane] = the sum of values[16 s + lane] over all `count` <= kMaxBlockSamples samples s. False, with undefined sums, if a value is
/// neither 0 nor in [2^-16, 2^15), for which the sum would not be exact; non-finite values are among those. `values` 64-byte aligned.
bool sum_block(const float* values, std::size_t count, std::int64_t* sums);

}  // namespace sightline
