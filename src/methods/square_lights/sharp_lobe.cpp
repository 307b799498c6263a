#include "methods/square_lights/sharp_lobe.h"

#include <algorithm>
#include <cmath>

#include "methods/square_lights/brdf_table.h"
#include "methods/square_lights/square_fit.h"

namespace sightline::square_lights {
namespace {

constexpr int kAngles = 64;
constexpr float kQuarterTurn = kPi / 2, kLog2 = 0.69314718f;
/// Half width at half height above which a table does: 5° standard deviation.
constexpr float kWidest = 0.1f;
/// Sharpness of each term by that of the second.
constexpr std::array<float, SharpLobe::kTerms> kRatio{4, 1, 0.25f, 0.0625f};

Vec3 mirrored(const Vec3& wo) { return {-wo.x, -wo.y, wo.z}; }

/// z the mirror direction, x in the plane of incidence.
Frame3 lobe_frame(const Vec3& wo) {
  const Vec3 axis = mirrored(wo);
  return frame_from_normal_tangent(axis, glm::cross(Vec3(wo.y, -wo.x, 0), axis));
}

Vec3 direction_at(const Frame3& frame, const Vec2& p) {
  const float s = glm::dot(p, p), k = std::sqrt(std::max(0.f, 1 - s / 4));
  return frame.to_world({p.x * k, p.y * k, 1 - s / 2});
}

/// Integral of exp(-l x² / 2) over [x - h, x + h].
float gaussian_integral(float l, float x, float h) {
  const float root = std::sqrt(0.5f * l);
  if (root * h < 1e-2f) return 2 * h * std::exp(-0.5f * l * x * x);  // too short for a difference of error functions
  return 0.88622693f / root * (std::erf(root * (x + h)) - std::erf(root * (x - h)));
}

}  // namespace

// The widths at half height along and across the plane of incidence make distances relative; a few values at such distances, averaged over
// the four ways to go, are then fitted by terms whose weights must not be negative.
SharpLobe::Parameters SharpLobe::fit_view(const Bsdf& bsdf, const Vec3& wo) {
  const Frame3 frame = lobe_frame(wo);
  const auto color = [&](const Vec2& p) {
    const Vec3 wi = direction_at(frame, p);
    return wi.z > 0 ? bsdf.evaluate(wo, wi).f_cos : Color(0);
  };
  constexpr std::array<Vec2, 4> kWays{Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)};
  const Color peak = color(Vec2(0));
  // What lies far from the lobe is not part of it.
  Color base = peak;
  for (const Vec2& way : kWays) {
    if (direction_at(frame, 0.6f * way).z > 0) base = glm::min(base, color(0.6f * way));
  }
  const float height = max_component(peak - base);
  Parameters result;
  if (!is_finite(peak) || !(height > 3 * max_component(base))) return result;
  const auto relative = [&](const Vec2& p) { return std::max(0.f, max_component(color(p) - base)) / height; };
  // The in-plane width is that towards the normal, where no horizon cuts the lobe off.
  const float inward = frame.tangent.z >= 0 ? 1.f : -1.f;
  const auto half_width = [&](const Vec2& way) {
    float low = 0, high = 1e-5f;
    while (high < 0.6f && relative(high * way) > 0.5f) low = high, high *= 1.5f;
    for (int i = 0; i < 20; ++i) {
      const float middle = 0.5f * (low + high);
      (relative(middle * way) > 0.5f ? low : high) = middle;
    }
    return 0.5f * (low + high);
  };
  const float wx = half_width({inward, 0}), wy = half_width({0, 1});
  if (!(wx * wy < kWidest * kWidest) || !(wy > 0)) return result;
  result.sharpness_x = 2 * kLog2 / (wx * wx);
  result.sharpness_y = 2 * kLog2 / (wy * wy);

  // Least squares by area, one weight after the other, none below 0.
  constexpr int kPoints = 24;
  std::array<float, kPoints> profile, area;
  std::array<std::array<float, kTerms>, kPoints> basis;
  for (std::size_t j = 0; j < kPoints; ++j) {
    const float t = 0.1f * std::pow(1.25f, static_cast<float>(j));
    float sum = 0, count = 0;
    for (const Vec2& way : {Vec2(inward, 0), Vec2(0, 1), Vec2(0, -1)}) {
      const Vec2 p{t * wx * way.x, t * wy * way.y};
      if (glm::length(p) < 0.6f && direction_at(frame, p).z > 0) sum += relative(p), ++count;
    }
    profile[j] = count > 0 ? sum / count : 0.f;
    area[j] = count > 0 ? t * t : 0.f;
    for (std::size_t k = 0; k < kTerms; ++k) basis[j][k] = std::exp(-kRatio[k] * kLog2 * t * t);
  }
  std::array<float, kTerms> weight{0, 1, 0, 0};
  for (int round = 0; round < 300; ++round) {
    for (std::size_t k = 0; k < kTerms; ++k) {
      double numerator = 0, denominator = 0;
      for (std::size_t j = 0; j < kPoints; ++j) {
        float rest = profile[j];
        for (std::size_t i = 0; i < kTerms; ++i) rest -= i == k ? 0.f : weight[i] * basis[j][i];
        numerator += static_cast<double>(area[j]) * rest * basis[j][k];
        denominator += static_cast<double>(area[j]) * basis[j][k] * basis[j][k];
      }
      weight[k] = denominator > 0 ? static_cast<float>(std::max(0.0, numerator / denominator)) : 0.f;
    }
  }
  for (std::size_t k = 0; k < kTerms; ++k) result.amplitude[k] = weight[k] * (peak - base);
  return result;
}

SharpLobe SharpLobe::fit(const Bsdf& bsdf) {
  SharpLobe lobe;
  if (!is_isotropic(bsdf)) return lobe;
  for (int k = 0; k < kAngles; ++k) {
    const float cosine = std::max(std::cos(kQuarterTurn * static_cast<float>(k) / (kAngles - 1)), 1e-3f);
    const Vec3 wo{0, std::sqrt(1 - cosine * cosine), cosine};
    Bsdf prepared = bsdf;
    prepared.prepare(wo);
    lobe.views_.push_back(fit_view(prepared, wo));
    // Seen along the normal a lobe is as narrow as it looks anywhere but near the horizon.
    if (k == 0 && is_black(lobe.views_[0].amplitude[0] + lobe.views_[0].amplitude[1] + lobe.views_[0].amplitude[2])) return {};
  }
  return lobe;
}

SharpLobe::View SharpLobe::view(const Vec3& wo) const {
  View result;
  result.frame = lobe_frame(wo);
  if (views_.empty()) return result;
  const float place = std::acos(std::clamp(wo.z, 0.f, 1.f)) * ((kAngles - 1) / kQuarterTurn);
  const std::size_t first = std::min(static_cast<std::size_t>(place), std::size_t{kAngles - 2});
  const float part = std::min(place - static_cast<float>(first), 1.f);
  const Parameters &a = views_[first], &b = views_[first + 1];
  // A view without a lobe lends its amplitude of 0 only.
  const bool one = is_black(b.amplitude[1] + b.amplitude[2] + b.amplitude[0]),
             other = is_black(a.amplitude[1] + a.amplitude[2] + a.amplitude[0]);
  const auto mixed = [&](float u, float v) { return one ? u : other ? v : std::exp(glm::mix(std::log(u), std::log(v), part)); };
  result.sharpness_x = mixed(a.sharpness_x, b.sharpness_x);
  result.sharpness_y = mixed(a.sharpness_y, b.sharpness_y);
  for (std::size_t k = 0; k < kTerms; ++k) result.amplitude[k] = glm::mix(a.amplitude[k], b.amplitude[k], part);
  return result;
}

Color SharpLobe::value(const View& view, const Vec3& wi) {
  if (!(wi.z > 0)) return Color(0);
  const Vec2 p = lambert_azimuthal(view.frame.to_local(wi));
  const float exponent = -0.5f * (view.sharpness_x * p.x * p.x + view.sharpness_y * p.y * p.y);
  Color sum(0);
  for (std::size_t k = 0; k < kTerms; ++k) sum += view.amplitude[k] * std::exp(kRatio[k] * exponent);
  return sum;
}

Color SharpLobe::mean(const View& view, const Vec3& c, float r) {
  const Vec2 p = lambert_azimuthal(view.frame.to_local(c));
  const float half = r * 0.70710678f;
  Color sum(0);
  for (std::size_t k = 0; k < kTerms; ++k) {
    if (is_black(view.amplitude[k])) continue;
    const float lx = kRatio[k] * view.sharpness_x, ly = kRatio[k] * view.sharpness_y;
    // Five standard deviations off nothing is left.
    const float near_x = std::max(0.f, std::fabs(p.x) - half), near_y = std::max(0.f, std::fabs(p.y) - half);
    if (lx * near_x * near_x + ly * near_y * near_y > 25) continue;
    sum += view.amplitude[k] * (gaussian_integral(lx, p.x, half) * gaussian_integral(ly, p.y, half));
  }
  return sum / std::max(4 * half * half, 1e-20f);
}

Color shade_lobe(const SharpLobe::View& view, const Frame3& frame, const LightSet& lights, std::span<const float> visible) {
  Color sum(0);
  for (std::size_t i = 0; i < lights.count; ++i) {
    if (!(visible[i] > 0)) continue;
    const Vec3 c = frame.to_local({lights.x[i], lights.y[i], lights.z[i]});
    const float r = lights.r[i];
    if (!(c.z > -r)) continue;
    const Color mean = SharpLobe::mean(view, c, r);
    const float* radiance = lights.radiance.data() + 4 * i;
    sum += Color(radiance[0], radiance[1], radiance[2]) * mean * (2 * r * r * visible[i]);
  }
  return sum;
}

}  // namespace sightline::square_lights
