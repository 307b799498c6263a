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

/// Of a query, where answers are corrected by rays: it had a ray of its own; its cell was refined.
inline constexpr std::uint8_t kMarkTraced = 1, kMarkEdge = 2;

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

/// Which cached answers are corrected by a ray, by the identities of both ends.
class ResidualChoice {
 public:
  ResidualChoice(const CachedVisibilitySettings& settings, const VisibilityPass& pass)
      : inside_(settings.residual),
        edge_(settings.residual * settings.residual_edge < 1 ? settings.residual * settings.residual_edge : 1.f),
        salt_(pass.first_sample * HashConstants::kMix1) {}
  float probability(bool at_edge) const { return at_edge ? edge_ : inside_; }
  bool taken(const QueryBatch& queries, std::size_t i, float probability) const {
    std::uint32_t a = queries.eye.id[queries.eye_of[i]], b = queries.light.id[queries.light_of[i]] ^ salt_;
    mix_pair(a, b);
    return static_cast<float>(b >> 8) * 0x1p-24f < probability;
  }

 private:
  float inside_, edge_;
  std::uint32_t salt_;
};

}  // namespace sightline
