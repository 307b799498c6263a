// Big arrays of zeros that take memory only where they are touched.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <type_traits>

#include "base/core/error.h"

namespace sightline {

/// Fixed-size array of plain numbers, all 0 at first, on a page border. The system hands out its pages when they are touched.
template <class T>
class ZeroPages {
  static_assert(std::is_arithmetic_v<T>);

 public:
  ZeroPages() = default;
  explicit ZeroPages(std::size_t size) : size_(size) {
    std::size_t space = size * sizeof(T) + kPage;
    memory_.reset(std::calloc(space, 1));
    if (!memory_) throw resource_error("no memory for the tables of a visibility").remedy("lower --set resolution");
    void* start = memory_.get();
    data_ = static_cast<T*>(std::align(kPage, size * sizeof(T), start, space));
  }
  /// Elements may be changed through a constant array: several threads fill it, as atomics.
  T& operator[](std::size_t i) const { return data_[i]; }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  static constexpr std::size_t kPage = 4096;
  std::unique_ptr<void, Free> memory_;
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace sightline
