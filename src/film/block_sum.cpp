#include "film/block_sum.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "film/block_sum.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

bool SumBlock(const float* HWY_RESTRICT values, std::size_t count, std::int64_t* HWY_RESTRICT sums) {
  const hn::CappedTag<float, kLanes> df;
  const hn::CappedTag<double, kLanes / 2> dd;
  const hn::Rebind<float, decltype(dd)> dh;
  const hn::Rebind<std::int64_t, decltype(dd)> di;
  const auto zero = hn::Zero(df), least = hn::Set(df, 0x1p-16f), limit = hn::Set(df, 0x1p15f);
  auto good = hn::Eq(zero, zero);
  for (std::size_t i = 0; i < kLanes * count; i += hn::Lanes(df)) {
    const auto size = hn::Abs(hn::Load(df, values + i));
    good = hn::And(good, hn::Or(hn::Eq(size, zero), hn::And(hn::Ge(size, least), hn::Lt(size, limit))));
  }
  if (!hn::AllTrue(df, good)) return false;
  // A double holds value * 2^40 and its sum with up to 127 others as an integer only below 2^53: the sums themselves are 64-bit integers.
  const auto scale = hn::Set(dd, static_cast<double>(std::int64_t{1} << kBlockSumBits));
  for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(dd)) {
    auto sum = hn::Zero(di);
    for (std::size_t s = 0; s < count; ++s)
      sum = hn::Add(sum, hn::ConvertTo(di, hn::Mul(hn::PromoteTo(dd, hn::Load(dh, values + kLanes * s + lane)), scale)));
    hn::StoreU(sum, di, sums + lane);
  }
  return true;
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(SumBlock);

bool sum_block(const float* values, std::size_t count, std::int64_t* sums) { return HWY_DYNAMIC_DISPATCH(SumBlock)(values, count, sums); }

}  // namespace sightline
#endif
