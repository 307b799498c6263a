#include "methods/fragments/upsample.h"

#include <algorithm>
#include <array>

#include "methods/fragments/upsample_cells.h"
#include "methods/fragments/upsample_levels.h"
#include "methods/fragments/upsample_patch.h"
#include "methods/fragments/upsample_regions.h"

namespace sightline {
namespace {

constexpr int kBlock = 8;  // fragments are smaller, or made of blocks

class TileUpsampler {
 public:
  TileUpsampler(const GBuffer& g, const LightSignal& signal, const UpsampleOptions& options, const RootTile& tile,
                std::span<float* const> out)
      : g_(g), signal_(signal), cells_(g, signal, options.interpolate_probes), options_(options), tile_(tile) {
    for (std::size_t c = 0; c < channels(); ++c) out_[c] = out[c];
    if (options.kind == UpsampleOptions::Kind::multipass) upsample_levels(cells_, tile, out);
  }

  void run() const {
    for (int y = tile_.y0; y < tile_.y1; y += kBlock)
      for (int x = tile_.x0; x < tile_.x1; x += kBlock) {
        const int level = signal_.level[g_.at(x, y)], mask = (1 << level) - 1;
        if (level < 3)
          small_fragments(x, y);
        else if ((x & mask) == 0 && (y & mask) == 0)
          fragment(x, y, level);
      }
  }

 private:
  std::size_t channels() const { return static_cast<std::size_t>(signal_.channels); }
  std::array<float*, 3> texel(int x, int y) const {
    std::array<float*, 3> result{};
    for (std::size_t c = 0; c < channels(); ++c) result[c] = out_[c] + (y - tile_.y0) * kRootSize + (x - tile_.x0);
    return result;
  }

  // A block of fragments of up to 4 x 4 pixels.
  void small_fragments(int x0, int y0) const {
    // Quadrants of fragments of 2 x 2 are pixels.
    const int copied =
        std::max(options_.copy_levels, options_.interpolate_probes && options_.kind != UpsampleOptions::Kind::multipass ? 1 : 0);
    const int x1 = std::min(x0 + kBlock, tile_.x1), y1 = std::min(y0 + kBlock, tile_.y1);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const int level = signal_.level[g_.at(x, y)];
        if (level <= copied) {
          const int mask = level == 2 ? 1 : 0;
          const std::size_t from = g_.at(x & ~mask, y & ~mask), to = static_cast<std::size_t>((y - tile_.y0) * kRootSize + x - tile_.x0);
          for (std::size_t c = 0; c < channels(); ++c) out_[c][to] = signal_.value[c][from];
        } else if ((x & ((1 << level) - 1)) == 0 && (y & ((1 << level) - 1)) == 0) {
          fragment(x, y, level);
        }
      }
  }

  void fragment(int x0, int y0, int level) const {
    const int size = 1 << level, half = size / 2;
    if (level > options_.copy_levels && !options_.interpolate_probes) return cell({x0, y0, size});
    for (int y = y0; y < y0 + size && y < g_.height; y += half)
      for (int x = x0; x < x0 + size && x < g_.width; x += half) {
        const Cell quadrant{x, y, half};
        if (level > options_.copy_levels)
          cell(quadrant);
        else
          copy(quadrant);
      }
  }

  // The sample of a quadrant stands at its corner, whether it is a cell or not.
  void copy(const Cell& quadrant) const {
    std::array<float, 3> value{};
    for (std::size_t c = 0; c < channels(); ++c) value[c] = signal_.value[c][g_.at(quadrant.x, quadrant.y)];
    fill_cell(cells_, quadrant, value, texel(quadrant.x, quadrant.y), kRootSize);
  }

  void cell(const Cell& cell) const {
    using Kind = UpsampleOptions::Kind;
    if (options_.kind == Kind::multipass) return;
    const std::array<float*, 3> to = texel(cell.x, cell.y);
    if (cell.size == 1 || !cells_.speaks(cell.x, cell.y)) return fill_cell(cells_, cell, cells_.sample(cell).value, to, kRootSize);
    const bool probes = options_.interpolate_probes;
    if (options_.kind != Kind::quad4)
      interpolate_nearest(cells_, cell, options_.kind == Kind::rbf, probes, to, kRootSize);
    else if (probes)
      interpolate_patch(cells_, cell, to, kRootSize);
    else
      interpolate_corners(cells_, cell, true, to, kRootSize);
  }

  const GBuffer& g_;
  const LightSignal& signal_;
  const SignalCells cells_;
  const UpsampleOptions options_;
  const RootTile tile_;
  std::array<float*, 3> out_{};
};

}  // namespace

void upsample(const GBuffer& g, const LightSignal& signal, const UpsampleOptions& options, const RootTile& tile,
              std::span<float* const> out) {
  TileUpsampler(g, signal, options, tile, out).run();
}

}  // namespace sightline
