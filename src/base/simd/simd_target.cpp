#include "base/simd/simd_target.h"

#include <hwy/targets.h>

#include <array>

#include "base/core/error.h"

namespace sightline {
namespace {

struct Target {
  std::string_view name;
  std::int64_t bit;
};
constexpr std::array<Target, 3> kTargets = {{{"AVX3", HWY_AVX3}, {"AVX2", HWY_AVX2}, {"SSSE3", HWY_SSSE3}}};

}  // namespace

std::string simd_target() {
  const std::int64_t supported = hwy::SupportedTargets();
  for (const Target& target : kTargets) {
    if (supported & target.bit) return std::string(target.name);
  }
  return "baseline";
}

void pin_simd_target(std::string_view name) {
  for (const Target& target : kTargets) {
    if (target.name != name) continue;
    if ((hwy::SupportedTargets() & target.bit) == 0) throw usage_error("this CPU has no " + std::string(name));
    // Lower bits are better targets; keep this one and the worse ones.
    hwy::DisableTargets(target.bit - 1);
    return;
  }
  throw usage_error("unknown SIMD target '" + std::string(name) + "'").remedy("known: AVX3, AVX2, SSSE3");
}

}  // namespace sightline
