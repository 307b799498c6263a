#include "methods/square_lights/brdf_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <variant>

#include "base/core/grid_index.h"
#include "base/parallel/parallel.h"
#include "methods/square_lights/hemisphere_disk.h"
#include "methods/square_lights/sharp_lobe.h"

namespace sightline::square_lights {
namespace {

constexpr int kCells = BrdfTable::kCells, kCorners = BrdfTable::kCorners, kViews = BrdfTable::kViews;
constexpr float kCellSize = 2.f / kCells, kHalfPi = kPi / 2;
/// Views at the very horizon have no BRDF; the last table is made this far above it.
constexpr float kLeastCosine = 1e-3f;

/// Means over cells, row by row.
using Cells = std::array<Color, static_cast<std::size_t>(kCells) * kCells>;

/// What f cos may be off in the mean over a cell, by the sum of the cell's value and the mean over the disk.
constexpr float kTolerance = 0.003f;
/// Directions that the BSDF itself chooses, where peaks are that points of a lattice might miss.
constexpr int kSeeds = 24;
/// How often cells with peaks may be quartered beyond what was asked for.
constexpr int kExtraDepth = 3;

/// Element i of a Kronecker sequence: any that fills the unit interval evenly would do.
float kronecker(int i, double step) {
  const double x = 0.5 + i * step;
  return static_cast<float>(x - std::floor(x));
}

/// The i-th direction that the BSDF chooses itself, none where that is a delta.
std::optional<BsdfSample> sample_some(const Bsdf& bsdf, const Vec3& wo, int i) {
  std::optional<BsdfSample> sample = bsdf.sample(wo, kronecker(i, 0.8191725134), {kronecker(i, 0.6710436067), kronecker(i, 0.5497004779)});
  if (sample && sample->is_delta) sample.reset();
  return sample;
}

/// f cos by point of the disk for one view.
class Slice {
 public:
  Slice(const Bsdf& bsdf, const SharpLobe* lobe, const Vec3& wo, int deepest) : bsdf_(bsdf), wo_(wo), deepest_(deepest) {
    bsdf_.prepare(wo);
    if (lobe != nullptr && !lobe->empty()) lobe_ = lobe->view(wo);
  }

  /// Means over cells; with `mirrored` the lower half is that of the upper.
  void cells(bool mirrored, Cells& means) {
    const int rows = mirrored ? kCells / 2 : kCells;
    sample_lattice(2 * rows, mirrored);
    find_seeds(mirrored);
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < kCells; ++x) {
        const Color mean = cell(x, y);
        means[grid_index(x, y, kCells)] = mean;
        if (mirrored) means[grid_index(x, kCells - 1 - y, kCells)] = mean;
      }
    }
  }

 private:
  static constexpr int kPoints = 2 * kCells, kStride = kPoints + 2;  // a lattice of 2 x 2 points a cell, with a border
  struct Seed {
    Vec2 p;
    float value;
  };

  Color value(const Vec2& p) const {
    if (!(glm::dot(p, p) < 1)) return Color(0);
    const Vec3 wi = direction_from_disk(p);
    Color f = bsdf_.evaluate(wo_, wi).f_cos;
    if (lobe_) f -= SharpLobe::value(*lobe_, wi);
    return is_finite(f) ? f : Color(0);
  }
  const Color& at(int x, int y) const { return lattice_[grid_index(x + 1, y + 1, kStride)]; }
  Color& at(int x, int y) { return lattice_[grid_index(x + 1, y + 1, kStride)]; }

  void sample_lattice(int rows, bool mirrored) {
    lattice_.fill(Color(0));
    Color sum(0);
    constexpr float kStep = 2.f / kPoints;
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < kPoints; ++x) {
        const Color v = value({-1 + (static_cast<float>(x) + 0.5f) * kStep, -1 + (static_cast<float>(y) + 0.5f) * kStep});
        at(x, y) = v;
        sum += glm::abs(v);
      }
    }
    if (mirrored) {
      for (int x = 0; x < kPoints; ++x) at(x, rows) = at(x, rows - 1);
    }
    mean_ = max_component(sum) * (mirrored ? 2 : 1) * kStep * kStep * kInvPi;
  }

  void find_seeds(bool mirrored) {
    seed_count_ = 0;
    for (int i = 0; i < kSeeds; ++i) {
      const std::optional<BsdfSample> sample = sample_some(bsdf_, wo_, i);
      if (!sample || !(sample->wi.z > 0)) continue;
      Vec2 p = disk_from_direction(sample->wi);
      if (mirrored) p.y = -std::fabs(p.y);
      seeds_[seed_count_++] = {p, greatest_of(value(p))};
    }
  }

  Color cell(int x, int y) const {
    const std::array<Color, 4> own{at(2 * x, 2 * y), at(2 * x + 1, 2 * y), at(2 * x, 2 * y + 1), at(2 * x + 1, 2 * y + 1)};
    const Color mean = 0.25f * (own[0] + own[1] + own[2] + own[3]);
    Color ring(0);
    for (int i = -1; i <= 2; ++i) {
      ring += at(2 * x + i, 2 * y - 1) + at(2 * x + i, 2 * y + 2);
      if (i == 0 || i == 1) ring += at(2 * x - 1, 2 * y + i) + at(2 * x + 2, 2 * y + i);
    }
    const Vec2 center{-1 + (static_cast<float>(x) + 0.5f) * kCellSize, -1 + (static_cast<float>(y) + 0.5f) * kCellSize};
    const float tolerance = kTolerance * (greatest_of(mean) + mean_);
    // For a function that bends evenly the mean of the four is off by a sixteenth of what it differs from the ring around them; half of
    // that is left for those that do not.
    const float bend = greatest_of(mean - ring / 12.f) / 8;
    if (bend <= tolerance && !hides_peak(center, kCellSize / 2, own, tolerance)) return mean;
    return refined(center, kCellSize / 2, own, 1, tolerance);
  }

  /// Whether a direction within the square was chosen whose value its points do not come near.
  bool hides_peak(const Vec2& center, float half, const std::array<Color, 4>& values, float tolerance) const {
    float greatest = 0;
    for (const Color& v : values) greatest = std::max(greatest, greatest_of(v));
    for (std::size_t i = 0; i < seed_count_; ++i) {
      const Vec2 d = glm::abs(seeds_[i].p - center);
      if (d.x <= half && d.y <= half && seeds_[i].value > 1.5f * greatest + tolerance) return true;
    }
    return false;
  }

  /// Mean over the square around `center`, whose quarters have `values` in their centres: from four points of each quarter, or more where
  /// that makes a difference.
  Color refined(const Vec2& center, float half, const std::array<Color, 4>& values, int depth, float tolerance) const {
    Color sum(0);
    const float share = std::ldexp(1.f, -2 * depth), quarter_half = half / 2;
    for (std::size_t q = 0; q < 4; ++q) {
      const Vec2 middle = center + quarter_half * corner(q);
      std::array<Color, 4> inner;
      for (std::size_t k = 0; k < 4; ++k) inner[k] = value(middle + quarter_half / 2 * corner(k));
      Color mean = 0.25f * (inner[0] + inner[1] + inner[2] + inner[3]);
      if (depth < deepest_ &&
          (greatest_of(mean - values[q]) * share > tolerance / 4 || hides_peak(middle, quarter_half, inner, tolerance))) {
        mean = refined(middle, quarter_half, inner, depth + 1, tolerance);
      }
      sum += mean;
    }
    return 0.25f * sum;
  }
  static float greatest_of(const Color& c) { return max_component(glm::abs(c)); }
  static Vec2 corner(std::size_t q) { return {q % 2 ? 1.f : -1.f, q / 2 ? 1.f : -1.f}; }

  Bsdf bsdf_;
  std::optional<SharpLobe::View> lobe_;
  Vec3 wo_;
  int deepest_;
  float mean_ = 0;  // of f cos over the disk
  std::size_t seed_count_ = 0;
  std::array<Seed, kSeeds> seeds_;
  std::array<Color, std::size_t{kStride} * kStride> lattice_;
};

Cells mirror(const Cells& means, bool columns, bool rows) {
  Cells result;
  for (int y = 0; y < kCells; ++y) {
    for (int x = 0; x < kCells; ++x) {
      const int from_x = columns ? kCells - 1 - x : x, from_y = rows ? kCells - 1 - y : y;
      result[grid_index(x, y, kCells)] = means[grid_index(from_x, from_y, kCells)];
    }
  }
  return result;
}

/// Sums of cells times their area, at corners.
void sum_areas(const Cells& means, float* corners) {
  std::array<glm::dvec4, kCorners> above{};
  std::fill_n(corners, std::size_t{kCorners} * 4, 0.f);
  for (int y = 0; y < kCells; ++y) {
    glm::dvec4 row(0);
    float* out = corners + static_cast<std::size_t>(y + 1) * kCorners * 4;
    std::fill_n(out, 4, 0.f);
    for (int x = 0; x < kCells; ++x) {
      const Color& mean = means[grid_index(x, y, kCells)];
      const double bright = luminance(mean);
      row += glm::dvec4(glm::dvec3(mean), bright * bright) * static_cast<double>(kCellSize * kCellSize);
      glm::dvec4& sum = above[static_cast<std::size_t>(x) + 1];
      sum += row;
      out += 4;
      for (int c = 0; c < 4; ++c) out[c] = static_cast<float>(sum[c]);
    }
  }
}

/// The disk's centre of view cell (x, y), kept above the horizon.
Vec3 view_direction(int x, int y) {
  Vec2 p{-1 + (static_cast<float>(x) + 0.5f) * kCellSize, -1 + (static_cast<float>(y) + 0.5f) * kCellSize};
  const float length = glm::length(p), most = std::sqrt(1 - kLeastCosine);
  if (length > most) p *= most / length;
  return direction_from_disk(p);
}

/// Whether any view within the disk lies between this cell's centre and its neighbours'.
bool is_read(int x, int y) {
  const auto nearest = [](int i) { return std::max(0.f, std::fabs(-1 + (static_cast<float>(i) + 0.5f) * kCellSize) - kCellSize); };
  const float nx = nearest(x), ny = nearest(y);
  return nx * nx + ny * ny < 1;
}

/// Whether f cos stays what it is when both directions are mirrored at the planes of the axes, as all models do whose axes are the
/// tangents: views of one quadrant then do for all four. Directions that the BSDF itself chooses find narrow lobes.
bool is_mirror_symmetric(const Bsdf& bsdf) {
  for (int i = 0; i < 48; ++i) {
    const float cosine = 0.15f + 0.84f * kronecker(i, 0.6180339887), sine = std::sqrt(1 - cosine * cosine), angle = static_cast<float>(i);
    const Vec3 wo{sine * std::cos(angle), sine * std::sin(angle), cosine};
    const std::optional<BsdfSample> sample = sample_some(bsdf, wo, i);
    if (!sample) continue;
    const Color here = bsdf.evaluate(wo, sample->wi).f_cos;
    for (const Vec3& mirror : {Vec3(-1, 1, 1), Vec3(1, -1, 1)}) {
      const Color there = bsdf.evaluate(mirror * wo, mirror * sample->wi).f_cos;
      if (!(max_component(glm::abs(here - there)) <= 0.01f * max_component(glm::max(here, there)))) return false;
    }
  }
  return true;
}

}  // namespace

bool is_isotropic(const Bsdf& bsdf) {
  return std::visit([](const auto& model) { return model.is_isotropic(); }, bsdf.model());
}

BrdfTable BrdfTable::build(const Bsdf& bsdf, int samples, const Context& context, const SharpLobe* lobe) {
  BrdfTable table;
  table.signed_ = lobe != nullptr && !lobe->empty();
  table.isotropic_ = is_isotropic(bsdf);
  const int deepest = std::max(1, static_cast<int>(std::ceil(std::log2(std::max(samples, 1)))) - 1 + kExtraDepth);
  if (table.isotropic_) {
    table.corners_.assign(kViews * kSliceFloats, 0.f);
    parallel_for(context, kViews, 1, [&](std::size_t begin, std::size_t end) {
      Cells means;
      for (std::size_t view = begin; view < end; ++view) {
        const float angle = kHalfPi * static_cast<float>(view) / (kViews - 1), cosine = std::max(std::cos(angle), kLeastCosine);
        Slice(bsdf, lobe, direction_from_disk({std::sqrt(1 - cosine), 0}), deepest).cells(true, means);
        sum_areas(means, table.corners_.data() + view * kSliceFloats);
      }
    });
    return table;
  }
  table.corners_.assign(std::size_t{kViews} * kViews * kSliceFloats, 0.f);
  const bool mirrored = is_mirror_symmetric(bsdf);
  const int edge = mirrored ? kViews / 2 : kViews;
  parallel_for(context, static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge), 4, [&](std::size_t begin, std::size_t end) {
    Cells means;
    for (std::size_t view = begin; view < end; ++view) {
      const int x = static_cast<int>(view) % edge, y = static_cast<int>(view) / edge;
      if (!is_read(x, y)) continue;
      Slice(bsdf, lobe, view_direction(x, y), deepest).cells(false, means);
      for (int k = 0; k < (mirrored ? 4 : 1); ++k) {
        const int there_x = k % 2 ? kViews - 1 - x : x, there_y = k / 2 ? kViews - 1 - y : y;
        const Cells turned = k == 0 ? means : mirror(means, k % 2 != 0, k / 2 != 0);
        sum_areas(turned, table.corners_.data() + static_cast<std::size_t>(there_y * kViews + there_x) * kSliceFloats);
      }
    }
  });
  return table;
}

BrdfTable::Slices BrdfTable::slices(const Vec3& wo) const {
  Slices result;
  const auto add = [&](std::size_t view, float weight) {
    result.table[result.count] = corners_.data() + view * kSliceFloats;
    result.weight[result.count++] = weight;
  };
  const Vec2 p = disk_from_direction(wo);
  if (isotropic_) {
    const float place = std::acos(std::clamp(wo.z, 0.f, 1.f)) * ((kViews - 1) / kHalfPi);
    const int first = std::min(static_cast<int>(place), kViews - 2);
    const float part = std::min(place - static_cast<float>(first), 1.f);
    add(static_cast<std::size_t>(first), 1 - part);
    add(static_cast<std::size_t>(first) + 1, part);
    if (const float length = glm::length(p); length > 0) result.turn = {p.x / length, -p.y / length};
    return result;
  }
  const auto place = [](float v) { return std::clamp((v + 1) / kCellSize - 0.5f, 0.f, kViews - 1.f); };
  const float x = place(p.x), y = place(p.y);
  const int x0 = std::min(static_cast<int>(x), kViews - 2), y0 = std::min(static_cast<int>(y), kViews - 2);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      add(grid_index(x0 + i, y0 + j, kViews), (i ? fx : 1 - fx) * (j ? fy : 1 - fy));
    }
  }
  return result;
}

Vec4 BrdfTable::mean_of_four(const Slices& slices, const Vec2& p, float r_p) {
  const Vec2 turned{slices.turn.x * p.x - slices.turn.y * p.y, slices.turn.y * p.x + slices.turn.x * p.y};
  const float half = std::max(r_p * 0.70710678f, kLeastHalf);
  const auto place = [](float v) { return std::clamp((v + 1) / kCellSize, 0.f, static_cast<float>(kCells)); };
  const float x[2] = {place(turned.x - half), place(turned.x + half)}, y[2] = {place(turned.y - half), place(turned.y + half)};
  Vec4 sum(0);
  for (int s = 0; s < slices.count; ++s) {
    const auto corner = [table = slices.table[s]](float column, float row) {
      const int c = std::min(static_cast<int>(column), kCells - 1), r = std::min(static_cast<int>(row), kCells - 1);
      const float fc = column - static_cast<float>(c), fr = row - static_cast<float>(r);
      const auto at = [&](int i, int j) {
        const float* v = table + (static_cast<std::size_t>(r + j) * kCorners + static_cast<std::size_t>(c + i)) * 4;
        return Vec4(v[0], v[1], v[2], v[3]);
      };
      return glm::mix(glm::mix(at(0, 0), at(1, 0), fc), glm::mix(at(0, 1), at(1, 1), fc), fr);
    };
    sum += slices.weight[s] * (corner(x[1], y[1]) - corner(x[0], y[1]) - corner(x[1], y[0]) + corner(x[0], y[0]));
  }
  return sum / (4 * half * half);
}

Color BrdfTable::mean(const Slices& slices, const Vec2& p, float r_p) const {
  const Color mean(mean_of_four(slices, p, r_p));
  // Differences of corners may leave a trace of rounding below 0.
  return signed_ ? mean : glm::max(mean, Color(0));
}

Moments BrdfTable::moments(const Slices& slices, const Vec2& p, float r_p) const {
  const Vec4 mean = mean_of_four(slices, p, r_p);
  const float bright = luminance(Color(mean));
  return {bright, std::sqrt(std::max(0.f, mean.w - bright * bright)), 0};
}

}  // namespace sightline::square_lights
