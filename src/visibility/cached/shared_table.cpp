#include "visibility/cached/shared_table.h"

#include <algorithm>

#include "base/parallel/parallel.h"

namespace sightline {

void SharedTable::clear(const Context& context) {
  const std::size_t part_size = table_.size() / kParts;
  parallel_for(context, kParts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part) {
      std::vector<std::uint32_t>& written = written_[part];
      // One write in sixteen, and filling the whole part is as cheap.
      if (written.size() > part_size / 16)
        table_.erase_range(part * part_size, part_size);
      else
        for (const std::uint32_t index : written) table_.erase_range(index, 1);
      written.clear();
    }
  });
}

}  // namespace sightline
