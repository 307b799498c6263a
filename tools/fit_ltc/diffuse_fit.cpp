#include "fit_ltc/diffuse_fit.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "fit_ltc/nelder_mead.h"
#include "shade/analytic/ltc_table.h"
#include "shade/ggx_albedo.h"

namespace sightline::fit {

namespace {

constexpr int kSteps = 2000;
double cosine_at(int i) { return (i + 0.5) / kSteps; }

using Function = std::function<double(double)>;

/// Cosine-weighted mean over the sky.
double mean_of(const Function& f) {
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += 2 * cosine_at(i) * f(cosine_at(i));
  return sum / kSteps;
}

struct Amount {
  double amount, squared_error;
};
/// The amount that makes mean + amount (g - 1) nearest to `albedo`.
Amount amount_of(const Function& albedo, double mean, double stretch) {
  const auto g = [stretch](double c) { return ltc_table::stretched_ratio(c, stretch) - 1; };
  const double both = mean_of([&](double c) { return (albedo(c) - mean) * g(c); }), own = mean_of([&](double c) { return g(c) * g(c); });
  const double amount = own > 0 ? both / own : 0;
  return {amount, mean_of([&](double c) { return std::pow(albedo(c) - mean - amount * g(c), 2); })};
}

}  // namespace

DiffuseFit fit_diffuse(double alpha) {
  const Ggx ggx(static_cast<float>(alpha), static_cast<float>(alpha));
  const auto full = [&](double c) -> double { return ggx_schlick_albedo(Color(1), static_cast<float>(c), ggx).x; };
  const auto schlick = [&](double c) -> double { return ggx_schlick_albedo(Color(0), static_cast<float>(c), ggx).x; };
  DiffuseFit fit{};
  fit.mean_full = mean_of(full), fit.mean_schlick = mean_of(schlick);
  // The stretch serves the Schlick part, which is what dielectrics have.
  const auto error = [&](const Point<1>& x) { return amount_of(schlick, fit.mean_schlick, std::exp(x[0])).squared_error; };
  fit.stretch = std::exp(minimize<1>(error, {std::log(4.0)}, {0.2})[0]);
  fit.amount_full = amount_of(full, fit.mean_full, fit.stretch).amount;
  fit.amount_schlick = amount_of(schlick, fit.mean_schlick, fit.stretch).amount;
  constexpr double kF0 = 0.04;
  for (int i = 0; i < kSteps; ++i) {
    const double c = cosine_at(i), g = ltc_table::stretched_ratio(c, fit.stretch) - 1;
    if (c * c < 1e-3) continue;
    const double truth = kF0 * full(c) + (1 - kF0) * schlick(c);
    const double fitted = kF0 * (fit.mean_full + fit.amount_full * g) + (1 - kF0) * (fit.mean_schlick + fit.amount_schlick * g);
    fit.worst = std::max(fit.worst, std::fabs(truth - fitted));
  }
  return fit;
}

}  // namespace sightline::fit
