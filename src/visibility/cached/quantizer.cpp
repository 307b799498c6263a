#include "visibility/cached/quantizer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/math/frame.h"
#include "visibility/cached/grid_math.h"

namespace sightline {
namespace {

// Eight cells along the normal for each of these across must still be told apart by a float in [0, 1).
constexpr double kFinestResolution = 1 << 20;

// What SIMD instructions give for max(x, 0) and min(x, y), also where x is not a number.
float max_zero(float x) { return x > 0 ? x : 0.f; }
float min_of(float x, float y) { return x < y ? x : y; }

Vec3 quantised_direction(int qx, int qy, int qz, float bins) {
  return 2.f * Vec3(static_cast<float>(qx), static_cast<float>(qy), static_cast<float>(qz)) / bins - 1.f;
}

std::uint32_t to_cell(float x) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(x))); }

std::uint32_t bits_of(float x) { return std::bit_cast<std::uint32_t>(x + 0.f); }  // -0 becomes 0

}  // namespace

float fast_log2(float x) {
  using G = GridMath;
  const std::int32_t bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t exponent = (bits - G::kSqrtHalfBits) >> 23;
  const float t = std::bit_cast<float>(bits - (exponent << 23)) - 1;
  // Pairs first: short chains of dependent operations.
  const float square = t * t;
  const float high = (G::kLog2[4] + G::kLog2[5] * t) * square + (G::kLog2[2] + G::kLog2[3] * t);
  return static_cast<float>(exponent) + (high * square + (G::kLog2[0] + G::kLog2[1] * t)) * t;
}

Vec2 sphere_to_square(const Vec3& direction, bool equal_area) {
  using G = GridMath;
  const float x = std::fabs(direction.x), y = std::fabs(direction.y), z = std::fabs(direction.z);
  float u, v;
  if (equal_area) {
    // Radius and angle in the octant, then its triangle in the square.
    const float radius = std::sqrt(max_zero(1 - z));
    const float larger = x > y ? x : y, smaller = x > y ? y : x;
    const float ratio = larger > 0 ? smaller / larger : 0.f;
    const float square = ratio * ratio;
    float sum = G::kAtan[5];
    for (int i = 4; i >= 0; --i) sum = sum * square + G::kAtan[i];
    sum = sum * ratio;
    const float angle = y > x ? 1 - sum : sum;
    v = angle * radius;
    u = radius - v;
  } else {
    const float norm = (x + y) + z;
    u = x / norm, v = y / norm;
  }
  if (direction.z < 0) {
    const float swapped = 1 - v;
    v = 1 - u, u = swapped;
  }
  u = std::copysign(u, direction.x), v = std::copysign(v, direction.y);
  return {(u + 1) * 0.5f, (v + 1) * 0.5f};
}

Quantizer::Quantizer(const Bounds& scene, const CachedVisibilitySettings& settings) {
  GridConstants& c = constants_;
  // A little more than the half diagonal: coordinates of all points then lie in [0, 1).
  const double diameter = scene.is_empty() ? 0 : 2.0 * scene.half_diagonal() * (1 + 1e-5);
  c.known = diameter > 1e-30 && diameter < 1e30;
  c.center = c.known ? scene.center() : Vec3(0);
  c.scale = c.known ? static_cast<float>(1 / diameter) : 0.f;
  c.bins = static_cast<float>(settings.directions);
  c.bin_shift = settings.normals == CacheNormals::rounded ? 0.5f : 0.f;
  c.flatness = static_cast<float>(settings.flatness);
  c.stride = static_cast<std::uint32_t>(settings.directions + 1);
  c.equal_area = settings.sphere == CacheSphere::equal_area;

  // Orientations: the quantised normal and any two axes across it, as long as they are always the same.
  frames_.resize(std::size_t{9} * c.stride * c.stride * c.stride + kLanes);
  std::size_t at = 0;
  for (int qz = 0; qz <= settings.directions; ++qz) {
    for (int qy = 0; qy <= settings.directions; ++qy) {
      for (int qx = 0; qx <= settings.directions; ++qx) {
        const Frame3 frame = frame_from_normal(normalize_or(quantised_direction(qx, qy, qz, c.bins), {0, 0, 1}));
        for (const Vec3& axis : {frame.tangent, frame.bitangent, frame.normal}) {
          frames_[at++] = axis.x, frames_[at++] = axis.y, frames_[at++] = axis.z;
        }
      }
    }
  }

  const double ratio = settings.level_ratio;
  c.levels_per_octave = static_cast<float>(1 / std::log2(ratio));
  std::size_t first_sphere = 0;
  for (double r = 1; r <= kFinestResolution && resolution_.size() < (1u << EndWords::kLevelBits); r *= ratio) {
    resolution_.push_back(static_cast<float>(std::max(1.0, std::floor(r))));
    if (resolution_.back() < 2) first_sphere = resolution_.size();
  }
  c.last_level = static_cast<float>(resolution_.size() - 1);
  c.first_sphere_level = settings.eq9_as_printed ? 0.f : static_cast<float>(first_sphere);
  c.light_offset = c.known ? static_cast<float>(std::log2(diameter)) * c.levels_per_octave : 0.f;
  // [Popov2013, Eq. 9] prints the factor 4 pi in the denominator, which makes one cell of the sphere; see README.md.
  const double sphere = 0.5 * std::log2(4 * std::numbers::pi) / std::log2(ratio);
  c.sphere_offset = static_cast<float>(settings.eq9_as_printed ? -sphere : sphere);
  c.frames = frames_.data();
  c.resolution = resolution_.data();
}

float Quantizer::eye_offset(float ce) const { return constants_.light_offset - std::log2(ce) * constants_.levels_per_octave; }

float Quantizer::symmetric_offset(float ce) const { return constants_.light_offset - 0.5f * std::log2(ce) * constants_.levels_per_octave; }

Mat3 Quantizer::frame(std::uint32_t bins) const {
  const EndWords words{bins};
  const float* f =
      frames_.data() + std::size_t{9} * (words.axis(0) + constants_.stride * (words.axis(1) + constants_.stride * words.axis(2)));
  return {Vec3(f[0], f[1], f[2]), Vec3(f[3], f[4], f[5]), Vec3(f[6], f[7], f[8])};
}

GridPoint Quantizer::locate(const Vec3& position, const Vec3& normal, float cell_area) const {
  const GridConstants& c = constants_;
  GridPoint point;
  for (int i = 0; i < 3; ++i) {
    const float q = std::floor((normal[i] + 1) * 0.5f * c.bins + c.bin_shift);
    point.bins |= static_cast<std::uint32_t>(min_of(max_zero(q), c.bins)) << (EndWords::kAxisBits * i);
  }
  const Vec3 p = (position - c.center) * c.scale;
  const Mat3 axes = frame(point.bins);
  const auto along = [&](int i) { return ((p.x * axes[i].x + p.y * axes[i].y) + p.z * axes[i].z) + 0.5f; };
  point.x = along(0), point.y = along(1), point.z = along(2);
  const float extent = std::fabs(point.x) + std::fabs(point.y) + std::fabs(point.z);
  const bool known = c.known && extent < GridMath::kFarthest && cell_area >= GridMath::kLeastArea && cell_area <= GridMath::kMostArea;
  point.log_area = known ? fast_log2(cell_area) : std::numeric_limits<float>::infinity();
  return point;
}

EndWords Quantizer::cell(const GridPoint& point, float level) const {
  const float k = std::floor(level + 0.5f);
  if (!std::isfinite(point.log_area) || !(k <= constants_.last_level)) return {EndWords::kUnknown};
  const float kept = max_zero(k);
  const float r = resolution_[static_cast<std::size_t>(kept)];
  return {point.bins | (static_cast<std::uint32_t>(kept) << EndWords::kLevelShift), to_cell(point.x * r), to_cell(point.y * r),
          to_cell(point.z * (r * constants_.flatness))};
}

EndWords Quantizer::eye(const GridPoint& point, float offset) const {
  return cell(point, offset - point.log_area * (0.5f * constants_.levels_per_octave));
}

EndWords Quantizer::light(QuerySemantic semantic, const Vec3& position, const Vec3& normal, float cell_area, float shift) const {
  const GridConstants& c = constants_;
  const std::uint32_t tag = static_cast<std::uint32_t>(semantic) << EndWords::kSemanticShift;
  EndWords words;
  if (!is_infinite(semantic) && semantic != QuerySemantic::point) {
    const GridPoint point = locate(position, normal, cell_area);
    words = cell(point, (c.light_offset + shift) - point.log_area * (0.5f * c.levels_per_octave));
  } else if (semantic == QuerySemantic::solid_angle) {
    const bool known = cell_area >= GridMath::kLeastArea && cell_area <= GridMath::kMostArea;
    const float log_area = known ? fast_log2(cell_area) : std::numeric_limits<float>::infinity();
    const float k = std::floor(((c.sphere_offset + shift) - log_area * (0.5f * c.levels_per_octave)) + 0.5f);
    const Vec2 uv = sphere_to_square(position, c.equal_area);
    if (known && k <= c.last_level && uv.x >= 0 && uv.x <= 2 && uv.y >= 0 && uv.y <= 2) {
      const float kept = k > c.first_sphere_level ? k : c.first_sphere_level;
      const float r = resolution_[static_cast<std::size_t>(kept)];
      words = {static_cast<std::uint32_t>(kept) << EndWords::kLevelShift, to_cell(uv.x * r), to_cell(uv.y * r), 0};
    } else {
      words = {EndWords::kUnknown};
    }
  } else {
    words = {0, bits_of(position.x), bits_of(position.y), bits_of(position.z)};
  }
  words.packed |= tag;
  return words;
}

Quantizer::Pair Quantizer::connection(const GridPoint& eye_point, QuerySemantic semantic, const Vec3& position, const Vec3& normal,
                                      float cell_area, float ce) const {
  // Only surfaces share the patch: an area on the sphere could outgrow it [Popov2013, §3.5].
  if (semantic != QuerySemantic::surface) return {eye(eye_point, eye_offset(ce)), light(semantic, position, normal, cell_area)};
  const GridPoint light_point = locate(position, normal, cell_area);
  const float level = symmetric_offset(ce) - (eye_point.log_area + light_point.log_area) * (0.25f * constants_.levels_per_octave);
  Pair pair{cell(eye_point, level), cell(light_point, level)};
  pair.light.packed |= static_cast<std::uint32_t>(semantic) << EndWords::kSemanticShift;
  return pair;
}

}  // namespace sightline
