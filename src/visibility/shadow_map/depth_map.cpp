#include "visibility/shadow_map/depth_map.h"

#include <limits>

#include "base/math/frame.h"

namespace sightline {
namespace {}  // namespace

DepthMap::DepthMap(std::uint32_t resolution, std::uint32_t faces)
    : resolution_(resolution),
      tiles_across_((resolution + kTileSize - 1) / kTileSize),
      texel_size_(1 / static_cast<float>(resolution)),
      tile_count_(static_cast<std::size_t>(faces) * tiles_across_ * tiles_across_),
      texels_(tile_count_ * kTileTexels),
      begun_(std::make_unique<std::vector<std::atomic<std::uint8_t>>>(tile_count_)) {}

DepthMap DepthMap::around(const Vec3& position, std::uint32_t resolution) {
  DepthMap map(resolution, 6);
  map.origin_ = position;
  return map;
}

DepthMap DepthMap::along(const Vec3& travel, const Bounds& bounds, std::uint32_t resolution) {
  DepthMap map(resolution, 1);
  map.cube_ = false;
  const Frame3 frame = frame_from_normal(travel);
  map.u_ = frame.tangent, map.v_ = frame.bitangent, map.w_ = travel;
  const Vec3 center = bounds.is_empty() ? Vec3(0) : bounds.center();
  const Vec3 half = bounds.is_empty() ? Vec3(1) : 0.5f * bounds.extent();
  const auto reach = [&](const Vec3& axis) { return glm::dot(half, glm::abs(axis)); };
  map.half_ = std::max({reach(map.u_), reach(map.v_), std::numeric_limits<float>::min()}) * 1.0001f;
  map.origin_ = center - (reach(travel) + 0.01f * bounds.half_diagonal()) * travel;
  return map;
}

Ray DepthMap::ray_of(std::uint32_t face, std::uint32_t x, std::uint32_t y) const {
  if (x >= resolution_ || y >= resolution_) return {Vec3(0), 0, Vec3(0, 0, 1), -1};
  const float scale = 2 / static_cast<float>(resolution_);
  const float u = (static_cast<float>(x) + 0.5f) * scale - 1, v = (static_cast<float>(y) + 0.5f) * scale - 1;
  if (!cube_) return {origin_ + half_ * (u * u_ + v * v_), 0, w_, kInfinity};
  const int a = static_cast<int>(face / 2), b = a == 2 ? 0 : a + 1, c = b == 2 ? 0 : b + 1;
  Vec3 direction;
  direction[a] = face & 1 ? -1.f : 1.f, direction[b] = u, direction[c] = v;
  return {origin_, 0, glm::normalize(direction), kInfinity};
}

bool DepthMap::fill(std::size_t tile, const Tracer& tracer, Filler& filler, RayCounts& counts) const {
  const bool first = (*begun_)[tile].exchange(1, std::memory_order_relaxed) == 0;
  // Whoever comes second writes the same numbers once more instead of waiting, and counts nothing.
  RayCounts not_counted;
  const auto x0 = static_cast<std::uint32_t>(tile % tiles_across_) * kTileSize;
  const auto y0 = static_cast<std::uint32_t>(tile / tiles_across_ % tiles_across_) * kTileSize;
  const auto face = static_cast<std::uint32_t>(tile / tiles_across_ / tiles_across_);
  filler.rays.resize(kTileTexels);
  for (std::uint32_t y = y0; y < y0 + kTileSize; ++y) {
    for (std::uint32_t x = x0; x < x0 + kTileSize; ++x) filler.rays.set(index(face, x, y) % kTileTexels, ray_of(face, x, y));
  }
  tracer.intersect(filler.rays, filler.hits, BatchKind::primary, first ? counts : not_counted);
  const std::size_t first_texel = tile * kTileTexels;
  for (std::size_t i = 0; i < kTileTexels; ++i) {
    // 0 stands for a texel that is not filled.
    const float distance = filler.hits.hit(i) ? std::max(filler.hits.t[i], std::numeric_limits<float>::min()) : kInfinity;
    std::atomic_ref(texels_[first_texel + i]).store(distance, std::memory_order_relaxed);
  }
  return first;
}

}  // namespace sightline
