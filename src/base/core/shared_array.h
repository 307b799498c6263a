// A big immutable array that copies by reference.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace sightline {

/// An immutable array with shared ownership: a copy shares the memory, so an edited Scene stays cheap. At least 16 readable bytes follow
/// the last element, as Embree demands of vertex buffers that it shares.
template <class T>
class SharedArray {
 public:
  SharedArray() = default;

  /// Uninitialised (trivial T) array of `size` elements that `fill(std::span<T>)` writes once.
  template <class Fill>
  static SharedArray make(std::size_t size, Fill&& fill) {
    SharedArray result;
    if (size == 0) return result;
    constexpr std::size_t padding = (16 + sizeof(T) - 1) / sizeof(T);
    std::shared_ptr<T[]> data = std::make_shared_for_overwrite<T[]>(size + padding);
    for (std::size_t i = size; i < size + padding; ++i) data[i] = T{};
    fill(std::span<T>(data.get(), size));
    result.data_ = std::move(data);
    result.size_ = size;
    return result;
  }
  static SharedArray copy_of(std::span<const T> source) {
    return make(source.size(), [&](std::span<T> target) { std::copy(source.begin(), source.end(), target.begin()); });
  }
  SharedArray(const std::vector<T>& source) : SharedArray(copy_of(source)) {}

  std::span<const T> span() const { return {data_.get(), size_}; }
  const T* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  std::size_t size_bytes() const { return size_ * sizeof(T); }
  bool empty() const { return size_ == 0; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  /// Same memory, hence surely the same content: what edits compare.
  friend bool operator==(const SharedArray& a, const SharedArray& b) { return a.data_ == b.data_ && a.size_ == b.size_; }

 private:
  std::shared_ptr<const T[]> data_;
  std::size_t size_ = 0;
};

}  // namespace sightline
