#include "methods/bidirectional/vertex_density.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sightline::bidirectional {
namespace {

constexpr std::uint64_t mixed(std::uint64_t x) {
  x ^= x >> 31;
  x *= 0x9e3779b97f4a7c15ull;
  return x ^ (x >> 29);
}

/// The nearest power of two. Counts are noisy; neighbours that differ by noise alone then lead to the same cells of a cache, which measured
/// 4 to 14 % fewer rays at less error.
float octave_of(float area) { return std::exp2(std::round(std::log2(area))); }

}  // namespace

VertexDensity::VertexDensity(Kind kind, const Bounds& bounds, std::uint64_t samples_a_pass)
    : kind_(kind),
      origin_(bounds.is_empty() ? Vec3(0) : bounds.lower),
      cell_(bounds.half_diagonal() > 0 ? 0.01f * bounds.half_diagonal() : 1.f),
      samples_a_pass_(samples_a_pass) {}

std::uint64_t VertexDensity::cell_of(const Vec3& p) const {
  const auto index = [this](float v) {
    const float cells = v / cell_;
    return static_cast<std::uint64_t>(cells > 0 ? std::min(cells, 1e6f) : 0.f);
  };
  const Vec3 d = p - origin_;
  return index(d.x) | index(d.y) << 21 | index(d.z) << 42;
}

void VertexDensity::count(std::span<const std::uint64_t> eye_cells, std::span<const std::uint64_t> light_cells, std::uint64_t paths) {
  paths_ = paths;
  const std::size_t vertices = eye_cells.size() + light_cells.size();
  table_.assign(std::bit_ceil(2 * vertices + 2), {0, 0, 0});
  const std::size_t mask = table_.size() - 1;
  const auto add = [&](std::uint64_t cell, std::uint32_t Entry::* side) {
    std::size_t at = mixed(cell) & mask;
    while ((table_[at].eye | table_[at].light) != 0 && table_[at].cell != cell) at = (at + 1) & mask;
    table_[at].cell = cell;
    ++(table_[at].*side);
  };
  for (const std::uint64_t cell : eye_cells) add(cell, &Entry::eye);
  for (const std::uint64_t cell : light_cells) add(cell, &Entry::light);
}

const VertexDensity::Entry* VertexDensity::find(const Vec3& p) const {
  if (table_.empty()) return nullptr;
  const std::size_t mask = table_.size() - 1;
  const std::uint64_t cell = cell_of(p);
  for (std::size_t at = mixed(cell) & mask; (table_[at].eye | table_[at].light) != 0; at = (at + 1) & mask) {
    if (table_[at].cell == cell) return &table_[at];
  }
  return nullptr;
}

// After a delta there is no density by area.
float VertexDensity::conditional_area(const PathVertex& vertex) {
  return vertex.mis.connect > 0 || vertex.depth == 1 ? static_cast<float>(1 / vertex.mis.pdf) : 0.f;
}

// A cell of the grid holds about cell² of surface; one that no vertex was counted in has less than one.
float VertexDensity::eye_cell_area(const PathVertex& vertex) const {
  const auto samples = static_cast<float>(samples_a_pass_);
  if (kind_ == Kind::conditional) return conditional_area(vertex) / samples;
  const Entry* entry = find(vertex.surface.position);
  const auto count = static_cast<float>(std::max(1u, entry ? entry->eye : 1u));
  return octave_of(cell_ * cell_ * static_cast<float>(paths_) / (count * samples));
}

float VertexDensity::light_cell_area(const PathVertex& vertex) const {
  if (kind_ == Kind::conditional) return conditional_area(vertex);
  const Entry* entry = find(vertex.surface.position);
  const auto count = static_cast<float>(std::max(1u, entry ? entry->light : 1u));
  return octave_of(cell_ * cell_ * static_cast<float>(paths_) / count);
}

}  // namespace sightline::bidirectional
