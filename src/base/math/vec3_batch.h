// Single vectors in and out of structures of arrays.
#pragma once

#include <algorithm>
#include <cstddef>

#include "base/core/aligned.h"
#include "base/math/vec.h"

namespace sightline {

inline Vec3 load(const Vec3Batch& batch, std::size_t i) { return {batch.x[i], batch.y[i], batch.z[i]}; }
inline void store(Vec3Batch& batch, std::size_t i, const Vec3& v) { batch.x[i] = v.x, batch.y[i] = v.y, batch.z[i] = v.z; }
inline void add(Vec3Batch& batch, std::size_t i, const Vec3& v) { batch.x[i] += v.x, batch.y[i] += v.y, batch.z[i] += v.z; }
/// v to lanes [first, first + count).
inline void fill(Vec3Batch& batch, std::size_t first, std::size_t count, const Vec3& v) {
  std::fill_n(batch.x.data() + first, count, v.x);
  std::fill_n(batch.y.data() + first, count, v.y);
  std::fill_n(batch.z.data() + first, count, v.z);
}

}  // namespace sightline
