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
  constexpr std::size_t kPage = 4096;
  auto* const bytes = reinterpret_cast<std::byte*>(array.data());
  const std::size_t size = array.capacity() * sizeof(T), before = (kPage - reinterpret_cast<std::uintptr_t>(bytes) % kPage) % kPage;
  if (size >= before + kPage) madvise(bytes + before, (size - before) / kPage * kPage, MADV_HUGEPAGE);  // may fail: then pages are small
#endif
}

}  // namespace sightline
