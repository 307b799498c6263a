#include "methods/square_lights/table_lanes.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/square_lights/table_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;
using square_lights::kTableCells;

using D8 = hn::Rebind<std::int8_t, D>;

HWY_INLINE V LoadCodes(D d, const std::int8_t* table) { return hn::ConvertTo(d, hn::PromoteTo(DI(), hn::LoadU(D8(), table))); }

void TableDistances(const std::int8_t* HWY_RESTRICT table, const float* HWY_RESTRICT points, std::size_t count,
                    float* HWY_RESTRICT distances) {
  const D d;
  HWY_ALIGN float codes[kTableCells];
  for (std::size_t i = 0; i < kTableCells; i += hn::Lanes(d)) hn::Store(LoadCodes(d, table + i), d, codes + i);
  const auto sum = [&](V v) { return hn::GetLane(hn::SumOfLanes(d, v)); };
  std::size_t k = 0;
  for (; k + 2 <= count; k += 2) {
    const float* const a = points + k * kTableCells;
    const float* const b = a + kTableCells;
    V sum_a = hn::Zero(d), sum_b = hn::Zero(d);
    for (std::size_t i = 0; i < kTableCells; i += hn::Lanes(d)) {
      const V code = hn::Load(d, codes + i), to_a = hn::Sub(code, hn::LoadU(d, a + i)), to_b = hn::Sub(code, hn::LoadU(d, b + i));
      sum_a = hn::MulAdd(to_a, to_a, sum_a), sum_b = hn::MulAdd(to_b, to_b, sum_b);
    }
    distances[k] = sum(sum_a), distances[k + 1] = sum(sum_b);
  }
  if (k < count) {
    V sum_a = hn::Zero(d);
    for (std::size_t i = 0; i < kTableCells; i += hn::Lanes(d)) {
      const V to_a = hn::Sub(hn::Load(d, codes + i), hn::LoadU(d, points + k * kTableCells + i));
      sum_a = hn::MulAdd(to_a, to_a, sum_a);
    }
    distances[k] = sum(sum_a);
  }
}

float ProjectTable(const std::int8_t* HWY_RESTRICT table, const float* HWY_RESTRICT mean, const float* HWY_RESTRICT vectors,
                   std::size_t count, float* HWY_RESTRICT dots) {
  const D d;
  HWY_ALIGN float offset[kTableCells];
  V square = hn::Zero(d);
  for (std::size_t i = 0; i < kTableCells; i += hn::Lanes(d)) {
    const V v = hn::Sub(LoadCodes(d, table + i), hn::LoadU(d, mean + i));
    hn::Store(v, d, offset + i);
    square = hn::MulAdd(v, v, square);
  }
  const auto sum = [&](V v) { return hn::GetLane(hn::SumOfLanes(d, v)); };
  std::size_t j = 0;
  for (; j + 4 <= count; j += 4) {
    const float* const a = vectors + j * kTableCells;
    V s0 = hn::Zero(d), s1 = hn::Zero(d), s2 = hn::Zero(d), s3 = hn::Zero(d);
    for (std::size_t i = 0; i < kTableCells; i += hn::Lanes(d)) {
      const V v = hn::Load(d, offset + i);
      s0 = hn::MulAdd(v, hn::LoadU(d, a + i), s0), s1 = hn::MulAdd(v, hn::LoadU(d, a + kTableCells + i), s1);
      s2 = hn::MulAdd(v, hn::LoadU(d, a + 2 * kTableCells + i), s2), s3 = hn::MulAdd(v, hn::LoadU(d, a + 3 * kTableCells + i), s3);
    }
    dots[j] = sum(s0), dots[j + 1] = sum(s1), dots[j + 2] = sum(s2), dots[j + 3] = sum(s3);
  }
  for (; j < count; ++j) {
    V s = hn::Zero(d);
    for (std::size_t i = 0; i < kTableCells; i += hn::Lanes(d))
      s = hn::MulAdd(hn::Load(d, offset + i), hn::LoadU(d, vectors + j * kTableCells + i), s);
    dots[j] = sum(s);
  }
  return sum(square);
}

void AddProjected(const std::int8_t* HWY_RESTRICT table, const float* HWY_RESTRICT mean, const float* HWY_RESTRICT dots, std::size_t count,
                  float* HWY_RESTRICT vectors) {
  const D d;
  // A few hundred bytes of each vector at a time: the offsets stay in registers' reach.
  for (std::size_t i = 0; i < kTableCells; i += hn::Lanes(d)) {
    const V v = hn::Sub(LoadCodes(d, table + i), hn::LoadU(d, mean + i));
    for (std::size_t j = 0; j < count; ++j) {
      float* const at = vectors + j * kTableCells + i;
      hn::StoreU(hn::MulAdd(v, hn::Set(d, dots[j]), hn::LoadU(d, at)), d, at);
    }
  }
}

void ExpandTable(const std::uint16_t* HWY_RESTRICT components, const float* HWY_RESTRICT weights, std::size_t count,
                 std::int8_t* HWY_RESTRICT table) {
  const D d;
  const hn::Rebind<hwy::float16_t, D> d16;
  const auto* const halves = reinterpret_cast<const hwy::float16_t*>(components);
  const V most = hn::Set(d, 127.f), least = hn::Set(d, -127.f);
  constexpr std::size_t step = hn::MaxLanes(D());
  static_assert(kTableCells % (2 * step) == 0);
  // Two runs of cells at a time: one alone waits for each multiplication.
  for (std::size_t i = 0; i < kTableCells; i += 2 * step) {
    V a = hn::PromoteTo(d, hn::LoadU(d16, halves + i)), b = hn::PromoteTo(d, hn::LoadU(d16, halves + i + step));
    for (std::size_t j = 0; j < count; ++j) {
      const hwy::float16_t* const vector = halves + (j + 1) * kTableCells + i;
      const V weight = hn::Set(d, weights[j]);
      a = hn::MulAdd(weight, hn::PromoteTo(d, hn::LoadU(d16, vector)), a);
      b = hn::MulAdd(weight, hn::PromoteTo(d, hn::LoadU(d16, vector + step)), b);
    }
    const auto store = [&](V sum, std::size_t at) {
      const auto codes = hn::NearestInt(hn::Min(hn::Max(sum, least), most));
      hn::StoreU(hn::DemoteTo(D8(), hn::DemoteTo(hn::Rebind<std::int16_t, D>(), codes)), D8(), table + at);
    };
    store(a, i), store(b, i + step);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(TableDistances);
HWY_EXPORT(ProjectTable);
HWY_EXPORT(AddProjected);
HWY_EXPORT(ExpandTable);
}  // namespace sightline
namespace sightline::square_lights {

void table_distances(const std::int8_t* table, const float* points, std::size_t count, float* distances) {
  HWY_DYNAMIC_DISPATCH(TableDistances)(table, points, count, distances);
}
float project_table(const std::int8_t* table, const float* mean, const float* vectors, std::size_t count, float* dots) {
  return HWY_DYNAMIC_DISPATCH(ProjectTable)(table, mean, vectors, count, dots);
}
void add_projected(const std::int8_t* table, const float* mean, const float* dots, std::size_t count, float* vectors) {
  HWY_DYNAMIC_DISPATCH(AddProjected)(table, mean, dots, count, vectors);
}
void expand_table(const std::uint16_t* components, const float* weights, std::size_t count, std::int8_t* table) {
  HWY_DYNAMIC_DISPATCH(ExpandTable)(components, weights, count, table);
}

}  // namespace sightline::square_lights
#endif
