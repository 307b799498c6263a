// Rules of Gauss and Legendre on [-1, 1].
#pragma once

#include <array>
#include <cstddef>

namespace sightline {

struct GaussRule {
  std::size_t count = 0;
  std::array<float, 16> node{}, weight{};
};

/// With as many nodes as an integrand like 1 / cosh²s, s in an interval of half-length `reach`, needs for about 1e-3.
const GaussRule& gauss_rule(float reach);

}  // namespace sightline
