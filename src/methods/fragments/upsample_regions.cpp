#include "methods/fragments/upsample_regions.h"

#include <algorithm>

namespace sightline {
namespace {

/// Candidates with the pixels that vouch for them.
struct Gathered {
  RbfCandidates samples;
  std::array<std::size_t, RbfCandidates::kCapacity> pixel;
};

class Gatherer {
 public:
  Gatherer(const SignalCells& cells, const Cell& cell) : cells_(cells), cell_(cell), own_(cells.sample(cell)) {}

  const SignalSample& own() const { return own_; }
  bool differs() const { return differs_; }

  // Additional samples on an edge (horizontal: dx = 1, dy = 0) that begins at pixel (x, y), and the cells across it.
  void gather_edge(int x, int y, int dx, int dy, bool before, Gathered& list) {
    const int s = cell_.size;
    if (s >= 2)
      for (const int at : {0, s / 2, s}) add_extra(x + at * dx, y + at * dy, list);
    const int across_x = before ? x - dy : x, across_y = before ? y - dx : y;
    for (int at = 0; at < s;) {
      const int px = across_x + at * dx, py = across_y + at * dy;
      if (!cells_.g().inside(px, py)) break;
      const Cell other = cells_.cell(px, py);
      add_cell(other, px, py, list);
      at = (dx ? other.x - x : other.y - y) + other.size;
    }
  }
  void gather_corner(int extra_x, int extra_y, int across_x, int across_y, Gathered& list) {
    add_extra(extra_x, extra_y, list);
    if (cells_.g().inside(across_x, across_y)) add_cell(cells_.cell(across_x, across_y), across_x, across_y, list);
  }
  bool add_extra(int x, int y, Gathered& list) {
    if (!cells_.g().inside(x, y) || !cells_.has_extra(x, y) || !cells_.speaks(x, y)) return false;
    add(cells_.extra(x, y), cells_.g().at(x, y), list);
    return true;
  }
  bool add_cell(const Cell& other, int x, int y, Gathered& list) {
    if (!cells_.speaks(x, y)) return false;
    add(cells_.sample(other), cells_.centre_pixel(other), list);
    return true;
  }
  void add(const SignalSample& sample, std::size_t pixel, Gathered& list) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(cells_.channels()); ++c) differs_ = differs_ || sample.value[c] != own_.value[c];
    list.pixel[list.samples.count] = pixel;
    list.samples.add(sample, cells_.channels());
  }

  // Drops samples on other surfaces.
  void keep_connected(Gathered& list) const {
    const std::size_t reference = cells_.centre_pixel(cell_);
    RbfCandidates& s = list.samples;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < s.count; ++i) {
      if (!cells_.connected(reference, list.pixel[i])) continue;
      s.x[kept] = s.x[i], s.y[kept] = s.y[i], s.width[kept] = s.width[i], s.level[kept] = s.level[i];
      for (std::size_t c = 0; c < static_cast<std::size_t>(cells_.channels()); ++c) s.value[c][kept] = s.value[c][i];
      ++kept;
    }
    s.count = kept;
  }

  // Quadrant (right, lower) of the cell.
  void evaluate(bool right, bool lower, bool adaptive, const std::array<const Gathered*, 3>& lists, const std::array<float*, 3>& out,
                std::size_t out_stride) const {
    const int half = std::max(cell_.size / 2, 1), dx = right ? half : 0, dy = lower ? half : 0;
    RbfRegion region{.x0 = cell_.x + dx,
                     .y0 = cell_.y + dy,
                     .size = half,
                     .cell_width = static_cast<float>(cell_.size),
                     .adaptive = adaptive,
                     .channels = cells_.channels(),
                     .own = own_};
    for (std::size_t k = 0; k < 3; ++k)
      if (lists[k] && lists[k]->samples.count > 0) region.candidates[k] = &lists[k]->samples;
    const int columns = std::min(half, cells_.g().width - region.x0), rows = std::min(half, cells_.g().height - region.y0);
    if (columns <= 0 || rows <= 0) return;
    std::array<float*, 3> corner = out;
    for (std::size_t c = 0; c < static_cast<std::size_t>(cells_.channels()); ++c)
      corner[c] += static_cast<std::size_t>(dy) * out_stride + static_cast<std::size_t>(dx);
    rbf_region_lanes(region, columns, rows, corner, out_stride);
  }

 private:
  const SignalCells& cells_;
  const Cell cell_;
  const SignalSample own_;
  bool differs_ = false;
};

}  // namespace

void interpolate_nearest(const SignalCells& cells, const Cell& cell, bool adaptive, bool corners, const std::array<float*, 3>& out,
                         std::size_t out_stride) {
  Gatherer gatherer(cells, cell);
  const int x = cell.x, y = cell.y, s = cell.size;
  Gathered horizontal[2], vertical[2], corner[2][2];  // [lower], [right], [lower][right]
  gatherer.gather_edge(x, y, 1, 0, true, horizontal[0]);
  gatherer.gather_edge(x, y + s, 1, 0, false, horizontal[1]);
  gatherer.gather_edge(x, y, 0, 1, true, vertical[0]);
  gatherer.gather_edge(x + s, y, 0, 1, false, vertical[1]);
  if (corners)
    for (const int j : {0, 1})
      for (const int i : {0, 1}) gatherer.gather_corner(x + i * s, y + j * s, i ? x + s : x - 1, j ? y + s : y - 1, corner[j][i]);
  if (!gatherer.differs()) return fill_cell(cells, cell, gatherer.own().value, out, out_stride);
  for (const std::size_t k : {0, 1}) {
    gatherer.keep_connected(horizontal[k]), gatherer.keep_connected(vertical[k]);
    gatherer.keep_connected(corner[k][0]), gatherer.keep_connected(corner[k][1]);
  }
  for (const std::size_t j : {0, 1})
    for (const std::size_t i : {0, 1})
      gatherer.evaluate(i == 1, j == 1, adaptive, {&horizontal[j], &vertical[i], corners ? &corner[j][i] : nullptr}, out, out_stride);
}

void interpolate_corners(const SignalCells& cells, const Cell& cell, bool adaptive, const std::array<float*, 3>& out,
                         std::size_t out_stride) {
  Gatherer gatherer(cells, cell);
  const int half = cell.size / 2;
  // Where a neighbour has no additional sample, it is finely sampled, or so large that the place lies between two of its own.
  const auto gather = [&](int i, int j, Gathered& list) {
    const int x = cell.x + i * half, y = cell.y + j * half;
    if (!cells.g().inside(x, y) || gatherer.add_extra(x, y, list) || !cells.speaks(x, y)) return;
    const Cell other = cells.cell(x, y);
    if (other.size < cell.size) {
      gatherer.add_cell(other, x, y, list);
      return;
    }
    const bool on_left_edge = x == other.x;
    const int s = other.size / 2, from_x = on_left_edge ? x : x & ~(s - 1), from_y = on_left_edge ? y & ~(s - 1) : y;
    const int to_x = on_left_edge ? x : from_x + s, to_y = on_left_edge ? from_y + s : y;
    const auto known = [&](int px, int py) {
      return cells.g().inside(px, py) && cells.has_extra(px, py) && cells.speaks(px, py) &&
             cells.connected(cells.g().at(x, y), cells.g().at(px, py));
    };
    if (!known(from_x, from_y) || !known(to_x, to_y)) return;
    const SignalSample a = cells.extra(from_x, from_y), b = cells.extra(to_x, to_y);
    const float t = static_cast<float>(x - from_x + y - from_y) / static_cast<float>(s);
    SignalSample between{.x = static_cast<float>(x) + 0.5f, .y = static_cast<float>(y) + 0.5f};
    for (std::size_t c = 0; c < 3; ++c) between.value[c] = a.value[c] + t * (b.value[c] - a.value[c]);
    gatherer.add(between, cells.g().at(x, y), list);
  };
  Gathered node[3][3];
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      if (i != 1 || j != 1) gather(i, j, node[j][i]);
  if (!gatherer.differs()) return fill_cell(cells, cell, gatherer.own().value, out, out_stride);
  for (auto& row : node)
    for (Gathered& list : row) gatherer.keep_connected(list);
  for (const std::size_t j : {0, 1})
    for (const std::size_t i : {0, 1})
      gatherer.evaluate(i == 1, j == 1, adaptive, {&node[2 * j][1], &node[1][2 * i], &node[2 * j][2 * i]}, out, out_stride);
}

void fill_cell(const SignalCells& cells, const Cell& cell, const std::array<float, 3>& value, const std::array<float*, 3>& out,
               std::size_t out_stride) {
  const int columns = std::min(cell.size, cells.g().width - cell.x), rows = std::min(cell.size, cells.g().height - cell.y);
  for (std::size_t c = 0; c < static_cast<std::size_t>(cells.channels()); ++c)
    for (int j = 0; j < rows; ++j) std::fill_n(out[c] + static_cast<std::size_t>(j) * out_stride, columns, value[c]);
}

}  // namespace sightline
