// Finds equal keys among the misses of a group: one ray each.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sightline {

/// Open addressing; emptied by counting on, without touching the entries.
class MissSet {
 public:
  void begin(std::size_t most_keys) {
    const std::size_t size = std::bit_ceil(2 * most_keys + 16);
    if (entries_.size() < size) entries_.assign(size, {}), round_ = 0;
    shift_ = 64 - std::countr_zero(entries_.size());
    if (++round_ == 0) entries_.assign(entries_.size(), {}), round_ = 1;
  }
  /// The value of the key that came first, which is `value` if this one did.
  std::uint32_t first(std::uint32_t index, std::uint32_t tag, std::uint32_t value) {
    const std::uint64_t key = (static_cast<std::uint64_t>(index) << 32) | tag;
    for (std::size_t at = (key * 0x9e3779b97f4a7c15ull) >> shift_;; at = (at + 1) & (entries_.size() - 1)) {
      Entry& entry = entries_[at];
      if (entry.round != round_) {
        entry = {key, value, round_};
        return value;
      }
      if (entry.key == key) return entry.value;
    }
  }

 private:
  struct Entry {
    std::uint64_t key = 0;
    std::uint32_t value = 0, round = 0;
  };
  std::vector<Entry> entries_;
  std::uint32_t round_ = 0;
  int shift_ = 0;
};

}  // namespace sightline
