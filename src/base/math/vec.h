// Small vectors: glm's types under our names, and what glm lacks.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <numbers>

namespace sightline {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using Vec3d = glm::dvec3;
using IVec2 = glm::ivec2;
using UVec3 = glm::uvec3;
using Mat3 = glm::mat3;
/// Column-major 4x4 matrix acting on column vectors: `world_from_object * p`.
using Mat4 = glm::mat4;
/// Linear Rec.709 triple: radiance, reflectance, ...
using Color = glm::vec3;

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;

/// Relative luminance of linear Rec.709.
inline float luminance(const Color& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
inline float max_component(const Vec3& v) { return std::fmax(v.x, std::fmax(v.y, v.z)); }
inline float length_squared(const Vec3& v) { return glm::dot(v, v); }
inline bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
inline bool is_black(const Color& c) { return c.x == 0 && c.y == 0 && c.z == 0; }
/// Normalised, or `fallback` where the length is 0 or not finite.
inline Vec3 normalize_or(const Vec3& v, const Vec3& fallback) {
  const float length = std::sqrt(length_squared(v));
  return length > 0 && std::isfinite(length) ? v / length : fallback;
}
inline Vec3 transform_point(const Mat4& m, const Vec3& p) { return Vec3(m * Vec4(p, 1)); }
inline Vec3 transform_vector(const Mat4& m, const Vec3& v) { return Vec3(m * Vec4(v, 0)); }

}  // namespace sightline
