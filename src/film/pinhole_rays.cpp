#include "film/pinhole_rays.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "film/pinhole_rays.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;

// PixelFilter::offset.
HWY_INLINE V filter_offset(D d, const float* HWY_RESTRICT table, V u) {
  const DI di;
  const V x = hn::Mul(u, hn::Set(d, static_cast<float>(PixelFilter::kEntries)));
  // Lanes past the end may hold anything: keep the look-up inside the table.
  const auto i = hn::Max(hn::Zero(di), hn::Min(hn::ConvertTo(di, x), hn::Set(di, PixelFilter::kEntries - 1)));
  const V f = hn::Sub(x, hn::ConvertTo(d, i));
  const V a = hn::GatherIndex(d, table, i), b = hn::GatherIndex(d, table + 1, i);
  return hn::Add(hn::Mul(a, hn::Sub(hn::Set(d, 1.f), f)), hn::Mul(b, f));
}

void Rays(const PinholeRays& job, const std::uint32_t* HWY_RESTRICT pixels, const float* HWY_RESTRICT fx, const float* HWY_RESTRICT fy,
          std::size_t count, const CameraRays& rays) {
  const D d;
  const DI di;
  const V half = hn::Set(d, 0.5f);
  // Rows of up to 2^24 pixels: float division finds them exactly after one correction.
  const V inverse_width = hn::Set(d, 1.f / static_cast<float>(job.width));
  const auto width = hn::Set(di, static_cast<std::int32_t>(job.width));
  const auto axis = [&](float origin, float step_x, float step_y, V x, V y) {
    return hn::MulAdd(hn::Set(d, step_x), x, hn::MulAdd(hn::Set(d, step_y), y, hn::Set(d, origin)));
  };
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto pixel = hn::BitCast(di, hn::Load(hn::RebindToUnsigned<D>(), pixels + i));
    auto row = hn::ConvertTo(di, hn::Mul(hn::ConvertTo(d, pixel), inverse_width));
    auto column = hn::Sub(pixel, hn::Mul(row, width));
    const auto below = hn::Lt(column, hn::Zero(di));
    row = hn::IfThenElse(below, hn::Sub(row, hn::Set(di, 1)), row), column = hn::IfThenElse(below, hn::Add(column, width), column);
    const auto above = hn::Gt(column, hn::Sub(width, hn::Set(di, 1)));
    row = hn::IfThenElse(above, hn::Add(row, hn::Set(di, 1)), row), column = hn::IfThenElse(above, hn::Sub(column, width), column);

    const V x = hn::Add(hn::Add(hn::ConvertTo(d, column), half), filter_offset(d, job.filter_table, hn::Load(d, fx + i)));
    const V y = hn::Add(hn::Add(hn::ConvertTo(d, row), half), filter_offset(d, job.filter_table, hn::Load(d, fy + i)));
    const V px = axis(job.origin.x, job.step_x.x, job.step_y.x, x, y);
    const V py = axis(job.origin.y, job.step_x.y, job.step_y.y, x, y);
    const V pz = axis(job.origin.z, job.step_x.z, job.step_y.z, x, y);
    if (job.orthographic) {
      hn::Store(px, d, rays.ox + i), hn::Store(py, d, rays.oy + i), hn::Store(pz, d, rays.oz + i);
      hn::Store(hn::Set(d, job.position.x), d, rays.dx + i), hn::Store(hn::Set(d, job.position.y), d, rays.dy + i);
      hn::Store(hn::Set(d, job.position.z), d, rays.dz + i);
    } else {
      const V length = hn::Sqrt(hn::MulAdd(px, px, hn::MulAdd(py, py, hn::Mul(pz, pz))));
      const V scale = hn::Div(hn::Set(d, 1.f), length);
      hn::Store(hn::Set(d, job.position.x), d, rays.ox + i), hn::Store(hn::Set(d, job.position.y), d, rays.oy + i);
      hn::Store(hn::Set(d, job.position.z), d, rays.oz + i);
      hn::Store(hn::Mul(px, scale), d, rays.dx + i), hn::Store(hn::Mul(py, scale), d, rays.dy + i),
          hn::Store(hn::Mul(pz, scale), d, rays.dz + i);
    }
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(Rays);

void pinhole_rays(const PinholeRays& job, const std::uint32_t* pixels, const float* fx, const float* fy, std::size_t count,
                  const CameraRays& rays) {
  HWY_DYNAMIC_DISPATCH(Rays)(job, pixels, fx, fy, count, rays);
}

}  // namespace sightline
#endif
