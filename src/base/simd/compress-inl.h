// Storing some lanes side by side.
//
// Included once for each SIMD target, after hwy/foreach_target.h.
#if defined(SIGHTLINE_BASE_SIMD_COMPRESS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_BASE_SIMD_COMPRESS_INL_H_
#undef SIGHTLINE_BASE_SIMD_COMPRESS_INL_H_
#else
#define SIGHTLINE_BASE_SIMD_COMPRESS_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE::lanes {

/// Writes the lanes of `mask` to `to`, and something behind them up to a whole vector; returns how many they are. Unlike Highway's
/// CompressStore on AVX-512, which stores under a mask: a processor cannot hand such a store on to a load that soon follows, which then
/// waits for the cache.
template <class D, class Vec, class Mask>
HWY_INLINE std::size_t compress_store(Vec v, Mask mask, D d, hwy::HWY_NAMESPACE::TFromD<D>* HWY_RESTRICT to) {
  hwy::HWY_NAMESPACE::StoreU(hwy::HWY_NAMESPACE::Compress(v, mask), d, to);
  return hwy::HWY_NAMESPACE::CountTrue(d, mask);
}

}  // namespace sightline::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();

#endif  // SIGHTLINE_BASE_SIMD_COMPRESS_INL_H_
