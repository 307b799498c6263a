#include "methods/fragments/smooth.h"

#include <algorithm>
#include <cmath>

#include "base/math/vec3_batch.h"
#include "methods/fragments/smooth_window.h"

namespace sightline {
namespace {

using namespace smoothing;

bool receives(PixelKind kind) { return kind == PixelKind::diffuse || kind == PixelKind::analytic; }

bool on_same_surface(const GBuffer& g, std::size_t centre, std::size_t other) {
  const Vec3 d = load(g.position, other) - load(g.position, centre);
  const float distance = glm::dot(d, load(g.geometric_normal, centre)), limit = kMaxPlaneDistance * g.depth[centre];
  return glm::dot(load(g.shading_normal, centre), load(g.shading_normal, other)) >= kMinCosine && distance * distance <= limit * limit &&
         distance * distance <= kMaxSlope * kMaxSlope * length_squared(d);
}

}  // namespace

std::uint8_t window_level(const SmoothInput& input, int x, int y) {
  const GBuffer& g = input.g;
  std::uint8_t level = input.level[g.at(x, y)];
  const auto mix = [&](int px, int py) {
    if (!g.inside(px, py)) return;
    const std::uint8_t other = input.level[g.at(px, py)];
    if (other <= kMixedLevel) level = std::max(level, other);
  };
  mix(x - kFar, y), mix(x + kFar, y), mix(x, y - kFar), mix(x, y + kFar);
  return level;
}

namespace {

struct Fit {
  float value, keep;  // what the window says, and how much of the pixel's own value should stay
};

Fit fit_window(const SmoothInput& input, int x, int y, int step) {
  const GBuffer& g = input.g;
  const std::size_t centre = g.at(x, y);
  const float own = input.signal[centre];

  // Moments of the window, values relative to the pixel's own.
  float count = 0, fine = 0, sx = 0, sy = 0, sxx = kRidge, sxy = 0, syy = kRidge, t = 0, tx = 0, ty = 0, txx = 0, txy = 0, tyy = 0, tt = 0;
  for (int j = -kRadius; j <= kRadius; ++j)
    for (int i = -kRadius; i <= kRadius; ++i) {
      const int px = x + i * step, py = y + j * step;
      if (!g.inside(px, py)) continue;
      const std::size_t at = g.at(px, py);
      if (!receives(g.kind[at]) || !on_same_surface(g, centre, at)) continue;
      const float v = input.signal[at] - own, fx = static_cast<float>(i), fy = static_cast<float>(j);
      count += 1, fine += input.level[at] == 0 ? 1.f : 0.f;
      sx += fx, sy += fy, sxx += fx * fx, sxy += fx * fy, syy += fy * fy;
      t += v, tx += v * fx, ty += v * fy, txx += v * fx * fx, txy += v * fx * fy, tyy += v * fy * fy, tt += v * v;
    }
  if (count < kLeastCount) return {own, 1};

  // The plane a + b x + c y, x and y relative to the window's centre of gravity.
  const float mx = sx / count, my = sy / count, mean = t / count;
  const float vxx = sxx - sx * mx, vxy = sxy - sx * my, vyy = syy - sy * my, ux = tx - t * mx, uy = ty - t * my;
  const float per_determinant = 1 / std::max(vxx * vyy - vxy * vxy, 1e-12f);
  const float b = (vyy * ux - vxy * uy) * per_determinant, c = (vxx * uy - vxy * ux) * per_determinant;
  const float plane = mean - b * mx - c * my;
  float squares = tt - t * mean - b * ux - c * uy, freedom = count - 3, curvature = 0;

  // On a whole window the polynomials x^2 - 2, y^2 - 2 and x y are orthogonal to those of the plane, with squares 70, 70 and 100.
  if (count == kWhole) {
    const float qxx = txx - 2 * t, qyy = tyy - 2 * t;
    curvature = -2 * (qxx + qyy) / 70;
    squares -= (qxx * qxx + qyy * qyy) / 70 + txy * txy / 100, freedom -= 3;
  }
  const float mid = std::clamp(own + plane, 0.f, 1.f);
  const float rays = (fine * kFineVariance + (count - fine) * kProbeVariance) / count;
  const float variance = rays * std::min(kTaper * std::min(mid, 1 - mid), 1.f) + kLeastVariance;
  const float curved = std::clamp((curvature * curvature / variance - kFlat) / (kCurved - kFlat), 0.f, 1.f);
  const float fit = std::clamp(own + plane + curved * curvature, 0.f, 1.f);
  const float residual = std::max(squares, 0.f) / freedom;
  const float gentle = std::max(1 - (b * b + c * c) / kSteep, 0.f);
  const float allowed = kAllowed * gentle * gentle * variance;
  // All or nothing at the end of a surface: what is fitted to one side alone says little there.
  if (count < kWhole && (own == 0 || own == 1)) return {own, 1};
  const float keep = std::clamp(residual / std::max(allowed, 1e-20f) - 1, 0.f, 1.f);
  return {fit, keep};
}

}  // namespace

float smooth_pixel(const SmoothInput& input, int x, int y) {
  const GBuffer& g = input.g;
  const std::size_t centre = g.at(x, y);
  float value = input.signal[centre];
  if (!receives(g.kind[centre])) return value;
  const int widest = step_of(window_level(input, x, y));
  for (int step = narrowest_step(widest); step <= widest; step *= 2) {
    const Fit fit = fit_window(input, x, y, step);
    value = fit.value + fit.keep * (value - fit.value);
  }
  return value;
}

void smooth(const GBuffer& g, std::span<const float> signal, std::span<const std::uint8_t> level, const RootTile& tile,
            std::span<float> out) {
  const SmoothInput input{g, signal, level};
  for (int y = tile.y0; y < tile.y1; ++y) smooth_row(input, tile.x0, y, tile.x1 - tile.x0, out.data() + g.at(tile.x0, y));
}

}  // namespace sightline
