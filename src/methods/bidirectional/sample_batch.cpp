#include "methods/bidirectional/sample_batch.h"

#include <algorithm>

#include "base/sample/sobol.h"

namespace sightline::bidirectional {
namespace {

// A block of 4x4 pixels makes a packet of 16 rays.
constexpr int kBlockSize = 4;

int blocks_across(int pixels) { return (pixels + kBlockSize - 1) / kBlockSize; }

}  // namespace

std::vector<BatchRange> batches_of(const Tile& tile, SampleRange samples, std::size_t capacity) {
  const auto blocks =
      static_cast<std::size_t>(blocks_across(tile.x1 - tile.x0)) * static_cast<std::size_t>(blocks_across(tile.y1 - tile.y0));
  const std::size_t groups = std::max<std::size_t>(1, capacity / kLanes);
  const auto samples_a_batch = static_cast<std::uint32_t>(std::min<std::size_t>(samples.count(), groups));
  const std::size_t blocks_a_batch = std::max<std::size_t>(1, groups / std::max(1u, samples_a_batch));
  std::vector<BatchRange> batches;
  for (std::size_t first = 0; first < blocks; first += blocks_a_batch) {
    for (std::uint32_t begin = samples.begin; begin < samples.end; begin += samples_a_batch)
      batches.push_back({tile, first, std::min(blocks_a_batch, blocks - first), {begin, std::min(begin + samples_a_batch, samples.end)}});
  }
  return batches;
}

void start_batch(const BatchRange& range, int width, std::uint64_t seed, bool guides, SampleBatch& batch) {
  const std::size_t count = range.block_count * range.samples.count() * kLanes;
  batch.count = count;
  for (auto* numbers : {&batch.pixel, &batch.sample, &batch.key}) numbers->resize(count);
  batch.in_picture.resize(count);
  batch.direct.assign(count, Color(0)), batch.indirect.assign(count, Color(0));
  batch.guides.assign(guides ? count : 0, {});
  batch.splats.clear();
  const Tile& tile = range.tile;
  const int across = blocks_across(tile.x1 - tile.x0);
  std::size_t at = 0;
  for (std::size_t block = range.first_block; block < range.first_block + range.block_count; ++block) {
    const int x0 = tile.x0 + kBlockSize * (static_cast<int>(block) % across),
              y0 = tile.y0 + kBlockSize * (static_cast<int>(block) / across);
    for (std::uint32_t sample = range.samples.begin; sample < range.samples.end; ++sample) {
      for (int lane = 0; lane < static_cast<int>(kLanes); ++lane, ++at) {
        const int x = x0 + lane % kBlockSize, y = y0 + lane / kBlockSize;
        batch.in_picture[at] = x < tile.x1 && y < tile.y1;
        batch.pixel[at] = static_cast<std::uint32_t>(std::min(y, tile.y1 - 1) * width + std::min(x, tile.x1 - 1));
        batch.sample[at] = sample;
        batch.key[at] = pixel_key(seed, batch.pixel[at]);
      }
    }
  }
}

}  // namespace sightline::bidirectional
