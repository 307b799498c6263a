// Which instruction sets Highway kernels are compiled for. Included before hwy/foreach_target.h by every kernel file.
//
// The floor is SSSE3 (the baseline of x86-64-v2), then AVX2 and AVX-512. SSE4 in between would cost compile time for nearly no CPU.
#ifndef SIGHTLINE_BASE_SIMD_TARGETS_H_
#define SIGHTLINE_BASE_SIMD_TARGETS_H_

#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS HWY_SSE4
#endif

#endif  // SIGHTLINE_BASE_SIMD_TARGETS_H_
