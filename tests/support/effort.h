// How long statistical tests sample. Sanitizers make them ten times slower, and look for other mistakes.
#pragma once

namespace sightline::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
/// Samples are divided by this, and bounds on their standard errors multiplied by kCoarser.
inline constexpr int kFewer = 4;
#else
inline constexpr int kFewer = 1;
#endif
inline constexpr double kCoarser = kFewer == 4 ? 2 : 1;

}  // namespace sightline::test
