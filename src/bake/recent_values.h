// What takes milliseconds to make is no bake, but need not be made for every frame.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>

#include "bake/bake_file.h"

namespace sightline {

/// Values by identity, in memory alone: those used last, up to a number of bytes. Thread-safe.
class RecentValues {
 public:
  explicit RecentValues(std::uint64_t most_bytes = std::uint64_t{128} << 20) : most_bytes_(most_bytes) {}

  /// The value of `id`, which `make` returns where it is not known. T::bytes() says how large it is; one kind has one T.
  template <class T, class Make>
  std::shared_ptr<const T> get(const BakeId& id, const Make& make) {
    if (std::shared_ptr<const void> known = find(id)) return std::static_pointer_cast<const T>(known);
    auto made = std::make_shared<const T>(make());
    add(id, made, made->bytes());
    return made;
  }
  std::uint64_t bytes() const;

 private:
  struct Value {
    BakeId id;
    std::shared_ptr<const void> held;
    std::uint64_t bytes;
  };
  std::shared_ptr<const void> find(const BakeId& id);
  void add(const BakeId& id, std::shared_ptr<const void> value, std::uint64_t bytes);

  std::uint64_t most_bytes_, bytes_ = 0;
  mutable std::mutex mutex_;
  std::list<Value> values_;  ///< last used first
};

}  // namespace sightline
