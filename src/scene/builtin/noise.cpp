#include "scene/builtin/noise.h"

#include <algorithm>

#include "scene/builtin/seeded.h"

namespace sightline::builtin {
namespace {

float fade_curve(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

}  // namespace

NoiseGrid::NoiseGrid(std::uint64_t seed, int resolution, int frequency, int octaves) : resolution_(resolution) {
  for (int o = 0; o < octaves; ++o) {
    Octave octave{
        .cells = frequency << o, .amplitude = 1 / static_cast<float>(1 << o), .gradients = {}, .first = {}, .offset = {}, .fade = {}};
    Seeded random(seed, static_cast<std::uint64_t>(o));
    const std::size_t side = static_cast<std::size_t>(octave.cells) + 1;
    for (std::size_t i = 0; i < side * side * side; ++i) octave.gradients.push_back(octave.amplitude * random.on_sphere());
    octave.first.assign(side, resolution + 1);
    for (int i = 0; i <= resolution; ++i) {
      // In double: every point must fall into the same cell with the same offset, whoever asks.
      const double x = static_cast<double>(i) * octave.cells / resolution;
      const int cell = std::min(static_cast<int>(x), octave.cells - 1);
      octave.offset.push_back(static_cast<float>(x - cell));
      octave.fade.push_back(fade_curve(octave.offset.back()));
      int& first = octave.first[static_cast<std::size_t>(cell)];
      first = std::min(first, i);
    }
    // A cell without points begins where the next one does.
    for (std::size_t c = side - 1; c-- > 0;) octave.first[c] = std::min(octave.first[c], octave.first[c + 1]);
    octaves_.push_back(std::move(octave));
  }
}

void NoiseGrid::row(int y, int z, std::span<float> values) const {
  std::fill(values.begin(), values.end(), 0.f);
  for (const Octave& o : octaves_) {
    const std::size_t side = static_cast<std::size_t>(o.cells) + 1;
    const auto cell_of = [&](int i) { return std::min(static_cast<int>(static_cast<double>(i) * o.cells / resolution_), o.cells - 1); };
    const auto cy = static_cast<std::size_t>(cell_of(y)), cz = static_cast<std::size_t>(cell_of(z));
    const float dy = o.offset[static_cast<std::size_t>(y)], dz = o.offset[static_cast<std::size_t>(z)];
    const float wy = o.fade[static_cast<std::size_t>(y)], wz = o.fade[static_cast<std::size_t>(z)];
    // A lattice column adds base + slope * dx, blended over its four lattice points in y and z.
    const auto column = [&](std::size_t cx) {
      float base = 0, slope = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t ky = k & 1, kz = k >> 1;
        const Vec3& g = o.gradients[((cz + kz) * side + cy + ky) * side + cx];
        const float weight = (ky ? wy : 1 - wy) * (kz ? wz : 1 - wz);
        base += weight * (g.y * (dy - static_cast<float>(ky)) + g.z * (dz - static_cast<float>(kz)));
        slope += weight * g.x;
      }
      return Vec2(base, slope);
    };
    Vec2 left = column(0);
    for (std::size_t cx = 0; cx + 1 < side; ++cx) {
      const Vec2 right = column(cx + 1);
      const float right_base = right.x - right.y;
      const auto begin = static_cast<std::size_t>(o.first[cx]);
      const auto end = cx + 2 < side ? static_cast<std::size_t>(o.first[cx + 1]) : values.size();
      const float *dx = o.offset.data(), *fade = o.fade.data();
      for (std::size_t i = begin; i < end; ++i) {
        const float a = left.x + left.y * dx[i], b = right_base + right.y * dx[i];
        values[i] += a + fade[i] * (b - a);
      }
      left = right;
    }
  }
}

}  // namespace sightline::builtin
