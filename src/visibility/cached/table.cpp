#include "visibility/cached/table.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "base/core/error.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace sightline {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;

}  // namespace

void SlotTable::Release::operator()(std::uint32_t* p) const { std::free(p); }

SlotTable::SlotTable(int bits) : bits_(bits) {
  // Aligned so that the system may back it with huge pages: look-ups go all over it.
  const std::size_t allocated = (bytes() + kHugePage - 1) / kHugePage * kHugePage;
  void* memory = std::aligned_alloc(kHugePage, allocated);
  if (memory == nullptr)
    throw resource_error("no memory for a visibility cache of " + std::to_string(bytes() >> 20) + " MiB")
        .remedy("smaller table_bits or shared_table_bits");
#ifdef MADV_HUGEPAGE
  (void)madvise(memory, allocated, MADV_HUGEPAGE);  // a wish; without it look-ups are a little slower
#endif
  slots_.reset(static_cast<std::uint32_t*>(memory));
  std::fill_n(slots_.get(), size(), 0u);
  // Beyond this many, clearing all of it is as cheap.
  limit_ = size() / 16;
}

void SlotTable::clear() {
  if (overflowed_)
    std::fill_n(slots_.get(), size(), 0u);
  else
    for (const std::uint32_t index : written_) slots_[index] = 0;
  written_.clear();
  overflowed_ = false;
}

}  // namespace sightline
