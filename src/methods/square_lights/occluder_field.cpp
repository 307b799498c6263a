#include "methods/square_lights/occluder_field.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cmath>

#include "base/parallel/parallel.h"
#include "methods/square_lights/hemisphere_disk.h"
#include "shade/cube_map.h"

namespace sightline::square_lights {
namespace {

// From here on the apparent size is what mainly changes with distance, and tables are stretched to that of the point.
constexpr float kStretched = 1.2f;

/// A texel of the cube of directions.
struct Texel {
  int face, x, y;
  std::size_t index() const {
    return static_cast<std::size_t>(face) * kShellSize * kShellSize + static_cast<std::size_t>(y * kShellSize + x);
  }
  Vec3 direction() const { return glm::normalize(cube_direction(face, cube_coordinate(x, kShellSize), cube_coordinate(y, kShellSize))); }
};

/// Texel (x, y) of a face; one beyond its edge is that of the neighbouring face which continues it.
Texel texel_at(int face, int x, int y) {
  if (x >= 0 && y >= 0 && x < kShellSize && y < kShellSize) return {face, x, y};
  const CubePlace place = cube_place(cube_direction(face, cube_coordinate(x, kShellSize), cube_coordinate(y, kShellSize)));
  const auto cell = [](float u) { return std::clamp(static_cast<int>((u + 1) * (kShellSize / 2.f)), 0, kShellSize - 1); };
  return {place.face, cell(place.u), cell(place.v)};
}

/// Four texels around a direction and their weights. Around a corner of the cube there are three: the share of the fourth is theirs.
struct TexelCorners {
  std::array<std::size_t, 4> texel;
  std::array<float, 4> weight;
};
TexelCorners corners_at(const OccluderPlace& place) {
  const int x = place.x, y = place.y;
  const float fx = place.fraction_x, fy = place.fraction_y;
  TexelCorners corners;
  corners.weight = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  if (x >= 0 && y >= 0 && x + 1 < kShellSize && y + 1 < kShellSize) {
    const std::size_t first = Texel{place.face, x, y}.index();
    corners.texel = {first, first + 1, first + kShellSize, first + kShellSize + 1};
    return corners;
  }
  const auto is_beyond = [](int i) { return i < 0 || i >= kShellSize; };
  std::size_t missing = 4;
  for (std::size_t k = 0; k < 4; ++k) {
    const int cx = x + static_cast<int>(k & 1), cy = y + static_cast<int>(k >> 1);
    corners.texel[k] = texel_at(place.face, cx, cy).index();
    if (is_beyond(cx) && is_beyond(cy)) missing = k;
  }
  if (missing < 4) {
    const float share = corners.weight[missing] / 3;
    for (std::size_t k = 0; k < 4; ++k) corners.weight[k] = k == missing ? 0 : corners.weight[k] + share;
  }
  return corners;
}

/// The rotation that frame_from_normal() makes, as a quaternion of any length: that of the least rotation from the nearer pole to the
/// normal, and at the lower pole from half a turn about x.
struct Turn {
  float w, x, y, z;
};
Turn turn_of(const Vec3& normal) {
  return std::signbit(normal.z) ? Turn{-normal.y, 1 - normal.z, 0, normal.x} : Turn{1 + normal.z, -normal.y, normal.x, 0};
}

/// Of the frames that tables of each texel are in; their z is towards the centre.
const std::vector<Turn>& texel_turns() {
  static const std::vector<Turn> turns = [] {
    std::vector<Turn> t(kShellPoints);
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = turn_of(-shell_direction(i));
    return t;
  }();
  return turns;
}

/// Cosines and sines by which four frames see directions turned that the least rotations from the normal of a frame to theirs take along:
/// the twist about z of the rotation between them, which is what its quaternion has beside the axis in the plane. Four numbers side by
/// side, so that the compiler makes vectors of them.
struct LeastTurns {
  std::array<float, 4> cosine, sine;
};
LeastTurns least_turns(const Turn& here, const std::array<std::size_t, 4>& texel) {
  const Turn* const turns = texel_turns().data();
  std::array<float, 4> w, x, y, z;
  for (std::size_t k = 0; k < 4; ++k) {
    const Turn& there = turns[texel[k]];
    w[k] = there.w, x[k] = there.x, y[k] = there.y, z[k] = there.z;
  }
  LeastTurns result;
  for (std::size_t k = 0; k < 4; ++k) {
    const float cosine = w[k] * here.w + x[k] * here.x + y[k] * here.y + z[k] * here.z;
    const float sine = w[k] * here.z - z[k] * here.w - x[k] * here.y + y[k] * here.x;
    const float scale = 1 / (cosine * cosine + sine * sine);
    result.cosine[k] = (cosine * cosine - sine * sine) * scale, result.sine[k] = 2 * cosine * sine * scale;
  }
  return result;
}

}  // namespace

Vec3 shell_direction(std::size_t i) {
  const std::size_t texel = i % kShellPoints;
  const auto part = [](std::size_t value) { return static_cast<int>(value % kShellSize); };
  return Texel{static_cast<int>(texel / (kShellSize * kShellSize)), part(texel), part(texel / kShellSize)}.direction();
}

namespace {

/// apparent_radius() of the shells.
const std::array<float, kShells>& shell_outlines() {
  static const std::array<float, kShells> outlines = [] {
    std::array<float, kShells> o;
    for (int k = 0; k < kShells; ++k) o[k] = apparent_radius(shell_radius(k));
    return o;
  }();
  return outlines;
}

}  // namespace

std::array<float, kShells> shell_zoom(const OccluderFieldOptions& options) {
  std::array<float, kShells> zoom;
  for (int k = 0; k < kShells; ++k) {
    const float rho = shell_radius(k);
    zoom[k] = options.zoom && rho >= kStretched ? 1.3f * apparent_radius(rho) : 1;
  }
  return zoom;
}

OccluderField::OccluderField(const Vec3& center, float radius, const std::array<float, kShells>& zoom, std::span<const std::int8_t> tables)
    : center_(center), radius_(radius), zoom_(zoom), tables_(tables) {}

void OccluderField::measure(const Context& context) {
  auto hidden = std::make_shared<std::vector<float>>(tables_.size() / kTableCells);
  parallel_for(context, hidden->size(), 512, [&](std::size_t begin, std::size_t end) {
    // A cell through which the boundary runs is hidden in part: it reaches from half a cell this side of its centre to half a cell beyond.
    constexpr float codes_per_cell = 2.f / kTableSize / kDistanceStep;
    constexpr int most = static_cast<int>(codes_per_cell * 32);
    for (std::size_t i = begin; i < end; ++i) {
      int sum = 0;
      for (const std::int8_t code : table(i)) sum += std::clamp(most / 2 - 32 * code, 0, most);
      (*hidden)[i] = static_cast<float>(sum) / (static_cast<float>(most) * kTableCells);
    }
  });
  measured_ = std::move(hidden);
  hidden_ = *measured_;
}

void OccluderField::prefetch(std::int32_t table) const {
  const std::int8_t* const bytes = tables_.data() + static_cast<std::size_t>(table) * kTableCells;
  for (std::size_t line = 0; line < kTableCells; line += kCacheLine) hwy::Prefetch(bytes + line);
}

OccluderSamples OccluderField::samples(const OccluderPlace& place) const {
  OccluderSamples result;
  result.frame = frame_from_normal(place.normal);
  result.inside = place.rho < kInnerShell;

  // Deviation: outside the object tables are stretched to the size that the occluder has from here, on both sides of a point and beyond the
  // last shell alike; blending outlines of different sizes would blur them.
  const std::array<float, kShells>& outlines = shell_outlines();
  const auto first = static_cast<std::size_t>(place.shell);
  std::array<float, 2> scale, unit, share{1 - place.between, place.between};
  for (std::size_t s = 0; s < 2; ++s) {
    const bool stretched = place.rho >= kStretched && shell_radius(place.shell + static_cast<int>(s)) >= kStretched;
    const float stretch = stretched ? place.outline / outlines[first + s] : 1;
    scale[s] = zoom_[first + s] * stretch;
    unit[s] = scale[s] * share[s];
  }

  const TexelCorners corners = corners_at(place);
  const LeastTurns turns = least_turns(turn_of(result.frame.normal), corners.texel);
  float hidden = 0;
  for (std::size_t s = 0; s < 2; ++s) {
    const std::size_t shell = (first + s) * kShellPoints;
    const float cells = kTableSize / (2 * scale[s]), hidden_scale = share[s] * 4 * scale[s] * scale[s];
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t i = 4 * s + k, table = shell + corners.texel[k];
      result.table[i] = static_cast<std::int32_t>(table);
      result.turn_x[i] = turns.cosine[k] * cells, result.turn_y[i] = turns.sine[k] * cells;
      result.code_unit[i] = corners.weight[k] * unit[s] * kDistanceStep;
      result.cell_unit[i] = corners.weight[k] * unit[s] * (2.f / kTableSize);
      if (!hidden_.empty()) hidden += corners.weight[k] * hidden_scale * hidden_[table];
    }
  }
  result.hidden_area = !hidden_.empty() ? hidden : place.rho > 1 ? kPi * place.outline * place.outline : 4;
  // 2 sin² (a / 2) = 1 - cos a, with sin a = 1 / rho.
  result.sin_half = place.rho > 1 ? 0.70710678f * place.outline : 2;
  result.cos_half = place.rho > 1 ? place.outline_cosine : 1;
  return result;
}

float OccluderField::distance(const OccluderSamples& samples, const Vec3& c, float r) const {
  // The cone cull: on the disk the angle g is at sqrt(2) sin(g / 2) from the centre, and the light reaches 1.1 r.
  const Vec2 p = disk_from_direction(samples.frame.to_local(c));
  const float reach = std::min(0.55f * r, 1.f);
  const float farthest = samples.sin_half * std::sqrt(1 - reach * reach) + samples.cos_half * reach;
  if (p.x * p.x + p.y * p.y > 2 * (farthest * farthest)) return kBeyondOccluder;

  std::array<float, 8> part;
  for (int i = 0; i < 8; ++i) {
    constexpr float last = kTableSize - 1, middle = last / 2;
    const Vec2 turn(samples.turn_x[i], samples.turn_y[i]);
    const float u = turn.x * p.x + turn.y * p.y + middle, v = turn.x * p.y - turn.y * p.x + middle;
    const float cu = std::clamp(u, 0.f, last), cv = std::clamp(v, 0.f, last);
    const int x = std::min(static_cast<int>(cu), kTableSize - 2), y = std::min(static_cast<int>(cv), kTableSize - 2);
    const float fx = cu - static_cast<float>(x), fy = cv - static_cast<float>(y);
    const std::int8_t* const corner = tables_.data() + static_cast<std::size_t>(samples.table[i]) * kTableCells + y * kTableSize + x;
    const auto blend = [](float t, float a, float b) { return a + t * (b - a); };
    const float code = blend(fy, blend(fx, corner[0], corner[1]), blend(fx, corner[kTableSize], corner[kTableSize + 1]));
    // Beyond the square lies nothing but distance.
    const float beyond = std::sqrt((u - cu) * (u - cu) + (v - cv) * (v - cv));
    part[i] = samples.code_unit[i] * code + samples.cell_unit[i] * beyond;
  }
  const float d = ((part[0] + part[4]) + (part[2] + part[6])) + ((part[1] + part[5]) + (part[3] + part[7]));

  // Deviation: Eq. 9 takes every boundary for a straight line, which hides half of a square around an occluder however small that is. It
  // cannot hide more than its own area. The D at which the mean coverage over all turns leaves that much: Eq. 9 solved for D, but for
  // small areas, where the corners of turned squares count, 1 - t = sqrt(2 (1 - F)), which fits the mean within 0.01.
  const float half_edge = std::max(0.5f * r, 1e-6f), s = std::sqrt(0.5f * samples.hidden_area) / half_edge;
  return std::max(d, half_edge * (s < 0.41421356f ? 1.41421356f * (1 - s) : 1 - s * s));
}

float OccluderField::visibility(const Vec3& position, const Vec3& c, float r, Coverage coverage) const {
  const float d = distance(samples(position), c, r), r_p = plane_radius(r);
  // The map's frame says nothing about the turn of the square, so a gradient has no use here.
  return coverage == Coverage::parallel ? covered_parallel(d, r_p) : covered_average(d, r_p);
}

}  // namespace sightline::square_lights
