// A measured isotropic BRDF, tabulated for evaluation and sampling.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "shade/scattered_reflectance.h"

namespace sightline {

/// Scattered measurements, interpolated once onto a regular grid of pair points; reciprocal by construction. Directions lie on the upper
/// side. Immutable and safe to share.
///
/// Peaks narrower than the measurements are spread over the distance between them, so that a surface could return more than it receives.
/// Then f becomes s(cos_o) f s(cos_i) with the largest s <= 1 that keeps every directional albedo within kMostAlbedo: still reciprocal.
class MeasuredReflectance {
 public:
  static constexpr float kMostAlbedo = 0.98f;

  /// At least one sample; values are taken to be finite and not negative.
  explicit MeasuredReflectance(std::span<const ReflectanceSample> samples);

  Color value(const Vec3& wo, const Vec3& wi) const;
  /// Density of sample() by solid angle: a table of f over cells of equal projected solid angle, between two views, blended with a cosine.
  float pdf(const Vec3& wo, const Vec3& wi) const;
  /// `u_view` picks one of the two neighbouring views.
  Vec3 sample(const Vec3& wo, float u_view, const Vec2& u) const;

  /// Under uniform light, and towards one direction.
  const Color& albedo() const { return albedo_; }
  Color directional_albedo(float cos_theta) const;
  /// The least s: 1 where nothing had to be taken back.
  float least_scale() const;
  std::uint64_t content_hash() const { return content_hash_; }
  std::size_t bytes() const;

 private:
  static constexpr int kNodes = 65;                ///< along each axis of the grid
  static constexpr int kAngles = 65;               ///< nodes of s and of the albedo, over the cosine
  static constexpr int kViews = 32;                ///< tables of sampling, over the angle of the view
  static constexpr int kRows = 32, kColumns = 64;  ///< over the azimuth from 0 to pi, and sin² theta
  static constexpr std::size_t kTable = std::size_t{kRows} * kColumns;

  struct View {
    int lower;
    float upper_weight;
  };
  static View view_of(float cos_theta);
  float scale_at(float cos_theta) const;
  Color grid_value(const PairPoint& point) const;
  void limit_albedo();
  void build_tables();
  float table_pdf(int view, float sin2, float turn) const;

  std::vector<Color> grid_;
  std::vector<float> scale_;
  std::vector<Color> directional_albedo_;
  std::vector<float> density_;  ///< [view][row][column], mean 1
  std::vector<float> row_cdf_, column_cdf_;
  Color albedo_{0};
  std::uint64_t content_hash_ = 0;
};

}  // namespace sightline
