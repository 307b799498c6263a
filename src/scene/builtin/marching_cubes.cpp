#include "scene/builtin/marching_cubes.h"

#include <bit>
#include <vector>

#include "base/math/vec.h"

namespace sightline::builtin {
namespace {

struct Edge {
  int from, to;  ///< corners
};

/// Corner numbers of an edge, by the numbering of CubeCase.
Edge edge_corners(int e) {
  const int axis = e / 4, low = e & 1, high = e >> 1 & 1;
  const int bits[3][2] = {{2, 4}, {1, 4}, {1, 2}};  // of the two other axes
  const int from = low * bits[axis][0] + high * bits[axis][1];
  return {from, from + (1 << axis)};
}

int edge_between(int a, int b) {
  for (int e = 0; e < 12; ++e) {
    const Edge edge = edge_corners(e);
    if ((edge.from == a && edge.to == b) || (edge.from == b && edge.to == a)) return e;
  }
  return -1;
}

/// The four corners of each face, counter-clockwise seen from outside.
constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

bool share_a_face(int e, int f) {
  const Edge a = edge_corners(e), b = edge_corners(f);
  const int corners = 1 << a.from | 1 << a.to | 1 << b.from | 1 << b.to;
  for (const auto& face : kFaces) {
    int of_face = 0;
    for (const int corner : face) of_face |= 1 << corner;
    if ((corners & ~of_face) == 0) return true;
  }
  return false;
}

/// Triangulates corners low..high of a loop without an inner edge inside a face of the cube; false if there is no such way.
bool triangulate(const std::vector<int>& loop, std::size_t low, std::size_t high, CubeCase& result) {
  if (high - low < 2) return true;
  const auto allowed = [&](std::size_t a, std::size_t b) {
    return b - a == 1 || (a == 0 && b + 1 == loop.size()) || !share_a_face(loop[a], loop[b]);
  };
  for (std::size_t middle = low + 1; middle < high; ++middle) {
    if (!allowed(low, middle) || !allowed(middle, high)) continue;
    const CubeCase saved = result;
    result.triangles[result.triangle_count++] = {static_cast<std::uint8_t>(loop[low]), static_cast<std::uint8_t>(loop[middle]),
                                                 static_cast<std::uint8_t>(loop[high])};
    if (triangulate(loop, low, middle, result) && triangulate(loop, middle, high, result)) return true;
    result = saved;
  }
  return false;
}

CubeCase make_case(int inside) {
  // On each face a run of inside corners is cut off by a segment from the edge where the run ends to the edge where it begins. An edge ends
  // a run on one of its faces and begins one on the other, so the segments join to loops.
  std::array<int, 12> next{};
  next.fill(-1);
  for (const auto& face : kFaces) {
    const auto is_inside = [&](int i) { return (inside >> face[i & 3] & 1) != 0; };
    for (int begin = 0; begin < 4; ++begin) {
      if (!is_inside(begin) || is_inside(begin + 3)) continue;
      int end = begin;
      while (is_inside(end + 1)) ++end;
      next[static_cast<std::size_t>(edge_between(face[end & 3], face[(end + 1) & 3]))] = edge_between(face[(begin + 3) & 3], face[begin]);
    }
  }
  CubeCase result;
  std::array<bool, 12> done{};
  for (int start = 0; start < 12; ++start) {
    std::vector<int> loop;
    for (int e = start; next[static_cast<std::size_t>(e)] >= 0 && !done[static_cast<std::size_t>(e)];
         e = next[static_cast<std::size_t>(e)]) {
      done[static_cast<std::size_t>(e)] = true;
      loop.push_back(e);
    }
    if (!loop.empty()) triangulate(loop, 0, loop.size() - 1, result);
  }
  return result;
}

}  // namespace

const std::array<CubeCase, 256>& marching_cubes_table() {
  static const std::array<CubeCase, 256> table = [] {
    std::array<CubeCase, 256> cases;
    for (int inside = 0; inside < 256; ++inside) cases[static_cast<std::size_t>(inside)] = make_case(inside);
    return cases;
  }();
  return table;
}

}  // namespace sightline::builtin
