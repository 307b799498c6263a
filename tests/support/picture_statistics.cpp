#include "support/picture_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sightline::test {
namespace {

/// Rounding of single precision along a path, relative: no evidence of anything.
constexpr double kRounding = 2e-5;

struct Mean {
  double value, error, degrees_of_freedom;
};

double p_value(const Mean& a, const Mean& b) {
  const double slack = kRounding * std::fmax(std::fabs(a.value), std::fabs(b.value)) + 1e-12;
  const double difference = std::fmax(0.0, std::fabs(a.value - b.value) - slack);
  if (difference == 0) return 1;
  const double variance = a.error * a.error + b.error * b.error;
  if (variance == 0) return 0;
  // Welch and Satterthwaite: how many degrees of freedom a sum of two estimated variances has.
  double denominator = 0;
  for (const Mean& m : {a, b}) {
    if (m.error > 0) denominator += std::pow(m.error, 4) / m.degrees_of_freedom;
  }
  return student_tail(difference / std::sqrt(variance), variance * variance / denominator);
}

PictureTest test_pictures(const Replicates& a, const Replicates& b) {
  PictureTest result;
  double least = 1;
  const double tests = 3.0 * static_cast<double>(a.mean.size());
  for (std::size_t pixel = 0; pixel < a.mean.size(); ++pixel) {
    for (int c = 0; c < 3; ++c) {
      const Mean ma{a.mean[pixel][c], a.error[pixel][c], a.count - 1.0}, mb{b.mean[pixel][c], b.error[pixel][c], b.count - 1.0};
      const double p = p_value(ma, mb);
      if (p >= least) continue;
      least = p;
      result.worst = fmt::format("pixel {} channel {}: {} ± {} against {} ± {}", pixel, c, ma.value, ma.error, mb.value, mb.error);
    }
  }
  result.pixel_p = -std::expm1(tests * std::log1p(-std::fmin(least, 1 - 1e-16)));
  least = 1;
  for (int c = 0; c < 3; ++c) {
    const double p =
        p_value({a.picture_mean[c], a.picture_error[c], a.count - 1.0}, {b.picture_mean[c], b.picture_error[c], b.count - 1.0});
    least = std::fmin(least, p);
  }
  result.mean_p = -std::expm1(3 * std::log1p(-std::fmin(least, 1 - 1e-16)));
  result.worst +=
      fmt::format("; picture {} ± {} against {} ± {}", a.picture_mean.y, a.picture_error.y, b.picture_mean.y, b.picture_error.y);
  return result;
}

}  // namespace

double student_tail(double t, double degrees_of_freedom) {
  // t = sqrt(n) tan(a) turns the density into cos^(n-1)(a): smooth, so that Simpson's rule does.
  const auto integral = [&](double from, double to) {
    constexpr int kSteps = 2000;
    const double h = (to - from) / kSteps;
    double sum = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const double weight = i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2;
      sum += weight * std::pow(std::fmax(0.0, std::cos(from + i * h)), degrees_of_freedom - 1);
    }
    return sum * h / 3;
  };
  const double quarter = std::numbers::pi / 2;
  const double angle = std::atan(std::fabs(t) / std::sqrt(degrees_of_freedom));
  return integral(angle, quarter) / integral(0, quarter);
}

Replicates replicate(const Shot& shot, Exposure exposure, int count) {
  Replicates result;
  result.count = count;
  const auto pixels = static_cast<std::size_t>(shot.size_px.x * shot.size_px.y);
  std::vector<Vec3d> squares(pixels, Vec3d(0));
  result.mean.assign(pixels, Vec3d(0));
  result.error.assign(pixels, Vec3d(0));
  Vec3d picture_squares(0);
  const std::uint64_t first_seed = exposure.seed * 1000 + 1;
  for (int k = 0; k < count; ++k) {
    exposure.seed = first_seed + static_cast<std::uint64_t>(k);
    const Picture picture = expose(shot, exposure);
    Vec3d sum(0);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      const Vec3d value(picture.frame.color(static_cast<std::uint32_t>(pixel)));
      // Welford's update keeps the squares of small deviations.
      const Vec3d before = value - result.mean[pixel];
      result.mean[pixel] += before / (k + 1.0);
      squares[pixel] += before * (value - result.mean[pixel]);
      sum += value;
    }
    sum /= static_cast<double>(pixels);
    const Vec3d before = sum - result.picture_mean;
    result.picture_mean += before / (k + 1.0);
    picture_squares += before * (sum - result.picture_mean);
  }
  const double divisor = count * (count - 1.0);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) result.error[pixel] = glm::sqrt(squares[pixel] / divisor);
  result.picture_error = glm::sqrt(picture_squares / divisor);
  return result;
}

PictureTest compare(const Replicates& a, const Replicates& b) { return test_pictures(a, b); }

PictureTest compare(const Replicates& a, const std::vector<Vec3d>& truth) {
  Replicates exact;
  exact.count = 2;
  exact.mean = truth;
  exact.error.assign(truth.size(), Vec3d(0));
  for (const Vec3d& value : truth) exact.picture_mean += value / static_cast<double>(truth.size());
  return test_pictures(a, exact);
}

}  // namespace sightline::test
