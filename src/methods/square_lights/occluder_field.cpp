#include "methods/square_lights/occluder_field.h"

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
TexelCorners corners_at(const Vec3& direction) {
  const CubePlace place = cube_place(direction);
  const float u = (place.u + 1) * (kShellSize / 2.f) - 0.5f, v = (place.v + 1) * (kShellSize / 2.f) - 0.5f;
  const int x = std::clamp(static_cast<int>(std::floor(u)), -1, kShellSize - 1);
  const int y = std::clamp(static_cast<int>(std::floor(v)), -1, kShellSize - 1);
  const float fx = std::clamp(u - static_cast<float>(x), 0.f, 1.f), fy = std::clamp(v - static_cast<float>(y), 0.f, 1.f);
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

/// The frames that tables of each texel are in; z is towards the centre.
const std::vector<Frame3>& texel_frames() {
  static const std::vector<Frame3> frames = [] {
    std::vector<Frame3> f(kShellPoints);
    for (std::size_t i = 0; i < f.size(); ++i) f[i] = frame_from_normal(-shell_direction(i));
    return f;
  }();
  return frames;
}

/// Cosines and sines by which four frames see directions turned that the least rotations from frame.normal to their normals take along.
/// Four numbers side by side, so that the compiler makes vectors of them.
struct LeastTurns {
  std::array<float, 4> cosine, sine;
};
LeastTurns least_turns(const Frame3& frame, const std::array<const Frame3*, 4>& there) {
  using Four = std::array<float, 4>;
  Four to[3], own_tangent[3], own_bitangent[3];
  for (std::size_t k = 0; k < 4; ++k) {
    for (int c = 0; c < 3; ++c) {
      to[c][k] = there[k]->normal[c], own_tangent[c][k] = there[k]->tangent[c], own_bitangent[c][k] = there[k]->bitangent[c];
    }
  }
  const Vec3 n = frame.normal, t = frame.tangent;
  LeastTurns turns;
  for (std::size_t k = 0; k < 4; ++k) {
    // axis = n x to; the tangent moves by axis x t + axis x (axis x t) / (1 + n . to).
    const float ax = n.y * to[2][k] - to[1][k] * n.z, ay = n.z * to[0][k] - to[2][k] * n.x, az = n.x * to[1][k] - to[0][k] * n.y;
    const float mx = ay * t.z - t.y * az, my = az * t.x - t.z * ax, mz = ax * t.y - t.x * ay;
    const float scale = 1 + (n.x * to[0][k] + n.y * to[1][k] + n.z * to[2][k]);
    const float x = t.x + mx + (ay * mz - my * az) / scale, y = t.y + my + (az * mx - mz * ax) / scale,
                z = t.z + mz + (ax * my - mx * ay) / scale;
    turns.cosine[k] = x * own_tangent[0][k] + y * own_tangent[1][k] + z * own_tangent[2][k];
    turns.sine[k] = x * own_bitangent[0][k] + y * own_bitangent[1][k] + z * own_bitangent[2][k];
  }
  return turns;
}

}  // namespace

float shell_radius(int k) {
  static const std::array<float, kShells> radii = [] {
    std::array<float, kShells> r;
    for (int i = 0; i < kShells; ++i) r[i] = kInnerShell * std::pow(kOuterShell / kInnerShell, static_cast<float>(i) / (kShells - 1));
    return r;
  }();
  return radii[static_cast<std::size_t>(k)];
}

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

float apparent_radius(float rho) {
  if (rho <= 1) return 1;
  // 1 - cos, in a form that keeps its digits far away.
  const float sin2 = 1 / (rho * rho);
  return std::sqrt(sin2 / (1 + std::sqrt(1 - sin2)));
}

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

OccluderSamples OccluderField::samples(const Vec3& position) const {
  OccluderSamples result;
  const Vec3 away = position - center_;
  const float rho = glm::length(away) / radius_;
  const Vec3 out = normalize_or(away, Vec3(0, 0, 1));
  result.frame = frame_from_normal(-out);
  result.inside = rho < kInnerShell;

  // Between which shells. Deviation: outside the object tables are stretched to the size that the occluder has from here, on both sides of
  // a point and beyond the last shell alike; blending outlines of different sizes would blur them.
  const float here = apparent_radius(rho);
  constexpr float shells_per_log = (kShells - 1) / 2.7080502f;  // ln(kOuterShell / kInnerShell)
  const float level = std::clamp(std::log(std::max(rho, 1e-6f) / kInnerShell) * shells_per_log, 0.f, static_cast<float>(kShells - 1));
  const int first = std::min(static_cast<int>(level), kShells - 2);
  const float between = level - static_cast<float>(first);
  std::array<float, 2> scale, unit, share{1 - between, between};
  for (int s = 0; s < 2; ++s) {
    const float shell = shell_radius(first + s);
    const float stretch = rho >= kStretched && shell >= kStretched ? here / shell_outlines()[first + s] : 1;
    scale[s] = zoom_[first + s] * stretch;
    unit[s] = scale[s] * share[s];
  }

  const TexelCorners corners = corners_at(out);
  const std::vector<Frame3>& frames = texel_frames();
  const LeastTurns turns = least_turns(
      result.frame, {&frames[corners.texel[0]], &frames[corners.texel[1]], &frames[corners.texel[2]], &frames[corners.texel[3]]});
  float hidden = 0;
  for (std::size_t s = 0; s < 2; ++s) {
    const std::size_t shell = (static_cast<std::size_t>(first) + s) * kShellPoints;
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
  result.hidden_area = !hidden_.empty() ? hidden : rho > 1 ? kPi * here * here : 4;
  // 2 sin² (a / 2) = 1 - cos a, with sin a = 1 / rho.
  result.sin_half = rho > 1 ? 0.70710678f * here : 2;
  result.cos_half = rho > 1 ? std::sqrt(1 - 0.5f * here * here) : 1;
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
