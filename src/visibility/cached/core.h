// What all workers and waves of one cached visibility share.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include "visibility/cached/hash.h"
#include "visibility/cached/quantizer.h"
#include "visibility/cached/table.h"
#include "visibility/visibility.h"

namespace sightline {

struct CacheCore {
  CacheCore(std::shared_ptr<const World> w, const CachedVisibilitySettings& s)
      : world(std::move(w)), settings(s), quantizer(world->bounds(), settings) {}

  std::shared_ptr<const World> world;
  const CachedVisibilitySettings settings;
  const Quantizer quantizer;
  VisibilityPass pass;
  std::atomic<std::uint64_t> bytes{0};

  SlotFormat format() const { return {settings.counters > 0}; }
  CacheSalt salt(std::uint32_t first_sample, std::uint32_t frame, std::uint32_t scope) const {
    CacheSalt s{first_sample, frame};
    mix_pair(s.a, s.b);
    s.a ^= scope;
    mix_pair(s.a, s.b);
    return s;
  }
};

/// Whether the residual's ray is traced for this query [Sightline: README.md]: a number in [0, 1) of the identities of both ends.
inline float residual_number(std::uint32_t eye_id, std::uint32_t light_id, std::uint32_t first_sample) {
  std::uint32_t a = eye_id, b = light_id ^ (first_sample * HashConstants::kMix1);
  mix_pair(a, b);
  return static_cast<float>(b >> 8) * 0x1p-24f;
}

}  // namespace sightline
