// Cache-line aligned arrays for structure-of-arrays batches.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace sightline {

inline constexpr std::size_t kCacheLine = 64;
/// Batches are padded to this many lanes, so that the widest packet or vector may read and write past the last element.
inline constexpr std::size_t kLanes = 16;
inline constexpr std::size_t padded(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

template <class T>
struct AlignedAllocator {
  using value_type = T;
  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t{kCacheLine})); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t{kCacheLine}); }
  template <class U>
  bool operator==(const AlignedAllocator<U>&) const {
    return true;
  }
};

template <class T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

/// Three aligned float arrays.
struct Vec3Batch {
  AlignedVector<float> x, y, z;
  void resize(std::size_t n) {
    x.resize(padded(n));
    y.resize(padded(n));
    z.resize(padded(n));
  }
};

}  // namespace sightline
