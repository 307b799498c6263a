// Vectors of three for Highway kernels: V3 holds x, y and z of as many lanes as the target has, up to kLanes.
//
// Included once for each SIMD target, after hwy/foreach_target.h. Nothing here fuses multiplication and addition unless its name says so,
// so that scalar code can repeat it bit for bit.
#if defined(SIGHTLINE_BASE_SIMD_VEC3_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_BASE_SIMD_VEC3_INL_H_
#undef SIGHTLINE_BASE_SIMD_VEC3_INL_H_
#else
#define SIGHTLINE_BASE_SIMD_VEC3_INL_H_
#endif

#include <hwy/highway.h>

#include "base/core/aligned.h"
#include "base/math/vec.h"
#include "base/simd/compress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE::lanes {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kLanes>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

struct V3 {
  V x, y, z;
};

HWY_INLINE V3 set3(D d, const Vec3& v) { return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)}; }
/// Element i in all lanes.
HWY_INLINE V3 set3(D d, const Vec3Batch& b, std::size_t i) { return {hn::Set(d, b.x[i]), hn::Set(d, b.y[i]), hn::Set(d, b.z[i])}; }
HWY_INLINE V3 load3(D d, const Vec3Batch& b, std::size_t i) {
  return {hn::LoadU(d, b.x.data() + i), hn::LoadU(d, b.y.data() + i), hn::LoadU(d, b.z.data() + i)};
}
HWY_INLINE V3 gather3(D d, const Vec3Batch& b, hn::Vec<DI> index) {
  return {hn::GatherIndex(d, b.x.data(), index), hn::GatherIndex(d, b.y.data(), index), hn::GatherIndex(d, b.z.data(), index)};
}
HWY_INLINE void store3(D d, const V3& v, Vec3Batch& b, std::size_t i) {
  hn::StoreU(v.x, d, b.x.data() + i), hn::StoreU(v.y, d, b.y.data() + i), hn::StoreU(v.z, d, b.z.data() + i);
}
HWY_INLINE void compress_store3(D d, const V3& v, M mask, Vec3Batch& b, std::size_t i) {
  compress_store(v.x, mask, d, b.x.data() + i), compress_store(v.y, mask, d, b.y.data() + i);
  compress_store(v.z, mask, d, b.z.data() + i);
}
HWY_INLINE V3 neg3(const V3& a) { return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)}; }
HWY_INLINE V3 add3(const V3& a, const V3& b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
HWY_INLINE V3 sub3(const V3& a, const V3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE V3 mul3(const V3& a, const V3& b) { return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)}; }
HWY_INLINE V3 scale3(const V3& a, V s) { return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)}; }
HWY_INLINE V3 select3(M m, const V3& a, const V3& b) {
  return {hn::IfThenElse(m, a.x, b.x), hn::IfThenElse(m, a.y, b.y), hn::IfThenElse(m, a.z, b.z)};
}
HWY_INLINE V dot3(const V3& a, const V3& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }
HWY_INLINE V3 cross3(const V3& a, const V3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}
HWY_INLINE V max3(const V3& a) { return hn::Max(a.x, hn::Max(a.y, a.z)); }

}  // namespace sightline::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();

#endif  // SIGHTLINE_BASE_SIMD_VEC3_INL_H_
