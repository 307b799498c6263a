// A measured BRDF from memory: any bytes end in measurements that can be interpolated or in an Error.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/core/error.h"
#include "shade/measured_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sightline;
  try {
    const std::vector<ReflectanceSample> samples = parse_cornell_brdf({reinterpret_cast<const char*>(data), size}, "fuzz.brdf");
    if (samples.empty() || samples.size() * 5 > size + 1) __builtin_trap();
    const ScatteredReflectance scattered(samples);
    // Of its grid the tables look up hundreds of thousands of points; some of them show what any would.
    for (int i = 0; i < 64; ++i) {
      const PairPoint point = Vec3(static_cast<float>(i % 4), static_cast<float>(i / 4 % 4), static_cast<float>(i / 16)) / 3.f;
      const Color value = scattered.at(point);
      if (!is_finite(value) || value.x < 0 || value.y < 0 || value.z < 0) __builtin_trap();
    }
  } catch (const Error& error) {
    if (error.code() == ErrorCode::bug || error.place().empty()) __builtin_trap();
  }
  return 0;
}
