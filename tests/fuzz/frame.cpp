// Checkpoints and slices from memory: any bytes end in a frame or in an Error. Mutations hardly ever keep the checksum, so it is mended
// first, or nothing behind it would be reached.
#include <xxhash.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "base/core/error.h"
#include "film/frame_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Magic, header bytes, payload bytes, checksum of all that follows.
  constexpr std::size_t checksum_at = 24, body_at = 32;
  std::vector<std::uint8_t> mended(data, data + size);
  if (size >= body_at) {
    const std::uint64_t checksum = XXH64(mended.data() + body_at, size - body_at, 1);
    std::memcpy(mended.data() + checksum_at, &checksum, sizeof checksum);
  }
  try {
    const sightline::StoredFrame stored = sightline::decode_frame(std::as_bytes(std::span(mended)), "fuzz.slice");
    // What info, merge and resume do with it.
    static_cast<void>(stored.frame.samples_done());
    static_cast<void>(stored.frame.to_layered_image());
    static_cast<void>(stored.frame.estimated_error());
  } catch (const sightline::Error& error) {
    if (error.code() != sightline::ErrorCode::input || error.place().empty()) __builtin_trap();
  }
  return 0;
}
