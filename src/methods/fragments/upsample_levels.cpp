#include "methods/fragments/upsample_levels.h"

#include <array>
#include <cstdint>
#include <vector>

namespace sightline {
namespace {

/// The texels of one level over a root tile and one more all around.
struct Level {
  int side = 0;               // texels of the tile a side; coordinates are -1 .. side
  std::vector<float> weight;  // 1: has a value that others may use
  std::array<std::vector<float>, 3> value;

  Level(int log_width, std::size_t channels) : side(kRootSize >> log_width) {
    const std::size_t n = static_cast<std::size_t>(side + 2) * static_cast<std::size_t>(side + 2);
    weight.resize(n);
    for (std::size_t c = 0; c < channels; ++c) value[c].resize(n);
  }
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(j + 1) * static_cast<std::size_t>(side + 2) + static_cast<std::size_t>(i + 1);
  }
};

class Pyramid {
 public:
  Pyramid(const SignalCells& cells, const RootTile& tile)
      : cells_(cells), tile_(tile), channels_(static_cast<std::size_t>(cells.channels())) {}

  Level finest() {
    Level coarse(kRootLevel, channels_);
    fill(kRootLevel, nullptr, coarse);
    for (int log_width = kRootLevel - 1; log_width >= 0; --log_width) {
      Level fine(log_width, channels_);
      fill(log_width, &coarse, fine);
      coarse = std::move(fine);
    }
    return coarse;
  }

 private:
  void fill(int log_width, const Level* coarser, Level& level) const {
    const int width = 1 << log_width;
    for (int j = -1; j <= level.side; ++j) {
      for (int i = -1; i <= level.side; ++i) {
        const int x = tile_.x0 + i * width, y = tile_.y0 + j * width;
        if (!cells_.g().inside(x, y)) continue;
        const Cell cell = cells_.cell(x, y);
        const std::size_t at = level.at(i, j);
        if (cell.size == width) {
          const SignalSample sample = cells_.sample(cell);
          level.weight[at] = cells_.speaks(x, y) ? 1.f : 0.f;
          for (std::size_t c = 0; c < channels_; ++c) level.value[c][at] = sample.value[c];
        } else if (cell.size > width && coarser) {
          interpolate(*coarser, i, j, level);
        }
      }
    }
  }

  // The parent texel has weight 9/16, its neighbours towards (i, j) 3/16, 3/16 and 1/16. Arithmetic shift: texel -1 has parent -1.
  void interpolate(const Level& coarser, int i, int j, Level& level) const {
    const int pi = i >> 1, pj = j >> 1, ni = i & 1 ? pi + 1 : pi - 1, nj = j & 1 ? pj + 1 : pj - 1;
    const std::size_t at = level.at(i, j), parent = coarser.at(pi, pj);
    const std::array<std::size_t, 3> others = {coarser.at(ni, pj), coarser.at(pi, nj), coarser.at(ni, nj)};
    level.weight[at] = coarser.weight[parent];
    std::array<float, 3> weight = {3, 3, 1};
    float sum = 9;
    for (std::size_t k = 0; k < 3; ++k) weight[k] *= coarser.weight[others[k]] * coarser.weight[parent], sum += weight[k];
    for (std::size_t c = 0; c < channels_; ++c) {
      const float own = coarser.value[c][parent];
      float difference = 0;
      for (std::size_t k = 0; k < 3; ++k) difference += weight[k] * (coarser.value[c][others[k]] - own);
      level.value[c][at] = own + difference / sum;
    }
  }

  const SignalCells& cells_;
  const RootTile tile_;
  const std::size_t channels_;
};

}  // namespace

void upsample_levels(const SignalCells& cells, const RootTile& tile, std::span<float* const> out) {
  const Level finest = Pyramid(cells, tile).finest();
  for (std::size_t c = 0; c < static_cast<std::size_t>(cells.channels()); ++c)
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x)
        out[c][(y - tile.y0) * kRootSize + x - tile.x0] = finest.value[c][finest.at(x - tile.x0, y - tile.y0)];
}

}  // namespace sightline
