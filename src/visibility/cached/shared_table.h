// The table that waves share: filled by several threads side by side, each its own range of slots.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/core/context.h"
#include "visibility/cached/table.h"

namespace sightline {

class SharedTable {
 public:
  /// Parts by the upper bits of the slot.
  static constexpr int kPartBits = 6;
  static constexpr std::size_t kParts = std::size_t{1} << kPartBits;

  explicit SharedTable(int bits) : table_(bits) {}
  const SlotTable& table() const { return table_; }
  std::size_t part_of(std::uint32_t index) const { return index >> (table_.bits() - kPartBits); }
  /// One thread a part at a time.
  void insert(std::uint32_t index, std::uint32_t tag, bool visible, SlotFormat format) {
    if (table_.insert_unnoted(index, tag, visible, format)) written_[part_of(index)].push_back(index);
  }
  /// Empties the table with the threads of `context`.
  void clear(const Context& context);

 private:
  SlotTable table_;
  std::array<std::vector<std::uint32_t>, kParts> written_;  ///< what clearing has to visit
};

}  // namespace sightline
