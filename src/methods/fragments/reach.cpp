#include "methods/fragments/reach.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/fragments/reach.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include "base/simd/targets.h"

#include "base/simd/vec3-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using namespace lanes;

void ReachedPixels(const GBuffer& g, std::size_t first, std::size_t count, const AreaLight& light, std::uint8_t* reached) {
  const D d;
  const auto bytes = hn::Rebind<std::uint8_t, D>();
  const V zero = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V3 p = load3(d, g.position, first + i);
    const V3 ng = load3(d, g.geometric_normal, first + i), ns = load3(d, g.shading_normal, first + i);
    M any = hn::Lt(zero, zero);
    for (const AreaLight::Member& member : light.members) {
      M above_ng = hn::Lt(zero, zero), above_ns = above_ng;
      for (const Vec3& corner : member.polygon) {
        const V3 towards = sub3(set3(d, corner), p);
        above_ng = hn::Or(above_ng, hn::Gt(dot3(towards, ng), zero));
        above_ns = hn::Or(above_ns, hn::Gt(dot3(towards, ns), zero));
      }
      M reach = hn::And(above_ng, above_ns);
      if (member.sides == EmitterSides::one)
        reach = hn::And(reach, hn::Gt(dot3(sub3(p, set3(d, member.polygon[0])), set3(d, member.normal)), zero));
      any = hn::Or(any, reach);
    }
    const hn::Vec<DU> ones = hn::IfThenElseZero(hn::RebindMask(DU(), any), hn::Set(DU(), 1u));
    hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(DI(), ones)), bytes, reached + i);
  }
}

void CutPixels(const GBuffer& g, std::size_t first, std::size_t count, const AreaLight& light, std::uint8_t* cut) {
  const D d;
  const auto bytes = hn::Rebind<std::uint8_t, D>();
  const V zero = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V3 ng = load3(d, g.geometric_normal, first + i), ns = load3(d, g.shading_normal, first + i);
    M below = hn::Lt(zero, zero);
    const M differ = hn::Or(hn::Ne(ng.x, ns.x), hn::Or(hn::Ne(ng.y, ns.y), hn::Ne(ng.z, ns.z)));
    if (!hn::AllFalse(d, differ)) {
      const V3 p = load3(d, g.position, first + i);
      for (const AreaLight::Member& member : light.members) {
        for (const Vec3& corner : member.polygon) below = hn::Or(below, hn::Le(dot3(sub3(set3(d, corner), p), ng), zero));
      }
    }
    const hn::Vec<DU> ones = hn::IfThenElseZero(hn::RebindMask(DU(), hn::And(differ, below)), hn::Set(DU(), 1u));
    hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(DI(), ones)), bytes, cut + i);
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(ReachedPixels);
HWY_EXPORT(CutPixels);

void reached_pixels(const GBuffer& g, std::size_t first, std::size_t count, const AreaLight& light, std::uint8_t* reached) {
  HWY_DYNAMIC_DISPATCH(ReachedPixels)(g, first, count, light, reached);
}

void cut_pixels(const GBuffer& g, std::size_t first, std::size_t count, const AreaLight& light, std::uint8_t* cut) {
  HWY_DYNAMIC_DISPATCH(CutPixels)(g, first, count, light, cut);
}

ReachPyramid::ReachPyramid() {
  for (int m = 0; m <= kRootLevel; ++m) levels_[static_cast<std::size_t>(m)].resize(std::size_t{1} << (2 * (kRootLevel - m)));
}

void ReachPyramid::build(const GBuffer& g, const RootTile& tile, const AreaLight& light) {
  for (int y = 0; y < kRootSize; ++y) {
    std::uint8_t* row = levels_[0].data() + y * kRootSize;
    reached_pixels(g, g.at(tile.x0, tile.y0 + y), kRootSize, light, row);
    // Beyond the picture's edge: neither.
    for (int x = 0; x < kRootSize; ++x) {
      const bool inside = g.inside(tile.x0 + x, tile.y0 + y);
      row[x] = inside ? static_cast<std::uint8_t>(row[x] ? Reach::all : Reach::none) : std::uint8_t{0};
    }
  }
  for (int m = 1; m <= kRootLevel; ++m) {
    const int size = kRootSize >> m;
    for (int y = 0; y < size; ++y) {
      const std::uint8_t *upper = levels_[static_cast<std::size_t>(m - 1)].data() + 4 * y * size, *lower = upper + 2 * size;
      std::uint8_t* to = levels_[static_cast<std::size_t>(m)].data() + y * size;
      for (int x = 0; x < size; ++x) to[x] = static_cast<std::uint8_t>(upper[2 * x] | upper[2 * x + 1] | lower[2 * x] | lower[2 * x + 1]);
    }
  }
}

}  // namespace sightline
#endif
