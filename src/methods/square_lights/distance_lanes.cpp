// Signed Euclidean distances of small maps: squared distances along columns, then the least sum along rows, which is exact because squares
// of the two legs add up [Felzenszwalb2012]. Deviation: for maps of at most some hundred points the second step needs no envelope of
// parabolas; trying one offset after the other for 16 points at a time, until offsets alone exceed what was found, is several times faster.
#include <cassert>
#include <limits>

#include "methods/square_lights/distance_table.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/square_lights/distance_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

// Further than any point of a map; its square is exact enough to tell it from real ones.
constexpr float kFar = 1e4f;

void SignedDistances(const std::uint8_t* HWY_RESTRICT visible, int n, float* HWY_RESTRICT distances) {
  const D d;
  const hn::Rebind<std::uint8_t, D> d8;
  const DI di;
  const std::size_t width = padded(static_cast<std::size_t>(n));
  const std::size_t stride = width + 2 * kLanes;  // 16 far values on each side, so that reads beside a row find nothing
  const std::size_t rows = static_cast<std::size_t>(n);
  AlignedVector<float> to_hidden(rows * stride, kFar * kFar), to_visible(rows * stride, kFar * kFar);
  const V one = hn::Set(d, 1.f), zero = hn::Zero(d), far = hn::Set(d, kFar);

  // Along columns: how far up, then how far up or down, the nearest hidden and the nearest visible point are.
  for (std::size_t x = 0; x < rows; x += hn::Lanes(d)) {
    const M valid = hn::FirstN(d, rows - x);
    V hidden = far, seen = far;
    for (std::size_t y = 0; y < rows; ++y) {
      alignas(16) std::uint8_t bytes[kLanes] = {};
      const std::uint8_t* row = visible + y * rows + x;
      if (x + hn::Lanes(d) > rows) {
        std::copy(row, visible + (y + 1) * rows, bytes);
        row = bytes;
      }
      const M is_visible = hn::RebindMask(d, hn::Gt(hn::PromoteTo(di, hn::LoadU(d8, row)), hn::Zero(di)));
      hidden = hn::IfThenElseZero(is_visible, hn::Add(hidden, one));
      seen = hn::IfThenZeroElse(is_visible, hn::Add(seen, one));
      const std::size_t at = y * stride + kLanes + x;
      hn::StoreU(hn::IfThenElse(valid, hidden, far), d, to_hidden.data() + at);
      hn::StoreU(hn::IfThenElse(valid, seen, far), d, to_visible.data() + at);
    }
    hidden = seen = far;
    for (std::size_t y = rows; y-- > 0;) {
      const std::size_t at = y * stride + kLanes + x;
      hidden = hn::Min(hn::Min(hn::Add(hidden, one), hn::LoadU(d, to_hidden.data() + at)), far);
      seen = hn::Min(hn::Min(hn::Add(seen, one), hn::LoadU(d, to_visible.data() + at)), far);
      hn::StoreU(hn::Mul(hidden, hidden), d, to_hidden.data() + at);
      hn::StoreU(hn::Mul(seen, seen), d, to_visible.data() + at);
    }
  }

  // Along rows: the least square to a point of the other kind.
  const V infinity = hn::Set(d, std::numeric_limits<float>::infinity()), half = hn::Set(d, 0.5f);
  for (std::size_t y = 0; y < rows; ++y) {
    const float* const hidden_row = to_hidden.data() + y * stride + kLanes;
    const float* const visible_row = to_visible.data() + y * stride + kLanes;
    for (std::size_t x = 0; x < rows; x += hn::Lanes(d)) {
      const M is_visible = hn::Gt(hn::LoadU(d, hidden_row + x), zero);
      const auto other = [&](std::ptrdiff_t at) {
        return hn::IfThenElse(is_visible, hn::LoadU(d, hidden_row + at), hn::LoadU(d, visible_row + at));
      };
      const auto group = static_cast<std::ptrdiff_t>(x), lane_count = static_cast<std::ptrdiff_t>(hn::Lanes(d));
      V least = other(group);
      for (std::ptrdiff_t k = 1; k < n; ++k) {
        const float square = static_cast<float>(k * k);
        // A look at all lanes now and then is cheaper than at each offset.
        if (k % 4 == 1 && hn::AllTrue(d, hn::Le(least, hn::Set(d, square)))) break;
        V nearer = hn::Set(d, kFar * kFar);
        if (group - k + lane_count > 0) nearer = other(group - k);
        if (group + k < n) nearer = hn::Min(nearer, other(group + k));
        least = hn::Min(least, hn::Add(nearer, hn::Set(d, square)));
      }
      const V length = hn::Sub(hn::Sqrt(least), half);
      const V found = hn::IfThenElse(hn::Lt(least, hn::Set(d, 0.5f * kFar * kFar)), length, infinity);
      const V result = hn::IfThenElse(is_visible, found, hn::Neg(found));
      hn::BlendedStore(result, hn::FirstN(d, rows - x), d, distances + y * rows + x);
    }
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(SignedDistances);
}  // namespace sightline
namespace sightline::square_lights {

void signed_distances(std::span<const std::uint8_t> visible, int n, std::span<float> distances) {
  assert(n > 0 && n <= 1024 && visible.size() == static_cast<std::size_t>(n) * n && distances.size() >= visible.size());
  HWY_DYNAMIC_DISPATCH(SignedDistances)(visible.data(), n, distances.data());
}

}  // namespace sightline::square_lights
#endif
