// A SharedArray while its loader still fills it.
#pragma once

#include <cstddef>
#include <span>

#include "base/core/shared_array.h"

namespace sightline {

/// Several arrays of one mesh are filled side by side, which SharedArray::make alone does not allow. `values` may be written until
/// `array` is handed on.
template <class T>
struct ArrayBuilder {
  SharedArray<T> array;
  std::span<T> values;

  ArrayBuilder() = default;
  explicit ArrayBuilder(std::size_t size) {
    array = SharedArray<T>::make(size, [this](std::span<T> fresh) { values = fresh; });
  }
  ArrayBuilder(const ArrayBuilder&) = delete;
  ArrayBuilder& operator=(const ArrayBuilder&) = delete;
};

}  // namespace sightline
