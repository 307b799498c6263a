#include "methods/fragments/area_light.h"

#include <algorithm>
#include <cmath>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "shade/lights/flat_light.h"

namespace sightline {
namespace {

// Groups of more polygons than this are cheaper to sample than to integrate at every pixel.
constexpr std::size_t kAnalyticMembers = 8;
constexpr std::size_t kDiskPolygon = 32;

AreaLight::Member member_of(const LightTable& lights, std::uint32_t entry) {
  const FlatLight& flat = *lights.flat(entry);
  const FlatEmitter& emitter = *lights.flat_emitter(entry);
  AreaLight::Member member;
  member.entry = entry;
  member.polygon = flat_light_polygon(flat, emitter, kDiskPolygon);
  member.surface = FlatSurface(flat, emitter);
  member.normal = flat.normal;
  member.sides = emitter.is(FlatEmitter::kTwoSided) ? EmitterSides::two : EmitterSides::one;
  member.radiance = emitter.radiance;
  return member;
}

AreaLight group_of(const LightTable& lights, std::span<const std::uint32_t> entries) {
  AreaLight group;
  float power = 0;
  for (const std::uint32_t entry : entries) power += lights.power(entry);
  float sum = 0;
  group.analytic = entries.size() <= kAnalyticMembers;
  for (const std::uint32_t entry : entries) {
    group.members.push_back(member_of(lights, entry));
    group.members.back().probability = lights.power(entry) / power;
    group.analytic = group.analytic && !lights.flat_emitter(entry)->is(FlatEmitter::kTextured);
    group.cumulative.push_back(sum += group.members.back().probability);
  }
  group.cumulative.back() = 1;
  return group;
}

float fraction(float x) { return x - std::floor(x); }

// Where in its stratum point `k` of a set lies.
Vec2 point_jitter(PointJitter jitter, std::uint32_t set, std::uint32_t k, std::uint64_t seed) {
  const std::uint32_t key = hash_combine(pixel_key(seed, jitter == PointJitter::hash ? set : 0), k);
  const Vec2 anywhere{unit_float(hash32(key)), unit_float(hash32(key ^ 0x9e3779b9u))};
  if (jitter == PointJitter::hash) return anywhere;
  constexpr std::uint32_t kShifts = LightPoints::kShifts;
  const std::uint32_t column = set % kShifts, row = set / kShifts;
  const Vec2 shift{static_cast<float>(column) / kShifts, static_cast<float>(row) / kShifts};
  return {fraction(anywhere.x + shift.x), fraction(anywhere.y + shift.y)};
}

}  // namespace

std::size_t AreaLight::pick(float& u) const {
  if (members.size() == 1) return 0;
  const auto found = std::upper_bound(cumulative.begin(), cumulative.end() - 1, u);
  const auto i = static_cast<std::size_t>(found - cumulative.begin());
  const float below = i > 0 ? cumulative[i - 1] : 0.f;
  u = std::clamp((u - below) / std::max(cumulative[i] - below, 1e-20f), 0.f, 0x1.fffffep-1f);
  return i;
}

bool AreaLight::out_of_reach(const Vec3& position, const Vec3& normal) const {
  return std::ranges::all_of(members, [&](const Member& member) {
    if (member.sides == EmitterSides::one && glm::dot(position - member.polygon[0], member.normal) <= 0) return true;
    return std::ranges::all_of(member.polygon, [&](const Vec3& corner) { return glm::dot(corner - position, normal) <= 0; });
  });
}

float AreaLight::solid_angle(const Vec3& position, const Vec3& normal) const {
  float sum = 0;
  for (const Member& member : members) {
    Vec3 centre(0);
    for (const Vec3& corner : member.polygon) centre += corner / static_cast<float>(member.polygon.size());
    Vec3 area(0);
    for (std::size_t i = 2; i < member.polygon.size(); ++i)
      area += 0.5f * glm::cross(member.polygon[i - 1] - member.polygon[0], member.polygon[i] - member.polygon[0]);
    const Vec3 towards = centre - position;
    const float squared = length_squared(towards), size = glm::length(area);
    const bool below = std::ranges::all_of(member.polygon, [&](const Vec3& corner) { return glm::dot(corner - position, normal) <= 0; });
    if (!below) sum += size * std::fabs(glm::dot(towards, member.normal)) / (std::sqrt(squared) * (squared + size));
  }
  return sum;
}

bool AreaLight::above(const Vec3& position, const Vec3& normal) const {
  return std::ranges::all_of(members, [&](const Member& member) {
    return std::ranges::all_of(member.polygon, [&](const Vec3& corner) { return glm::dot(corner - position, normal) > 0; });
  });
}

std::vector<AreaLight> area_lights(const LightTable& lights, std::size_t limit) {
  std::vector<std::uint32_t> entries;
  for (std::uint32_t i = 0; i < lights.size() && lights.flat(i); ++i) {
    if (lights.power(i) > 0) entries.push_back(i);
  }
  // Triangles of a mesh follow each other: neighbours in the table are mostly neighbours in space.
  const std::size_t size = (entries.size() + limit - 1) / limit;
  std::vector<AreaLight> groups;
  for (std::size_t begin = 0; begin < entries.size(); begin += size)
    groups.push_back(group_of(lights, std::span(entries).subspan(begin, std::min(size, entries.size() - begin))));
  return groups;
}

LightPoints light_points(const LightTable& lights, const AreaLight& light, std::uint32_t count, std::uint64_t seed, PointJitter jitter) {
  LightPoints points;
  points.count = count, points.jitter = jitter;
  const std::size_t total = static_cast<std::size_t>(LightPoints::kSets) * count;
  points.point.resize(total), points.normal.resize(total), points.radiance.resize(total);
  points.error.resize(total), points.area.resize(total), points.two_sided.resize(total);
  const std::uint32_t columns = count == 16 ? 4 : 8, rows = count / columns;
  for (std::size_t i = 0; i < total; ++i) {
    const auto k = static_cast<std::uint32_t>(i % count), set = static_cast<std::uint32_t>(i / count);
    const Vec2 offset = point_jitter(jitter, set, k, seed);
    const std::uint32_t column = k % columns, row = k / columns;
    Vec2 u{(static_cast<float>(column) + offset.x) / static_cast<float>(columns),
           (static_cast<float>(row) + offset.y) / static_cast<float>(rows)};
    const AreaLight::Member& member = light.members[light.pick(u.x)];
    // Seen from in front of it, wherever that is.
    const Vec3 front = member.polygon[0] + member.normal * glm::length(member.polygon[1] - member.polygon[0]);
    const LightSample sample = lights.sample_light(member.entry, 1, front, u);
    store(points.point, i, sample.point), store(points.normal, i, sample.normal), store(points.radiance, i, sample.radiance);
    points.error[i] = sample.point_error;
    points.area[i] = lights.area(member.entry) / (member.probability * static_cast<float>(count));
    points.two_sided[i] = member.sides == EmitterSides::two ? 1.f : 0.f;
  }
  return points;
}

}  // namespace sightline
