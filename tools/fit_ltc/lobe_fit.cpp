#include "fit_ltc/lobe_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "fit_ltc/nelder_mead.h"
#include "shade/fresnel.h"

namespace sightline::fit {

namespace {

/// A slice of the lobe: f cos with F = 1, and the density with which visible normals sample it.
class Slice {
 public:
  Slice(double cosine, double alpha) : ggx_(static_cast<float>(alpha), static_cast<float>(alpha)) {
    const double z = std::max(cosine, 2e-4);
    wo_ = Vec3(std::sqrt(1 - z * z), 0, z);
  }
  Vec3 sample(const Vec2& u) const { return reflect_about(wo_, ggx_.sample_visible(wo_, u)); }
  double value(const Vec3& wi) const { return half_distribution(wi) * ggx_.shadowing_over_cosine(wo_, wi); }
  double density(const Vec3& wi) const { return half_distribution(wi) * ggx_.masking_over_cosine(wo_); }
  const Vec3& wo() const { return wo_; }

 private:
  double half_distribution(const Vec3& wi) const { return 0.5 * ggx_.distribution(glm::normalize(wo_ + wi)); }
  Ggx ggx_;
  Vec3 wo_{0, 0, 1};
};

template <class Visit>
void for_each_cell(int resolution, const Visit& visit) {
  const float step = 1 / static_cast<float>(resolution);
  for (int row = 0; row < resolution; ++row)
    for (int column = 0; column < resolution; ++column)
      visit(Vec2((static_cast<float>(row) + 0.5f) * step, (static_cast<float>(column) + 0.5f) * step));
}

double determinant(const InverseTransform& m) { return m.m11 * m.m33 - m.m13 * m.m31; }

Vec3d sample_ltc(const InverseTransform& m, const Vec2& u) {
  const Vec3d c = sample_cosine_hemisphere(u);
  const double scale = 1 / determinant(m);
  return glm::normalize(Vec3d((m.m33 * c.x - m.m13 * c.z) * scale, c.y, (m.m11 * c.z - m.m31 * c.x) * scale));
}
/// Before normalisation over the upper hemisphere; where positive, the density of sample_ltc().
double raw_value(const InverseTransform& m, const Vec3d& w) {
  const Vec3d c(m.m11 * w.x + m.m13 * w.z, w.y, m.m31 * w.x + m.m33 * w.z);
  const double squared = glm::dot(c, c);
  return std::numbers::inv_pi * c.z * determinant(m) / (squared * squared);
}
/// The transform takes the upper hemisphere to one that is tilted in the xz plane; this is the part of the cosine lobe over it.
double upper_part(const InverseTransform& m) { return m.m11 / std::hypot(m.m11, m.m31); }

/// Integral of |f cos / energy - fit|^exponent, with points from both and from a plain cosine, weighted by the balance heuristic. The last
/// is there for the directions where the fit is below zero, which neither of the others need sample well.
class Distance {
 public:
  Distance(const Slice& slice, double exponent, int resolution) : slice_(slice), exponent_(exponent), resolution_(resolution) {
    double sum = 0;
    for_each_cell(resolution, [&](const Vec2& u) {
      const Vec3 w = slice.sample(u);
      if (!(w.z > 0)) return;
      points_.push_back(sample_at(Vec3d(w)));
      sum += points_.back().value / slice.density(w);
    });
    energy_ = sum / (static_cast<double>(resolution) * resolution);
    for_each_cell(resolution, [&](const Vec2& u) { points_.push_back(sample_at(Vec3d(sample_cosine_hemisphere(u)))); });
  }
  double energy() const { return energy_; }
  double operator()(const InverseTransform& m) const {
    if (!(determinant(m) > 0)) return std::numeric_limits<double>::max();
    double sum = 0;
    const double scale = 1 / upper_part(m);
    const auto add = [&](const Sample& s) {
      const double raw = raw_value(m, s.w);
      sum += std::pow(std::fabs(s.value / energy_ - raw * scale), exponent_) / (s.density + std::max(raw, 0.0));
    };
    for (const Sample& s : points_) add(s);
    for_each_cell(resolution_, [&](const Vec2& u) {
      const Vec3d w = sample_ltc(m, u);
      if (w.z > 0) add(sample_at(w));
    });
    return sum / (static_cast<double>(resolution_) * resolution_);
  }

 private:
  struct Sample {
    Vec3d w;
    double value, density;  // density of the first and the last kind of point
  };
  Sample sample_at(const Vec3d& w) const { return {w, slice_.value(Vec3(w)), slice_.density(Vec3(w)) + std::numbers::inv_pi * w.z}; }
  Slice slice_;
  double exponent_;
  int resolution_;
  double energy_ = 1;
  std::vector<Sample> points_;
};

constexpr int kFitResolution = 24;

/// Coordinates of the search: width, direction of the peak, height, tilt. Those of narrow lobes are then about independent of each other.
Point<4> coordinates_of(const InverseTransform& m, double alpha) {
  return {std::log(m.m11), std::atan(m.m13 / m.m11), std::log(m.m33), m.m31 / alpha};
}
InverseTransform transform_at(const Point<4>& x, double alpha, bool isotropic) {
  if (isotropic) return {1, 0, 0, std::exp(x[2])};
  const double m11 = std::exp(x[0]);
  return {m11, m11 * std::tan(x[1]), alpha * x[3], std::exp(x[2])};
}

}  // namespace

InverseTransform mirror_transform(double cosine, double alpha) {
  const double c = std::max(cosine, 1e-3), sine = std::sqrt(1 - c * c);
  return {c * c, sine * c, -2 * alpha * c * sine, 2 * alpha * c * c};
}

double ltc_value(const InverseTransform& m, const Vec3d& w) { return raw_value(m, w) / upper_part(m); }

std::array<double, 3> lobe_energies(double cosine, double alpha, int resolution) {
  const Slice slice(cosine, alpha);
  std::array<double, 3> sums{};
  for_each_cell(resolution, [&](const Vec2& u) {
    const Vec3 w = slice.sample(u);
    if (!(w.z > 0)) return;
    const double ratio = slice.value(w) / slice.density(w);
    const double c = glm::dot(slice.wo(), glm::normalize(slice.wo() + w)), rest = 1 - c;
    const double fifth = rest * rest * rest * rest * rest;
    sums[0] += ratio, sums[1] += ratio * fifth, sums[2] += ratio * c * fifth * rest;
  });
  for (double& sum : sums) sum /= static_cast<double>(resolution) * resolution;
  return sums;
}

LobeFit fit_lobe(double cosine, double alpha, std::span<const InverseTransform> guesses, double exponent) {
  const Distance distance(Slice(cosine, alpha), exponent, kFitResolution);
  const bool isotropic = cosine >= 1;
  const auto error = [&](const Point<4>& x) { return distance(transform_at(x, alpha, isotropic)); };
  const auto descend = [&](const Point<4>& start, double step) {
    return minimize<4>(error, start, {step, std::min(step, alpha), step, step}, 1e-6, 240);
  };
  Point<4> best{};
  double least = std::numeric_limits<double>::max();
  for (const InverseTransform& g : guesses) {
    const Point<4> found = descend(coordinates_of(g, alpha), 0.2);
    if (error(found) < least) least = error(found), best = found;
  }
  // A second start finds the way out where the simplex has collapsed too early.
  const InverseTransform m = transform_at(descend(best, 0.05), alpha, isotropic);
  return {m, distance.energy(), total_variation(cosine, alpha, m)};
}

double total_variation(double cosine, double alpha, const InverseTransform& m) { return 0.5 * Distance(Slice(cosine, alpha), 1, 64)(m); }

}  // namespace sightline::fit
