#include "methods/fragments/upsample_patch.h"

#include <algorithm>

#include "methods/fragments/upsample_regions.h"

namespace sightline {
namespace {

constexpr int kLargest = kRootSize;

/// A value of one or three channels: known when compiled, since small cells are many.
template <std::size_t C>
using Value = std::array<float, C>;

/// A cell across the border as far as it touches: pixels [begin, end) along an edge.
template <std::size_t C>
struct Run {
  int begin, end;
  Cell cell;
  float weight;  // 1 / size, 0 for cells that do not count
  Value<C> value;
};

/// An edge of the cell: pixel i along it is (x + i dx, y + i dy), its neighbour across is (across_x + i dx, across_y + i dy). Node i lies
/// at the top left corner of pixel (node_x + i dx, node_y + i dy).
template <std::size_t C>
struct Edge {
  int dx, dy, across_x, across_y, node_x, node_y;
  int count;
  std::array<Run<C>, kLargest> runs;
};

enum Side : std::uint8_t { kTop, kBottom, kLeft, kRight };

template <std::size_t C>
class Patch {
 public:
  Patch(const SignalCells& cells, const Cell& cell) : cells_(cells), cell_(cell), fragment_mask_(~(2 * cell.size - 1)) {
    own_ = value_at(cell.x, cell.y);
    low_ = high_ = own_;
    const int x = cell.x, y = cell.y, s = cell.size;
    start(kTop, 1, 0, x, y - 1, x, y), start(kBottom, 1, 0, x, y + s, x, y + s);
    start(kLeft, 0, 1, x - 1, y, x, y), start(kRight, 0, 1, x + s, y, x + s, y);
  }

  // Collects the cells around. False: all samples equal the cell's own.
  bool gather() {
    bool differs = false;
    for (Edge<C>& edge : edges_) {
      for (int at = 0; at < cell_.size;) {
        Run<C>& run = edge.runs[static_cast<std::size_t>(edge.count++)];
        run.begin = at;
        const int x = edge.across_x + at * edge.dx, y = edge.across_y + at * edge.dy;
        look_up(x, y, run);
        if (run.weight >= 0) {
          const int from = edge.dx ? run.cell.x - edge.across_x : run.cell.y - edge.across_y;
          run.end = std::min(from + run.cell.size, cell_.size);
        } else {
          run.end = at > 0 && at < cell_.size / 2 ? cell_.size / 2 : cell_.size;
        }
        at = run.end;
        differs = differs || counts_and_differs(run);
        differs = differs || extra_differs(edge.node_x + run.begin * edge.dx, edge.node_y + run.begin * edge.dy) ||
                  extra_differs(edge.node_x + run.end * edge.dx, edge.node_y + run.end * edge.dy);
      }
    }
    for (std::size_t k = 0; k < 4; ++k) {
      look_up(cell_.x + (k & 1 ? cell_.size : -1), cell_.y + (k & 2 ? cell_.size : -1), diagonal_[k]);
      differs = differs || counts_and_differs(diagonal_[k]);
    }
    return differs;
  }

  void guard() {
    reference_ = cells_.centre_pixel(cell_);
    for (Edge<C>& edge : edges_)
      for (std::size_t i = 0; i < static_cast<std::size_t>(edge.count); ++i) guard(edge.runs[i]);
    for (Run<C>& run : diagonal_) guard(run);
  }

  void evaluate(const std::array<float*, 3>& out, std::size_t out_stride) {
    for (std::size_t k = 0; k < 4; ++k) corner_[k] = corner_node(k);
    for (std::size_t side = 0; side < 4; ++side) trace(static_cast<Side>(side));
    for (std::size_t c = 0; c < C; ++c)
      for (std::size_t k = 0; k < 4; ++k) quadrant(k, c, out[c], out_stride);
  }

 private:
  void start(Side side, int dx, int dy, int across_x, int across_y, int node_x, int node_y) {
    Edge<C>& e = edges_[side];
    e.dx = dx, e.dy = dy, e.across_x = across_x, e.across_y = across_y, e.node_x = node_x, e.node_y = node_y;
    e.count = 0;
  }
  // Weight -1 stands for "outside the picture", 0 for "says nothing".
  void look_up(int x, int y, Run<C>& run) const {
    run.weight = -1;
    if (!cells_.g().inside(x, y)) return;
    run.cell = cells_.cell(x, y);
    run.weight = cells_.speaks(x, y) ? 1 / static_cast<float>(run.cell.size) : 0;
    run.value = value_at(run.cell.x, run.cell.y);
  }
  // The sample of the quadrant with this corner.
  Value<C> value_at(int x, int y) const {
    Value<C> result;
    for (std::size_t c = 0; c < C; ++c) result[c] = cells_.signal().value[c][cells_.g().at(x, y)];
    return result;
  }
  Value<C> extra_at(int x, int y) const {
    Value<C> result;
    for (std::size_t c = 0; c < C; ++c) result[c] = cells_.signal().extra[c][cells_.g().at(x, y)];
    return result;
  }
  bool counts_and_differs(const Run<C>& run) const { return run.weight > 0 && differs(run.value); }
  bool differs(const Value<C>& value) const {
    for (std::size_t c = 0; c < C; ++c)
      if (value[c] != own_[c]) return true;
    return false;
  }
  bool is_extra(int x, int y) const { return cells_.g().inside(x, y) && cells_.has_extra(x, y) && cells_.speaks(x, y); }
  bool extra_differs(int x, int y) const { return is_extra(x, y) && differs(extra_at(x, y)); }

  void guard(Run<C>& run) {
    if (run.weight > 0 && same_fragment(run.cell)) {
      widen(run.value);
      return;
    }
    if (run.weight <= 0 || !cells_.connected(reference_, cells_.centre_pixel(run.cell))) {
      run.weight = 0;
      return;
    }
    widen(run.value);
  }
  // Fragments were cut along geometric edges: none lies inside.
  bool same_fragment(const Cell& other) const {
    return other.size == cell_.size && ((other.x ^ cell_.x) & fragment_mask_) == 0 && ((other.y ^ cell_.y) & fragment_mask_) == 0;
  }
  void widen(const Value<C>& value) {
    for (std::size_t c = 0; c < C; ++c) low_[c] = std::min(low_[c], value[c]), high_[c] = std::max(high_[c], value[c]);
  }

  // Weighted mean of what touches a node; own_pixels of the four pixels around it are the cell's own.
  struct Mean {
    float weight;
    Value<C> sum;
    void add(float w, const Value<C>& v) {
      weight += w;
      for (std::size_t c = 0; c < C; ++c) sum[c] += w * v[c];
    }
  };
  Mean begin_node(float own_pixels) const {
    // Relative to the cell's own value: a constant field is reproduced exactly.
    return {own_pixels / static_cast<float>(cell_.size), Value<C>{}};
  }
  void add(Mean& mean, const Run<C>& run, float pixels) const {
    if (run.weight == 0) return;
    Value<C> d{};
    for (std::size_t c = 0; c < C; ++c) d[c] = run.value[c] - own_[c];
    mean.add(pixels * run.weight, d);
  }
  // The node at the top left corner of pixel (x, y).
  Value<C> end_node(const Mean& mean, int x, int y) {
    Value<C> result{};
    for (std::size_t c = 0; c < C; ++c) result[c] = own_[c] + mean.sum[c] / mean.weight;
    if (x >= 0 && is_extra(x, y) && cells_.connected(reference_, cells_.g().at(x, y))) {
      const Value<C> extra = extra_at(x, y);
      widen(extra);
      for (std::size_t c = 0; c < C; ++c) result[c] += 0.5f * (extra[c] - result[c]);
    }
    return result;
  }

  Value<C> corner_node(std::size_t k) {
    const Edge<C>&horizontal = edges_[k & 2 ? kBottom : kTop], &vertical = edges_[k & 1 ? kRight : kLeft];
    Mean mean = begin_node(1);
    add(mean, horizontal.runs[k & 1 ? static_cast<std::size_t>(horizontal.count - 1) : 0], 1);
    add(mean, vertical.runs[k & 2 ? static_cast<std::size_t>(vertical.count - 1) : 0], 1);
    add(mean, diagonal_[k], 1);
    return end_node(mean, cell_.x + (k & 1 ? cell_.size : 0), cell_.y + (k & 2 ? cell_.size : 0));
  }

  // The curve along an edge at the centres of its pixels, and in the edge's middle.
  void trace(Side side) {
    const Edge<C>& edge = edges_[side];
    const std::size_t first = side == kTop ? 0 : side == kBottom ? 2 : side == kLeft ? 0 : 1;
    const std::size_t last = side == kTop ? 1 : side == kBottom ? 3 : side == kLeft ? 2 : 3;
    Value<C> from = corner_[first];
    for (std::size_t r = 0; r < static_cast<std::size_t>(edge.count); ++r) {
      const Run<C>& run = edge.runs[r];
      Mean at_middle = begin_node(2);
      add(at_middle, run, 2);
      const Value<C> middle = end_node(at_middle, -1, -1);
      Value<C> to = corner_[last];
      if (run.end < cell_.size) {
        Mean at_end = begin_node(2);
        add(at_end, run, 1), add(at_end, edge.runs[r + 1], 1);
        to = end_node(at_end, edge.node_x + run.end * edge.dx, edge.node_y + run.end * edge.dy);
      }
      const int length = run.end - run.begin;
      for (std::size_t c = 0; c < C; ++c) {
        auto& curve = curve_[side][c];
        if (length == 1) curve[static_cast<std::size_t>(run.begin)] = middle[c];
        for (int i = 0; length > 1 && i < length / 2; ++i) {
          const float t = static_cast<float>(2 * i + 1) / static_cast<float>(length);
          curve[static_cast<std::size_t>(run.begin) + static_cast<std::size_t>(i)] = from[c] + t * (middle[c] - from[c]);
          curve[static_cast<std::size_t>(run.end - 1 - i)] = to[c] + t * (middle[c] - to[c]);
        }
      }
      if (edge.count == 1) middle_[side] = middle;
      if (2 * run.end == cell_.size) middle_[side] = to;
      from = to;
    }
  }

  // Quadrant k (bit 0: right, bit 1: lower) of channel c. u and v go from the cell's corner to its centre.
  void quadrant(std::size_t k, std::size_t c, float* out, std::size_t out_stride) const {
    const int size = cell_.size, half = size / 2, x0 = k & 1 ? half : 0, y0 = k & 2 ? half : 0;
    const int columns = std::min(half, cells_.g().width - cell_.x - x0), rows = std::min(half, cells_.g().height - cell_.y - y0);
    if (columns <= 0 || rows <= 0) return;
    const Side horizontal = k & 2 ? kBottom : kTop, vertical = k & 1 ? kRight : kLeft;
    const float corner = corner_[k][c], on_horizontal = middle_[horizontal][c], on_vertical = middle_[vertical][c], centre = own_[c];
    const float low = low_[c], high = high_[c], step = 1 / static_cast<float>(half);

    // How the curve along the horizontal edge departs from the straight line between its ends.
    std::array<float, kLargest / 2> u, bend;
    for (int i = 0; i < columns; ++i) {
      const float t = (static_cast<float>(i) + 0.5f) * step;
      const auto at = static_cast<std::size_t>(i);
      u[at] = k & 1 ? 1 - t : t;
      bend[at] = curve_[horizontal][c][static_cast<std::size_t>(x0) + at] - (corner + u[at] * (on_horizontal - corner));
    }
    for (int j = 0; j < rows; ++j) {
      const float t = (static_cast<float>(j) + 0.5f) * step, v = k & 2 ? 1 - t : t;
      const float at_edge = corner + v * (on_vertical - corner), inside = on_horizontal + v * (centre - on_horizontal);
      const auto line = static_cast<std::size_t>(y0) + static_cast<std::size_t>(j);
      const float vertical_bend = curve_[vertical][c][line] - at_edge;
      float* row = out + line * out_stride + static_cast<std::size_t>(x0);
      for (int i = 0; i < columns; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const float value = at_edge + u[at] * (inside - at_edge) + (1 - v) * bend[at] + (1 - u[at]) * vertical_bend;
        row[at] = std::min(std::max(value, low), high);
      }
    }
  }

  const SignalCells& cells_;
  const Cell cell_;
  const int fragment_mask_;
  Value<C> own_;
  std::size_t reference_ = 0;
  std::array<Edge<C>, 4> edges_;
  std::array<Run<C>, 4> diagonal_;
  std::array<Value<C>, 4> corner_, middle_;
  std::array<std::array<std::array<float, kLargest>, 3>, 4> curve_;
  Value<C> low_, high_;
};

template <std::size_t C>
void interpolate(const SignalCells& cells, const Cell& cell, const std::array<float*, 3>& out, std::size_t out_stride) {
  Patch<C> patch(cells, cell);
  if (!patch.gather()) return fill_cell(cells, cell, cells.sample(cell).value, out, out_stride);
  patch.guard();
  patch.evaluate(out, out_stride);
}

}  // namespace

void interpolate_patch(const SignalCells& cells, const Cell& cell, const std::array<float*, 3>& out, std::size_t out_stride) {
  cells.channels() == 1 ? interpolate<1>(cells, cell, out, out_stride) : interpolate<3>(cells, cell, out, out_stride);
}

}  // namespace sightline
