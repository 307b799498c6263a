#include "methods/square_lights/haar.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shade/cube_map.h"

namespace sightline::square_lights {
namespace {

/// Roots of the texels' solid angles of a face.
std::vector<float> root_solid_angles(int size) {
  std::vector<float> roots;
  roots.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) roots.push_back(std::sqrt(cube_texel_solid_angle(x, y, size)));
  }
  return roots;
}

/// One step on a quad is its own inverse: sums and differences, halved.
struct Quad {
  float a, b, c, d;
  Quad stepped() const { return {(a + b + c + d) / 2, (a - b + c - d) / 2, (a + b - c - d) / 2, (a - b - c + d) / 2}; }
};

}  // namespace

// Coefficients lie as usual: the scalings of a level in the quarter at the left and top, horizontal, vertical and diagonal wavelets in the
// other three.
void haar_transform(std::span<float> face, int size) {
  const auto stride = static_cast<std::size_t>(size);
  std::vector<float> level(face.begin(), face.end());
  for (std::size_t n = stride; n > 1; n /= 2) {
    const std::size_t half = n / 2;
    for (std::size_t y = 0; y < half; ++y) {
      for (std::size_t x = 0; x < half; ++x) {
        const float* top = level.data() + 2 * y * stride + 2 * x;
        const Quad q = Quad{top[0], top[1], top[stride], top[stride + 1]}.stepped();
        face[y * stride + x] = q.a;
        face[y * stride + x + half] = q.b;
        face[(y + half) * stride + x] = q.c;
        face[(y + half) * stride + x + half] = q.d;
      }
    }
    for (std::size_t y = 0; y < half; ++y)
      std::copy_n(face.begin() + static_cast<std::ptrdiff_t>(y * stride), half, level.data() + y * stride);
  }
}

void haar_inverse(std::span<float> face, int size) {
  const auto stride = static_cast<std::size_t>(size);
  std::vector<float> level(face.begin(), face.end());
  for (std::size_t n = 2; n <= stride; n *= 2) {
    const std::size_t half = n / 2;
    for (std::size_t y = 0; y < half; ++y) {
      for (std::size_t x = 0; x < half; ++x) {
        const float* at = face.data() + y * stride + x;
        const Quad q = Quad{at[0], at[half], at[half * stride], at[half * stride + half]}.stepped();
        float* top = level.data() + 2 * y * stride + 2 * x;
        top[0] = q.a, top[1] = q.b, top[stride] = q.c, top[stride + 1] = q.d;
      }
    }
    for (std::size_t y = 0; y < n; ++y) std::copy_n(level.data() + y * stride, n, face.begin() + static_cast<std::ptrdiff_t>(y * stride));
  }
}

std::vector<float> haar_support(int size) {
  const auto n = static_cast<std::size_t>(size);
  std::vector<float> support(n * n);
  for (std::size_t y = 0; y < n; ++y) {
    for (std::size_t x = 0; x < n; ++x) {
      // The wavelets between half and 2 half come of 2 half scalings an edge.
      std::size_t scalings = 1;
      while (scalings <= std::max(x, y)) scalings *= 2;
      const std::size_t edge = scalings == 1 ? n : n / (scalings / 2);
      support[y * n + x] = static_cast<float>(edge * edge);
    }
  }
  return support;
}

WaveletLight wavelet_light(const LightCube& cube, std::size_t terms, bool area_weighted) {
  const std::size_t face_texels = cube.count() / kCubeFaces;
  const std::vector<float> roots = root_solid_angles(cube.size), support = haar_support(cube.size);
  WaveletLight light;
  std::vector<float> values(cube.count()), rank(cube.count());
  std::vector<std::uint32_t> order(cube.count());
  const std::size_t kept = terms == 0 ? cube.count() : std::min(terms, cube.count());
  for (int c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < cube.count(); ++i) values[i] = cube.texels[i][c] * roots[i % face_texels];
    for (std::size_t face = 0; face < kCubeFaces; ++face) {
      haar_transform(std::span(values).subspan(face * face_texels, face_texels), cube.size);
    }
    for (std::size_t i = 0; i < values.size(); ++i) rank[i] = std::fabs(values[i]) * (area_weighted ? support[i % face_texels] : 1.f);
    std::iota(order.begin(), order.end(), 0u);
    const auto greater = [&rank](std::uint32_t a, std::uint32_t b) { return rank[a] != rank[b] ? rank[a] > rank[b] : a < b; };
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), order.end(), greater);
    for (std::size_t k = 0; k < kept; ++k) light.channel[c].push_back({order[k], values[order[k]]});
    // In memory order, which is how a transport vector is read fastest.
    std::sort(light.channel[c].begin(), light.channel[c].end(), [](const auto& a, const auto& b) { return a.index < b.index; });
  }
  return light;
}

void wavelet_transport(std::span<float> transport, int size) {
  const std::vector<float> roots = root_solid_angles(size);
  for (std::size_t face = 0; face < kCubeFaces; ++face) {
    const std::span<float> values = transport.subspan(face * roots.size(), roots.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] *= roots[i];
    haar_transform(values, size);
  }
}

}  // namespace sightline::square_lights
