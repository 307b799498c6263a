// Made-up pictures cut into fragments, for tests of upsampling.
#pragma once

#include <hwy/targets.h>

#include <functional>
#include <vector>

#include "base/math/vec3_batch.h"
#include "methods/fragments/upsample.h"
#include "support/every_target.h"

namespace sightline::test {

/// A G-buffer of a plane that faces the camera: pixel (x, y) sees (x, y, 0) / 100 from a distance of 10.
inline GBuffer flat_picture(int width, int height) {
  GBuffer g;
  g.resize(width, height);
  std::fill(g.kind.begin(), g.kind.end(), PixelKind::background);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = g.at(x, y);
      store(g.position, i, Vec3{static_cast<float>(x), static_cast<float>(y), 0} / 100.f);
      store(g.geometric_normal, i, {0, 0, 1}), store(g.shading_normal, i, {0, 0, 1});
      g.depth[i] = 10, g.kind[i] = PixelKind::diffuse;
    }
  return g;
}

using Field = std::function<float(float x, float y)>;

/// Fragments of the levels that `level` gives (called with a fragment's corner and a level: whether to stop there), with the field's
/// values as samples at the centres of quadrants and at additional samples. Channel c has (c + 1) times the field.
inline LightSignal cut(const GBuffer& g, int channels, const std::function<bool(int x, int y, int level)>& stop, const Field& field,
                       bool extras = true) {
  LightSignal signal;
  signal.resize(g, channels);
  for (auto& v : signal.value) std::fill(v.begin(), v.end(), 1e30f);  // must not be read where it has no meaning
  for (auto& v : signal.extra) std::fill(v.begin(), v.end(), 1e30f);
  const auto put = [&](auto& values, int x, int y, float v) {
    for (int c = 0; c < channels; ++c) values[static_cast<std::size_t>(c)][g.at(x, y)] = static_cast<float>(c + 1) * v;
  };
  const std::function<void(int, int, int)> visit = [&](int x0, int y0, int level) {
    if (x0 >= g.width || y0 >= g.height) return;
    const int w = 1 << level, half = w / 2;
    if (level > 0 && !stop(x0, y0, level)) {
      for (const int dy : {0, half})
        for (const int dx : {0, half}) visit(x0 + dx, y0 + dy, level - 1);
      return;
    }
    for (int y = y0; y < std::min(y0 + w, g.height); ++y)
      for (int x = x0; x < std::min(x0 + w, g.width); ++x) signal.level[g.at(x, y)] = static_cast<std::uint8_t>(level);
    if (level == 0) return put(signal.value, x0, y0, field(static_cast<float>(x0) + 0.5f, static_cast<float>(y0) + 0.5f));
    for (const int dy : {0, half})
      for (const int dx : {0, half}) {
        if (!g.inside(x0 + dx, y0 + dy)) continue;
        const float centre = 0.5f * static_cast<float>(half);
        put(signal.value, x0 + dx, y0 + dy, field(static_cast<float>(x0 + dx) + centre, static_cast<float>(y0 + dy) + centre));
        if (level > 2 && extras && !(dx && dy)) {
          signal.flags[g.at(x0 + dx, y0 + dy)] |= LightSignal::kExtra;
          put(signal.extra, x0 + dx, y0 + dy, field(static_cast<float>(x0 + dx) + 0.5f, static_cast<float>(y0 + dy) + 0.5f));
        }
      }
  };
  for (int y = 0; y < g.height; y += kRootSize)
    for (int x = 0; x < g.width; x += kRootSize) visit(x, y, kRootLevel);
  return signal;
}

inline std::function<bool(int, int, int)> all_of_level(int level) {
  return [level](int, int, int l) { return l <= level; };
}
/// A reproducible mixture of all levels: about one in `one_in` fragments stops.
inline std::function<bool(int, int, int)> mixture(std::uint32_t seed, std::uint32_t one_in = 3) {
  return [=](int x, int y, int level) {
    std::uint32_t h = seed ^ (static_cast<std::uint32_t>(x) * 0x9e3779b9u) ^ (static_cast<std::uint32_t>(y) * 0x85ebca6bu) ^
                      (static_cast<std::uint32_t>(level) * 0xc2b2ae35u);
    h = (h ^ (h >> 15)) * 0x2c1b3c6du, h = (h ^ (h >> 12)) * 0x297a2d39u, h ^= h >> 15;
    return h % one_in == 0;
  };
}

/// The whole picture, row-major without padding, a channel each. What lies outside a tile's part of the picture must stay untouched.
struct Upsampled {
  std::array<std::vector<float>, 3> channel;
  bool in_bounds = true;
};
inline Upsampled upsample_all(const GBuffer& g, const LightSignal& signal, const UpsampleOptions& options) {
  constexpr float kUntouched = -7;
  Upsampled result;
  const auto n = static_cast<std::size_t>(g.width) * static_cast<std::size_t>(g.height);
  for (int c = 0; c < signal.channels; ++c) result.channel[static_cast<std::size_t>(c)].resize(n);
  for (std::size_t t = 0; t < g.root_count(); ++t) {
    const RootTile tile = g.root(t);
    std::array<AlignedVector<float>, 3> buffer;
    std::array<float*, 3> out{};
    for (std::size_t c = 0; c < static_cast<std::size_t>(signal.channels); ++c)
      buffer[c].assign(kRootSize * kRootSize, kUntouched), out[c] = buffer[c].data();
    upsample(g, signal, options, tile, std::span<float* const>(out.data(), static_cast<std::size_t>(signal.channels)));
    for (std::size_t c = 0; c < static_cast<std::size_t>(signal.channels); ++c)
      for (int y = tile.y0; y < tile.y0 + kRootSize; ++y)
        for (int x = tile.x0; x < tile.x0 + kRootSize; ++x) {
          const float v = buffer[c][static_cast<std::size_t>((y - tile.y0) * kRootSize + x - tile.x0)];
          if (x < tile.x1 && y < tile.y1)
            result.channel[c][static_cast<std::size_t>(y * g.width + x)] = v;
          else
            result.in_bounds = result.in_bounds && v == kUntouched;
        }
  }
  return result;
}

}  // namespace sightline::test
