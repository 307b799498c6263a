// Fragments, what their probes saw, and how that splits them: the pure logic of the method.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace sightline {

/// A square of 2^level pixels with its corner at pixel (x, y), a multiple of its width.
struct Fragment {
  std::uint16_t x = 0, y = 0;
  std::uint8_t level = 0;
  int width() const { return 1 << level; }
  friend bool operator==(const Fragment&, const Fragment&) = default;
};

/// Quadrants as bits of quadrant indices: 1 = right, 2 = lower.
enum Quadrant : std::uint8_t { kTopLeft = 0, kTopRight = 1, kBottomLeft = 2, kBottomRight = 3 };

/// Which of the light's points each quadrant sees: bit k is point k.
using ProbeMasks = std::array<std::uint64_t, 4>;

/// Points that some quadrants see and others do not: the OR of all six XORs [Koa2017, Eq. 1, with the signs that print lost] has a bit
/// exactly where the four are not all equal.
constexpr std::uint64_t ray_difference(const ProbeMasks& m) { return (m[0] | m[1] | m[2] | m[3]) & ~(m[0] & m[1] & m[2] & m[3]); }
/// The most points that a quadrant sees: 0 = all is dark (Rays_M).
constexpr int most_visible(const ProbeMasks& m) {
  return std::max(std::max(std::popcount(m[0]), std::popcount(m[1])), std::max(std::popcount(m[2]), std::popcount(m[3])));
}

/// The pairs of quadrants that share an edge, the gradients of the paper: A^D, B^A, C^B, D^C.
inline constexpr std::array<std::array<std::uint8_t, 2>, 4> kNeighbours = {
    {{kTopLeft, kBottomLeft}, {kTopRight, kTopLeft}, {kBottomRight, kTopRight}, {kBottomLeft, kBottomRight}}};

struct SplitOptions {
  int rays = 16;                  ///< points of the light (K)
  int gradient = 7;               ///< of 16
  bool subdivide_twice = true;    ///< gradient-aware subdivision
  bool strict_threshold = false;  ///< `more than` instead of `at least` the threshold
  int pixel_threshold = 2;        ///< of 16, for fragments of two pixels
};

/// How many differing points make a fragment unstable: of 16, pixel_threshold at two pixels, two at four, one from eight on [Koa2017, with
/// two at two].
constexpr int threshold(int level, const SplitOptions& o) {
  return std::max(1, (level <= 1 ? o.pixel_threshold : level == 2 ? 2 : 1) * o.rays / 16) + (o.strict_threshold ? 1 : 0);
}
constexpr bool is_stable(int level, const ProbeMasks& masks, const SplitOptions& o) {
  return std::popcount(ray_difference(masks)) < threshold(level, o);
}

/// Bit q: quadrant q lies at a steep gradient and skips a level.
constexpr unsigned fine_quadrants(const ProbeMasks& masks, const SplitOptions& o) {
  unsigned fine = 0;
  for (const auto& [p, q] : kNeighbours) {
    if (std::popcount(masks[p] ^ masks[q]) * 16 > o.gradient * o.rays) fine |= 1u << p | 1u << q;
  }
  return o.subdivide_twice ? fine : 0u;
}

/// Gradient-aware subdivision: 4 to 16 children, quadrant by quadrant; those of level 1 or less are pixels' parents no more: level 0.
inline void subdivide(const Fragment& f, unsigned fine, std::vector<Fragment>& children) {
  const int half = f.width() / 2;
  for (unsigned q = 0; q < 4; ++q) {
    const int x = f.x + (q & 1 ? half : 0), y = f.y + (q & 2 ? half : 0);
    if (!(fine >> q & 1) || f.level < 2) {
      children.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), static_cast<std::uint8_t>(f.level - 1)});
      continue;
    }
    const int quarter = half / 2;
    for (unsigned k = 0; k < 4; ++k)
      children.push_back({static_cast<std::uint16_t>(x + (k & 1 ? quarter : 0)), static_cast<std::uint16_t>(y + (k & 2 ? quarter : 0)),
                          static_cast<std::uint8_t>(f.level - 2)});
  }
}

}  // namespace sightline
