#include "bake/recent_values.h"

#include <algorithm>

namespace sightline {

std::uint64_t RecentValues::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

std::shared_ptr<const void> RecentValues::find(const BakeId& id) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(values_.begin(), values_.end(), [&](const Value& value) { return value.id == id; });
  if (found == values_.end()) return nullptr;
  values_.splice(values_.begin(), values_, found);
  return found->held;
}

void RecentValues::add(const BakeId& id, std::shared_ptr<const void> value, std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  values_.push_front({id, std::move(value), bytes});
  bytes_ += bytes;
  // The newest stays, however large it is.
  while (bytes_ > most_bytes_ && values_.size() > 1) bytes_ -= values_.back().bytes, values_.pop_back();
}

}  // namespace sightline
