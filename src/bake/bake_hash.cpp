#include <fmt/format.h>
#include <xxhash.h>

#include <new>

#include "bake/bake_file.h"

namespace sightline {

struct BakeHash::State {
  XXH3_state_t* xxh = XXH3_createState();
  State() {
    if (xxh == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(xxh);
  }
  ~State() { XXH3_freeState(xxh); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

BakeHash::BakeHash() : state_(std::make_unique<State>()) {}
BakeHash::~BakeHash() = default;

BakeHash& BakeHash::add_bytes(std::span<const std::byte> bytes) {
  XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size());
  return *this;
}

std::array<std::uint64_t, 2> BakeHash::key() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  return {hash.high64, hash.low64};
}

std::string BakeId::key_text() const { return fmt::format("{:016x}{:016x}", key[0], key[1]); }

}  // namespace sightline
