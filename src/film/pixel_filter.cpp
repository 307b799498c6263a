#include "film/pixel_filter.h"

#include <fmt/format.h>

#include <cmath>

#include "base/core/error.h"

namespace sightline {
namespace {

constexpr double kSigma = 0.5, kRadius = 1.5;

// Distribution function of the Gaussian cut at ±kRadius.
double gaussian_cdf(double x) {
  const double edge = std::erf(kRadius / (kSigma * std::sqrt(2.0)));
  return 0.5 * (1 + std::erf(x / (kSigma * std::sqrt(2.0))) / edge);
}

}  // namespace

PixelFilter::PixelFilter(Kind kind) : kind_(kind) {
  for (int i = 0; i <= kEntries; ++i) {
    const double u = static_cast<double>(i) / kEntries;
    double offset = 0;
    if (kind == Kind::box) offset = u - 0.5;
    if (kind == Kind::gaussian) {
      double lower = -kRadius, upper = kRadius;
      for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (lower + upper);
        (gaussian_cdf(middle) < u ? lower : upper) = middle;
      }
      offset = 0.5 * (lower + upper);
    }
    table_[static_cast<std::size_t>(i)] = static_cast<float>(offset);
  }
}

std::string_view pixel_filter_name(PixelFilter::Kind kind) {
  switch (kind) {
    case PixelFilter::Kind::gaussian:
      return "gaussian";
    case PixelFilter::Kind::box:
      return "box";
    case PixelFilter::Kind::centre:
      return "centre";
  }
  return "";
}

PixelFilter pixel_filter_from_name(std::string_view name) {
  for (const auto kind : {PixelFilter::Kind::gaussian, PixelFilter::Kind::box, PixelFilter::Kind::centre}) {
    if (pixel_filter_name(kind) == name) return PixelFilter(kind);
  }
  throw usage_error(fmt::format("unknown filter '{}'", name)).remedy("known: gaussian, box, centre");
}

}  // namespace sightline
