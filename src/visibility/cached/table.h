// The cache itself: 32-bit slots that are overwritten when keys collide [Popov2013, §4.1].
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace sightline {

/// What a slot holds besides the digest of its key. 0 is an empty slot.
struct SlotFormat {
  bool counters = false;

  /// One bit: the answer. Counters: rays that reached the light, and rays that did not, three bits each.
  static constexpr std::uint32_t kBit = 1, kVisible = 8, kHidden = 1, kCount = 7;

  std::uint32_t payload_mask() const { return counters ? 63 : 1; }
  /// The digest as the slot holds it, never 0.
  std::uint32_t tag(std::uint32_t digest) const {
    const std::uint32_t kept = digest & ~payload_mask();
    return kept != 0 ? kept : payload_mask() + 1;
  }
  bool matches(std::uint32_t slot, std::uint32_t tag_value) const { return (slot ^ tag_value) <= payload_mask(); }
  /// The slot of key `tag_value` after one more ray.
  std::uint32_t after(std::uint32_t slot, std::uint32_t tag_value, bool visible) const {
    if (!counters) return tag_value | (visible ? kBit : 0);
    const std::uint32_t old = matches(slot, tag_value) ? slot & 63 : 0;
    const std::uint32_t hidden = old & kCount, seen = old >> 3;
    return tag_value | (visible && seen < kCount ? old + kVisible : !visible && hidden < kCount ? old + kHidden : old);
  }
};

/// Slots that remember where they were written, so that clearing costs as much as was inserted: a table that is only salted anew would
/// answer with another scope's ray once in 2^31 look-ups, and which one would depend on the threads.
class SlotTable {
 public:
  SlotTable() = default;
  explicit SlotTable(int bits);

  int bits() const { return bits_; }
  std::size_t size() const { return bits_ == 0 ? 0 : std::size_t{1} << bits_; }
  std::size_t bytes() const { return size() * sizeof(std::uint32_t); }
  const std::uint32_t* data() const { return slots_.get(); }

  void insert(std::uint32_t index, std::uint32_t tag, bool visible, SlotFormat format) {
    std::uint32_t& slot = slots_[index];
    if (slot == 0) note(index);
    slot = format.after(slot, tag, visible);
  }
  /// For threads that insert into ranges of their own: returns whether the slot was empty, and leaves it to the caller to clear.
  bool insert_unnoted(std::uint32_t index, std::uint32_t tag, bool visible, SlotFormat format) {
    std::uint32_t& slot = slots_[index];
    const bool was_empty = slot == 0;
    slot = format.after(slot, tag, visible);
    return was_empty;
  }
  void erase_range(std::size_t first, std::size_t count) { std::fill_n(slots_.get() + first, count, 0u); }
  void clear();

 private:
  struct Release {
    void operator()(std::uint32_t* p) const;
  };
  void note(std::uint32_t index) {
    if (written_.size() < limit_)
      written_.push_back(index);
    else
      overflowed_ = true;
  }

  std::unique_ptr<std::uint32_t[], Release> slots_;
  std::vector<std::uint32_t> written_;
  std::size_t limit_ = 0;
  int bits_ = 0;
  bool overflowed_ = false;
};

}  // namespace sightline
