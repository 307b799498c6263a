// Memory for big arrays in large pages.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/core/aligned.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace sightline {

/// Room for `count` elements, in large pages where the system has them to give: an array of a picture is touched once a frame, and in small
/// pages the first touch costs more than what is done there. A hint: nothing depends on it.
template <class T>
void reserve_in_large_pages(AlignedVector<T>& array, std::size_t count) {
  if (array.capacity() >= count) return;
  array.reserve(count);
#ifdef __linux__
  constexpr std::uintptr_t kPage = 4096;
  const auto begin = (reinterpret_cast<std::uintptr_t>(array.data()) + kPage - 1) & ~(kPage - 1);
  const auto end = reinterpret_cast<std::uintptr_t>(array.data() + array.capacity()) & ~(kPage - 1);
  if (end > begin) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);  // may fail: then pages are small
#endif
}
inline void reserve_in_large_pages(Vec3Batch& batch, std::size_t count) {
  reserve_in_large_pages(batch.x, padded(count));
  reserve_in_large_pages(batch.y, padded(count));
  reserve_in_large_pages(batch.z, padded(count));
}

}  // namespace sightline
