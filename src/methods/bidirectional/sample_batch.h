// Some samples of some pixels of a tile, and what has been found out about them.
#pragma once

#include <cstdint>
#include <vector>

#include "base/core/aligned.h"
#include "film/frame.h"

namespace sightline::bidirectional {

/// Light that arrived from the scene at a film position.
struct Splat {
  Vec2 film{0};
  Color value{0};
  bool direct = false;  ///< at most one surface between light and camera
  std::uint32_t sample = 0;
};

/// First surface of a path, for the guide layers.
struct Guide {
  Color albedo{0};
  Vec3 normal{0}, position{0};
  float depth = 0;
  bool hit = false, emits = false;
};

/// Structure of arrays over paths: lane groups of 16 pixels of a 4x4 block that share their sample.
struct SampleBatch {
  std::size_t count = 0;
  AlignedVector<std::uint32_t> pixel, sample, key;
  AlignedVector<std::uint8_t> in_picture;  ///< 0: fills up a block that sticks out of the tile
  std::vector<Color> direct, indirect;
  std::vector<Guide> guides;  ///< only if layers ask for them
  std::vector<Splat> splats;

  void add(std::uint32_t path, bool is_direct, const Color& value) { (is_direct ? direct : indirect)[path] += value; }
};

/// The part of a picture that makes one batch.
struct BatchRange {
  Tile tile;
  std::size_t first_block = 0, block_count = 0;  ///< blocks of 4x4 pixels, row by row
  SampleRange samples;
};

/// Cuts samples of a tile into batches of at most `capacity` paths (at least 16).
std::vector<BatchRange> batches_of(const Tile& tile, SampleRange samples, std::size_t capacity);

/// Fills in pixels, samples and keys; radiance is 0.
void start_batch(const BatchRange& range, int width, std::uint64_t seed, bool guides, SampleBatch& batch);

}  // namespace sightline::bidirectional
