#include "methods/visibility_cache/pixel_order.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sightline {
namespace {

// The last `digits` digits of i in `base`, mirrored at the point and scaled by base^digits: which of the base^digits cells of the unit
// interval the radical inverse of i falls into.
std::uint32_t radical_inverse_cell(std::uint32_t i, std::uint32_t base, int digits) {
  std::uint32_t cell = 0;
  for (int d = 0; d < digits; ++d, i /= base) cell = cell * base + i % base;
  return cell;
}

// x and y, bit by bit in turns.
std::uint64_t morton_code(std::uint32_t x, std::uint32_t y) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < 32; ++bit) code |= std::uint64_t{(x >> bit) & 1u} << (2 * bit) | std::uint64_t{(y >> bit) & 1u} << (2 * bit + 1);
  return code;
}

}  // namespace

std::vector<std::uint32_t> halton_order(int width, int height, double first_segment, double growth) {
  std::vector<std::uint32_t> order;
  if (width <= 0 || height <= 0) return order;
  const auto columns = static_cast<std::uint32_t>(width), rows = static_cast<std::uint32_t>(height);
  // Over 2^a 3^b points the sequence visits each cell of a grid of as many cells once; the cells outside the tile are left out.
  int a = 0, b = 0;
  std::uint64_t powers_of_2 = 1, powers_of_3 = 1;
  while (powers_of_2 < columns) powers_of_2 *= 2, ++a;
  while (powers_of_3 < rows) powers_of_3 *= 3, ++b;
  order.reserve(std::size_t{columns} * rows);
  for (std::uint64_t i = 0; i < powers_of_2 * powers_of_3; ++i) {
    const std::uint32_t x = radical_inverse_cell(static_cast<std::uint32_t>(i), 2, a);
    const std::uint32_t y = radical_inverse_cell(static_cast<std::uint32_t>(i), 3, b);
    if (x < columns && y < rows) order.push_back(y * columns + x);
  }

  std::vector<std::uint64_t> place(order.size());
  for (const std::uint32_t pixel : order) place[pixel] = morton_code(pixel % columns, pixel / columns);
  const auto less_along_curve = [&place](std::uint32_t p, std::uint32_t q) { return place[p] < place[q]; };
  const double size = static_cast<double>(order.size()), factor = growth > 1.01 ? growth : 1.01;
  double bound = first_segment > 1 ? first_segment : 1.0;
  for (std::size_t begin = 0; begin < order.size(); bound *= factor) {
    const auto end = static_cast<std::size_t>(std::min(bound, size));
    if (end <= begin) continue;
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + static_cast<std::ptrdiff_t>(end), less_along_curve);
    begin = end;
  }
  return order;
}

std::vector<std::uint32_t> scanline_order(int width, int height) {
  if (width <= 0 || height <= 0) return {};
  std::vector<std::uint32_t> order(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::iota(order.begin(), order.end(), 0u);
  return order;
}

}  // namespace sightline
