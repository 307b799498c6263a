// Any bytes given to the PFM reader end in a picture or in sightline::Error.
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/core/error.h"
#include "image/io/formats.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  try {
    static_cast<void>(sightline::parse_pfm(bytes));
  } catch (const sightline::Error&) {
    // What a damaged file should end in.
  }
  return 0;
}
