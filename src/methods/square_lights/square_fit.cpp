#include "methods/square_lights/square_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>

#include "base/math/frame.h"

namespace sightline::square_lights {
namespace {

/// Cosines and sines of the four turns.
constexpr std::array<Vec2, 4> kTurn{Vec2(1, 0), Vec2(0.92387953f, 0.38268343f), Vec2(0.70710678f, 0.70710678f),
                                    Vec2(0.38268343f, 0.92387953f)};
constexpr float kRootHalf = 0.70710678f;
/// Steps of the half edge that are tried, by mean width of a point; the best of them is refined by a parabola.
constexpr float kStepsPerPoint = 2;
/// Pattern searches end after so many rounds, or when steps are small against a point or against the half edge.
constexpr int kMostTries = 12;
constexpr float kLeastStep = 0.1f, kLeastRelativeStep = 0.06f;
/// Smallest and largest square tried, by the square of the region's own solid angle.
constexpr float kSmallest = 0.4f, kLargest = 1.6f;

}  // namespace

void SquareFitter::clear() {
  points_.clear();
  finished_ = false;
  solid_angle_ = squared_ = 0;
  flux_ = glm::dvec3(0);
}

void SquareFitter::add(const Vec3& direction, float solid_angle, const Color& radiance) {
  points_.push_back({direction, solid_angle, radiance, std::sqrt(solid_angle), 0});
  const double weight = solid_angle;
  const glm::dvec3 value(radiance);
  solid_angle_ += weight;
  squared_ += weight * glm::dot(value, value);
  flux_ += weight * value;
  finished_ = false;
}

void SquareFitter::finish() {
  if (finished_) return;
  for (Point& p : points_) p.weight = static_cast<float>(glm::dot(flux_, glm::dvec3(p.radiance))) * p.solid_angle;
  distance_.resize(kTurns * points_.size());
  finished_ = true;
}

Vec3 SquareFitter::centroid() const {
  Vec3d bright(0), all(0);
  for (const Point& p : points_) {
    const double weight = p.solid_angle;
    bright += weight * static_cast<double>(luminance(p.radiance)) * Vec3d(p.direction);
    all += weight * Vec3d(p.direction);
  }
  const Vec3 fallback = normalize_or(Vec3(all), points_.front().direction);
  const double length = glm::length(bright);
  return length > 0 && std::isfinite(length) ? Vec3(bright / length) : fallback;
}

void SquareFitter::project(const Vec3& center) {
  const Frame3 frame = frame_from_normal(center);
  const std::size_t n = points_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 p = lambert_azimuthal(frame.to_local(points_[i].direction));
    for (std::size_t t = 0; t < kTurns; ++t) {
      const Vec2& turn = kTurn[t];
      distance_[t * n + i] = std::max(std::fabs(turn.x * p.x + turn.y * p.y), std::fabs(turn.x * p.y - turn.y * p.x));
    }
  }
}

// `covered` is the mean over turns of Λ · ∫_{S ∩ O} L.
double SquareFitter::error_at(double covered, double half) const {
  const double r2 = 2 * half * half;
  return squared_ - covered / r2 + glm::dot(flux_, flux_) / (2 * r2);
}

double SquareFitter::covered(float half) const {
  double sum = 0;
  const std::size_t n = points_.size();
  for (std::size_t t = 0; t < kTurns; ++t) {
    for (std::size_t i = 0; i < n; ++i) {
      const Point& p = points_[i];
      sum += p.weight * std::clamp((half - distance_[t * n + i]) / p.width + 0.5f, 0.f, 1.f);
    }
  }
  return sum / kTurns;
}

// Sorts what each point contributes by the half edge at which it is covered, split between two nodes: sums over nodes then give J for
// every h.
SquareFitter::Best SquareFitter::best_half(const Vec3& center) {
  project(center);
  const std::size_t n = points_.size();
  const float mean_width = std::sqrt(static_cast<float>(solid_angle_) / static_cast<float>(n)), step = mean_width / kStepsPerPoint;
  const float nominal = 0.5f * std::sqrt(static_cast<float>(solid_angle_));
  const int nodes = static_cast<int>(kLargest * nominal / step) + 2;
  covered_at_.assign(static_cast<std::size_t>(nodes) + 1, 0);
  double* const covered_at = covered_at_.data();
  const float scale = 1 / step;
  for (std::size_t t = 0; t < kTurns; ++t) {
    const float* const distance = distance_.data() + t * n;
    for (std::size_t i = 0; i < n; ++i) {
      const float place = std::min(distance[i] * scale + 0.5f, static_cast<float>(nodes) - 0.5f);
      const int node = static_cast<int>(place);
      const float weight = points_[i].weight, later = weight * (place - static_cast<float>(node));
      covered_at[node] += weight - later;
      covered_at[node + 1] += later;
    }
  }
  // The least J over the nodes but the last, where all that lies beyond was put; about squares smaller than a point nothing is known.
  constexpr double kNone = 1e300;
  const int first = std::max({1, static_cast<int>(std::ceil(0.4f * kStepsPerPoint)), static_cast<int>(kSmallest * nominal / step)});
  double sum = 0, last = kNone;
  Best best{kNone, nominal};
  std::array<double, 3> around{kNone, kNone, kNone};
  bool next_wanted = false;
  for (int k = 0; k < nodes - 1; ++k) {
    sum += covered_at[k];
    if (k < first) continue;
    const float half = static_cast<float>(k) * step;
    const double error = error_at(sum / kTurns, half);
    if (next_wanted) around[2] = error;
    next_wanted = error < best.value;
    if (next_wanted) {
      best = {error, half};
      around = {last, error, kNone};
    }
    last = error;
  }
  // A parabola through the best node and those beside it.
  const double curvature = around[0] - 2 * around[1] + around[2];
  if (around[0] < kNone && around[2] < kNone && curvature > 0) {
    const double slope = around[0] - around[2];
    best.half += step * static_cast<float>(0.5 * slope / curvature);
    best.value -= slope * slope / (8 * curvature);
  }
  return best;
}

double SquareFitter::error(const Vec3& center, float radius, bool area_penalty) {
  finish();
  project(center);
  const float half = radius * kRootHalf;
  return error_at(covered(half), half) * (area_penalty ? solid_angle_ : 1);
}

SquareLight SquareFitter::light(const Vec3& center, float radius) const {
  return {center, radius, Color(flux_ / (2 * static_cast<double>(radius) * radius))};
}

SquareFit SquareFitter::fit(std::span<const Vec3> starts, bool area_penalty) {
  finish();
  Vec3 center = centroid();
  Best best{0, 0.5f * std::sqrt(static_cast<float>(solid_angle_))};
  // Black regions are all alike, and a point is where it is.
  if (squared_ > 0 && points_.size() > 1) {
    best = best_half(center);
    for (const Vec3& start : starts) {
      if (const Best other = best_half(start); other.value < best.value) best = other, center = start;
    }
    // Pattern search: along both tangents, with half the step where nothing is gained, until steps are small against a point.
    const float width = std::sqrt(static_cast<float>(solid_angle_) / static_cast<float>(points_.size()));
    float step = 0.5f * best.half;
    for (int tries = 0; tries < kMostTries && step > std::max(kLeastStep * width, kLeastRelativeStep * best.half); ++tries) {
      const Frame3 frame = frame_from_normal(center);
      const std::array<Vec3, 4> offsets{frame.tangent, -frame.tangent, frame.bitangent, -frame.bitangent};
      const double before = best.value;
      Vec3 moved = center;
      for (const Vec3& offset : offsets) {
        const Vec3 there = glm::normalize(center + step * offset);
        if (const Best other = best_half(there); other.value < best.value) best = other, moved = there;
      }
      center = moved;
      if (!(best.value < before)) step *= 0.5f;
    }
  }
  const float radius = best.half / kRootHalf;
  return {light(center, radius), static_cast<float>(solid_angle_), static_cast<float>(std::max(0.0, error(center, radius, area_penalty)))};
}

}  // namespace sightline::square_lights
