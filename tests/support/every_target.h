// Vector code is compiled once for each of several instruction sets and chosen at run time; tests ask all of them that this machine has.
#pragma once

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>
#include <vector>

namespace sightline::test {

/// While it lives, dynamic dispatch takes this instruction set.
class PinnedTarget {
 public:
  explicit PinnedTarget(std::int64_t target) { choose(target); }
  PinnedTarget(const PinnedTarget&) = delete;
  PinnedTarget& operator=(const PinnedTarget&) = delete;
  ~PinnedTarget() { choose(0); }

 private:
  // Setting what is supported alone changes nothing once a target was chosen.
  static void choose(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

/// Those that are compiled and that this machine has.
inline std::vector<std::int64_t> simd_targets() { return hwy::SupportedAndGeneratedTargets(); }

template <class Check>
void on_every_target(const Check& check) {
  for (const std::int64_t target : simd_targets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    const PinnedTarget pinned(target);
    check();
  }
}

}  // namespace sightline::test
