// Every pixel once, spread out first.
#include "methods/visibility_cache/pixel_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sightline {
namespace {

struct Size {
  int width, height;
};
const Size kSizes[] = {{32, 32}, {13, 7}, {7, 13}, {1, 1}, {1, 9}, {32, 1}, {31, 27}, {28, 28}};

TEST(PixelOrder, EveryPixelComesOnce) {
  for (const Size& size : kSizes) {
    std::vector<std::uint32_t> all(static_cast<std::size_t>(size.width * size.height));
    std::iota(all.begin(), all.end(), 0u);
    for (const double first : {0.0, 1.0, 4.5, 16.0, 1e9}) {
      for (const double growth : {0.5, 1.0, 2.0, 3.7}) {
        std::vector<std::uint32_t> order = halton_order(size.width, size.height, first, growth);
        std::sort(order.begin(), order.end());
        EXPECT_EQ(order, all) << size.width << "x" << size.height << " " << first << " " << growth;
      }
    }
    EXPECT_EQ(scanline_order(size.width, size.height), all);
  }
  EXPECT_TRUE(halton_order(0, 5, 1, 2).empty());
  EXPECT_TRUE(scanline_order(3, 0).empty());
}

double distance(std::uint32_t p, std::uint32_t q, std::uint32_t width) {
  return std::hypot(static_cast<double>(p % width) - static_cast<double>(q % width),
                    static_cast<double>(p / width) - static_cast<double>(q / width));
}

// Largest distance of a pixel from the first `count`, in units of the spacing that so many would have in a grid.
double covering_radius(const std::vector<std::uint32_t>& order, std::size_t count, std::uint32_t width) {
  double largest = 0;
  for (const std::uint32_t pixel : order) {
    double nearest = 1e9;
    for (std::size_t k = 0; k < count; ++k) nearest = std::min(nearest, distance(pixel, order[k], width));
    largest = std::max(largest, nearest);
  }
  return largest / std::sqrt(static_cast<double>(order.size()) / static_cast<double>(count));
}

TEST(PixelOrder, EverySegmentCoversTheTile) {
  for (const Size& size : kSizes) {
    if (std::min(size.width, size.height) < 7) continue;
    const auto width = static_cast<std::uint32_t>(size.width);
    const std::vector<std::uint32_t> order = halton_order(size.width, size.height, 8, 3.7);
    for (double bound = 8; bound < static_cast<double>(order.size()); bound *= 3.7)
      EXPECT_LT(covering_radius(order, static_cast<std::size_t>(bound), width), 1.7) << size.width << "x" << size.height << " " << bound;
  }
  EXPECT_GT(covering_radius(scanline_order(32, 32), 8, 32), 2);
}

TEST(PixelOrder, WithinASegmentNeighboursFollowEachOther) {
  const std::vector<std::uint32_t> order = halton_order(32, 32, 16, 3.7);
  double length = 0;
  for (std::size_t k = 219 + 1; k < 810; ++k) length += distance(order[k], order[k - 1], 32);
  // The step along a space-filling curve is about the points' spacing; between unsorted Halton points it is half the tile.
  EXPECT_LT(length / (810 - 219 - 1), 3 * std::sqrt(1024.0 / (810 - 219)));
}

TEST(PixelOrder, OneSegmentIsTheMortonCurve) {
  EXPECT_EQ(halton_order(4, 2, 1e9, 2), (std::vector<std::uint32_t>{0, 1, 4, 5, 2, 3, 6, 7}));
}

}  // namespace
}  // namespace sightline
