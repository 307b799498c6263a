#include "shade/analytic/gauss_rules.h"

#include <cmath>
#include <numbers>

namespace sightline {
namespace {

// Zeros of the Legendre polynomial by Newton's method.
GaussRule rule_of(std::size_t count) {
  GaussRule rule;
  rule.count = count;
  const auto n = static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 20; ++step) {
      double last = 1, value = x;
      for (std::size_t k = 2; k <= count; ++k) {
        const auto degree = static_cast<double>(k);
        const double next = ((2 * degree - 1) * x * value - (degree - 1) * last) / degree;
        last = value, value = next;
      }
      slope = n * (x * value - last) / (x * x - 1);
      x -= value / slope;
    }
    rule.node[i] = static_cast<float>(x), rule.weight[i] = static_cast<float>(2 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace

const GaussRule& gauss_rule(float reach) {
  static const std::array<GaussRule, 5> rules = {rule_of(4), rule_of(6), rule_of(8), rule_of(12), rule_of(16)};
  return rules[reach < 1.2f ? 0 : reach < 2.2f ? 1 : reach < 3.2f ? 2 : reach < 5 ? 3 : 4];
}

}  // namespace sightline
