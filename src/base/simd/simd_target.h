// Which instruction set the Highway kernels run on in this process.
#pragma once

#include <string>
#include <string_view>

namespace sightline {

/// Name of the target in use: "SSSE3", "AVX2" or "AVX3".
std::string simd_target();
/// Pins the target (before anything else runs). Throws Error{usage} for a name that is unknown or that this CPU lacks.
void pin_simd_target(std::string_view name);

}  // namespace sightline
