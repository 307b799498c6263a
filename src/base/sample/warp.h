// Warps from the unit square to shapes and directions, each beside its density and, where one exists, its inverse.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/math/vec.h"

namespace sightline {

/// The largest float below 1: upper end of the random numbers.
inline constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;

/// Unit disk, concentric map [Shirley1997]: neighbours in the square stay neighbours.
inline Vec2 sample_concentric_disk(const Vec2& u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return Vec2(0);
  const bool wide = std::fabs(a) > std::fabs(b);
  const float radius = wide ? a : b;
  const float angle = 0.25f * kPi * (wide ? b / a : a / b);
  const float major = std::cos(angle) * radius, minor = std::sin(angle) * radius;
  return wide ? Vec2(major, minor) : Vec2(minor, major);
}
/// Density by area.
inline float pdf_concentric_disk() { return kInvPi; }
inline Vec2 invert_concentric_disk(const Vec2& p) {
  const bool wide = std::fabs(p.x) > std::fabs(p.y);
  const float major = wide ? p.x : p.y, minor = wide ? p.y : p.x;
  if (major == 0) return Vec2(0.5f);
  const float radius = std::copysign(std::sqrt(p.x * p.x + p.y * p.y), major);
  const float other = 4 * kInvPi * std::atan(minor / major) * radius;
  const Vec2 square = wide ? Vec2(radius, other) : Vec2(other, radius);
  return glm::clamp(0.5f * square + 0.5f, 0.f, kOneMinusEpsilon);
}

/// Upper hemisphere around +z, density proportional to the cosine.
inline Vec3 sample_cosine_hemisphere(const Vec2& u) {
  const Vec2 d = sample_concentric_disk(u);
  return {d.x, d.y, std::sqrt(std::max(0.f, 1 - d.x * d.x - d.y * d.y))};
}
inline float pdf_cosine_hemisphere(float cos_theta) { return std::max(0.f, cos_theta) * kInvPi; }
inline Vec2 invert_cosine_hemisphere(const Vec3& w) { return invert_concentric_disk(Vec2(w)); }

/// Point of the unit sphere with the given cosine and turn in [0, 1).
inline Vec3 spherical_direction(float cos_theta, float turn) {
  const float sin_theta = std::sqrt(std::max(0.f, 1 - cos_theta * cos_theta));
  const float phi = 2 * kPi * turn;
  return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta};
}
/// The azimuth of (x, y) as a turn in [0, 1).
inline float azimuth_turn(float x, float y) {
  const float turn = std::atan2(y, x) * (0.5f * kInvPi);
  return std::min(turn < 0 ? turn + 1 : turn, kOneMinusEpsilon);
}

/// Upper hemisphere, uniform in solid angle.
inline Vec3 sample_uniform_hemisphere(const Vec2& u) { return spherical_direction(1 - u.x, u.y); }
inline float pdf_uniform_hemisphere() { return 0.5f * kInvPi; }
inline Vec2 invert_uniform_hemisphere(const Vec3& w) { return {std::clamp(1 - w.z, 0.f, kOneMinusEpsilon), azimuth_turn(w.x, w.y)}; }

/// Whole sphere, uniform in solid angle.
inline Vec3 sample_uniform_sphere(const Vec2& u) {
  const float z = 1 - 2 * u.x;
  // 1 - z² written so that it does not cancel near the poles.
  const float sin_theta = 2 * std::sqrt(std::max(0.f, u.x * (1 - u.x)));
  const float phi = 2 * kPi * u.y;
  return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), z};
}
inline float pdf_uniform_sphere() { return 0.25f * kInvPi; }
inline Vec2 invert_uniform_sphere(const Vec3& w) { return {std::clamp(0.5f * (1 - w.z), 0.f, kOneMinusEpsilon), azimuth_turn(w.x, w.y)}; }

/// Barycentrics (b0, b1) of a triangle, uniform by area, by folding the square [Heitz2019]; b2 = 1 - b0 - b1.
inline Vec2 sample_uniform_triangle(const Vec2& u) {
  const bool lower = u.x < u.y;
  const float half = 0.5f * (lower ? u.x : u.y);
  return lower ? Vec2(half, u.y - half) : Vec2(u.x - half, half);
}
/// Density over the (b0, b1) parameter triangle, of area 1/2; divide 1 by the area for density by area.
inline float pdf_uniform_triangle() { return 2; }
inline Vec2 invert_uniform_triangle(const Vec2& b) { return b.x > b.y ? Vec2(b.x + b.y, 2 * b.y) : Vec2(2 * b.x, b.x + b.y); }

/// Cone around +z, uniform in solid angle. It is described by 1 - cos of its half angle, which stays exact for narrow cones.
inline Vec3 sample_uniform_cone(const Vec2& u, float one_minus_cos) {
  const float drop = u.x * one_minus_cos;
  const float sin_theta = std::sqrt(std::max(0.f, drop * (2 - drop)));
  const float phi = 2 * kPi * u.y;
  return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), 1 - drop};
}
inline float pdf_uniform_cone(float one_minus_cos) { return 1 / (2 * kPi * one_minus_cos); }
inline Vec2 invert_uniform_cone(const Vec3& w, float one_minus_cos) {
  // 1 - cos from the sine, which is exact for narrow cones.
  const float drop = w.z > 0 ? (w.x * w.x + w.y * w.y) / (1 + w.z) : 1 - w.z;
  return {std::clamp(drop / one_minus_cos, 0.f, kOneMinusEpsilon), azimuth_turn(w.x, w.y)};
}

/// Lobe around +z with density proportional to cos^exponent.
inline Vec3 sample_phong_lobe(const Vec2& u, float exponent) {
  const float cos_theta = std::pow(1 - u.x, 1 / (exponent + 1));
  return spherical_direction(cos_theta, u.y);
}
inline float pdf_phong_lobe(float cos_theta, float exponent) {
  return cos_theta > 0 ? (exponent + 1) * (0.5f * kInvPi) * std::pow(cos_theta, exponent) : 0.f;
}
inline Vec2 invert_phong_lobe(const Vec3& w, float exponent) {
  return {std::clamp(1 - std::pow(std::max(0.f, w.z), exponent + 1), 0.f, kOneMinusEpsilon), azimuth_turn(w.x, w.y)};
}

/// Micro-normal of a GGX surface with slopes `alpha`, in proportion to the area visible from `wo` (unit, wo.z >= 0): a spherical cap in the
/// stretched configuration [Dupuy2023, Listing 3].
inline Vec3 sample_ggx_visible_normal(const Vec3& wo, const Vec2& alpha, const Vec2& u) {
  const Vec3 stretched = glm::normalize(Vec3(alpha.x * wo.x, alpha.y * wo.y, wo.z));
  // cap + stretched, whose z is written without the cancellation of adding and taking away stretched.z.
  const float sum_z = (1 - u.y) * (1 + stretched.z);
  const float cap_z = sum_z - stretched.z;
  const float cap_sin = std::sqrt(std::max(0.f, 1 - cap_z * cap_z));
  const float phi = 2 * kPi * u.x;
  const Vec3 normal{alpha.x * (cap_sin * std::cos(phi) + stretched.x), alpha.y * (cap_sin * std::sin(phi) + stretched.y), sum_z};
  return normalize_or(normal, Vec3(0, 0, 1));
}
/// Density of the above by solid angle of the normal `m` (m.z > 0, wo.z >= 0): D(m) G1(wo) max(0, wo·m) / wo.z.
inline float pdf_ggx_visible_normal(const Vec3& wo, const Vec2& alpha, const Vec3& m) {
  const float cosine = glm::dot(wo, m);
  if (m.z <= 0 || cosine <= 0) return 0;
  const Vec3 slope{m.x / alpha.x, m.y / alpha.y, m.z};
  const float shape = glm::dot(slope, slope);
  const float distribution = kInvPi / (alpha.x * alpha.y * shape * shape);
  const Vec3 stretched{alpha.x * wo.x, alpha.y * wo.y, wo.z};
  return distribution * cosine * 2 / (wo.z + glm::length(stretched));
}
inline Vec2 invert_ggx_visible_normal(const Vec3& wo, const Vec2& alpha, const Vec3& m) {
  const Vec3 stretched = glm::normalize(Vec3(alpha.x * wo.x, alpha.y * wo.y, wo.z));
  const Vec3 half = glm::normalize(Vec3(m.x / alpha.x, m.y / alpha.y, m.z));
  const Vec3 cap = 2 * glm::dot(stretched, half) * half - stretched;
  return {azimuth_turn(cap.x, cap.y), std::clamp(1 - (cap.z + stretched.z) / (1 + stretched.z), 0.f, kOneMinusEpsilon)};
}

}  // namespace sightline
