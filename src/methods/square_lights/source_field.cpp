#include "methods/square_lights/source_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel/parallel.h"
#include "shade/cube_map.h"

namespace sightline::square_lights {
namespace {

constexpr std::size_t kSourceShellPoints = std::size_t{6} * kSourceSize * kSourceSize;

/// Radius of shell k: logarithmic.
float source_radius(std::size_t k) {
  return kInnerSource * std::pow(kOuterSource / kInnerSource, static_cast<float>(k) / (kSourceShells - 1));
}

/// Points lie on the edges of faces too, so that neither face needs the other's.
Vec3 point_direction(std::size_t point) {
  const auto coordinate = [](std::size_t i) { return 2 * static_cast<float>(i) / (kSourceSize - 1) - 1; };
  const std::size_t x = point % kSourceSize, y = point / kSourceSize % kSourceSize, face = point / (kSourceSize * kSourceSize);
  return glm::normalize(cube_direction(static_cast<int>(face), coordinate(x), coordinate(y)));
}

/// The octahedron folded onto the square [-1, 1]², 16 bits a coordinate.
std::uint32_t pack_direction(const Vec3& d) {
  const float sum = std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z);
  Vec2 p = Vec2(d.x, d.y) / sum;
  if (d.z < 0) p = {std::copysign(1 - std::fabs(p.y), p.x), std::copysign(1 - std::fabs(p.x), p.y)};
  const auto code = [](float v) { return static_cast<std::uint32_t>(std::lround((std::clamp(v, -1.f, 1.f) * 0.5f + 0.5f) * 65535)); };
  return code(p.x) | code(p.y) << 16;
}

Vec3 unpack_direction(std::uint32_t code) {
  Vec2 p = Vec2(static_cast<float>(code & 0xffffu), static_cast<float>(code >> 16)) * (2 / 65535.f) - 1.f;
  const float z = 1 - std::fabs(p.x) - std::fabs(p.y);
  if (z < 0) p = {std::copysign(1 - std::fabs(p.y), p.x), std::copysign(1 - std::fabs(p.x), p.y)};
  return glm::normalize(Vec3(p.x, p.y, z));
}

/// Three 9-bit mantissas and one 5-bit exponent, which covers 2^-16 to 2^15 times the unit of the greatest.
std::uint32_t pack_radiance(const Color& c) {
  const Color v = glm::clamp(c, 0.f, 65408.f);
  const float most = max_component(v);
  int exponent = 0;
  std::frexp(most, &exponent);
  exponent = std::clamp(exponent, -15, 16);
  if (std::lround(std::ldexp(most, 9 - exponent)) > 511) ++exponent;
  const auto mantissa = [exponent](float value) { return static_cast<std::uint32_t>(std::lround(std::ldexp(value, 9 - exponent))); };
  return mantissa(v.x) | mantissa(v.y) << 9 | mantissa(v.z) << 18 | static_cast<std::uint32_t>(exponent + 15) << 27;
}

Color unpack_radiance(std::uint32_t code) {
  const float scale = std::ldexp(1.f, static_cast<int>(code >> 27) - 15 - 9);
  return Color(static_cast<float>(code & 511u), static_cast<float>(code >> 9 & 511u), static_cast<float>(code >> 18 & 511u)) * scale;
}

/// Four points of a shell around a direction and their weights.
struct ShellPlace {
  std::array<std::size_t, 4> point;
  std::array<float, 4> weight;
};

ShellPlace place_on_shell(const Vec3& direction) {
  const CubePlace at = cube_place(direction);
  const float x = std::clamp((at.u + 1) * 0.5f, 0.f, 1.f) * (kSourceSize - 1),
              y = std::clamp((at.v + 1) * 0.5f, 0.f, 1.f) * (kSourceSize - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(x), std::size_t{kSourceSize - 2});
  const std::size_t j = std::min(static_cast<std::size_t>(y), std::size_t{kSourceSize - 2});
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
  const std::size_t first = (static_cast<std::size_t>(at.face) * kSourceSize + j) * kSourceSize + i;
  return {{first, first + 1, first + kSourceSize, first + kSourceSize + 1}, {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

}  // namespace

void SourceField::lights_at(const Vec3& position, std::span<PatchLight> lights) const {
  const Vec3 here = (position - center_) / radius_;  // in radii, from the centre
  const float distance = glm::length(here);
  const ShellPlace place = place_on_shell(distance > 0 ? here / distance : Vec3(0, 0, 1));
  const float shells = std::log(kOuterSource / kInnerSource) / (kSourceShells - 1);
  const float shell = std::clamp(std::log(std::max(distance, kInnerSource) / kInnerSource) / shells, 0.f, kSourceShells - 1.f);
  const std::size_t first = std::min(static_cast<std::size_t>(shell), std::size_t{kSourceShells - 2});
  const float part = shell - static_cast<float>(first);

  struct Sample {
    Vec3 from;
    const PackedPatch* patches;
    float weight;
  };
  std::array<Sample, 8> samples;
  for (std::size_t k = 0; k < 8; ++k) {
    const std::size_t level = first + k / 4, point = place.point[k % 4];
    samples[k] = {source_radius(level) * point_direction(point), table_.data() + (level * kSourceShellPoints + point) * count_,
                  place.weight[k % 4] * (k / 4 ? part : 1 - part)};
  }
  for (std::size_t i = 0; i < count_; ++i) {
    Vec3 patch(0);
    Color radiance(0);
    float shown = 0;  // solid angle times squared distance
    for (const Sample& s : samples) {
      const PackedPatch& p = s.patches[i];
      const float area = 2 * p.radius * p.radius * p.distance * p.distance;
      patch += s.weight * (s.from + p.distance * unpack_direction(p.direction));
      radiance += s.weight * unpack_radiance(p.radiance);
      shown += s.weight * area;
    }
    const Vec3 away = patch - here;
    const float squared = length_squared(away), length = std::sqrt(squared);
    // Solid angles end at the half sphere, which a plane fills that one touches.
    const float angle = squared > 0 ? std::min(shown / squared, 2 * kPi) : 0.f;
    lights[i] = {{normalize_or(away, Vec3(0, 0, 1)), std::sqrt(0.5f * angle), radiance}, length * radius_};
  }
}

std::uint64_t source_field_bytes(const LocalLight& light) { return kSourcePoints * light.count() * sizeof(PackedPatch); }

AlignedVector<PackedPatch> bake_source_field(const LocalLight& light, const Context& context) {
  const std::size_t count = light.count();
  AlignedVector<PackedPatch> table(kSourcePoints * count);
  const float radius = light.radius() > 0 ? light.radius() : 1.f;
  parallel_for(context, kSourcePoints, 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<PatchLight> lights(count);
    for (std::size_t point = begin; point < end; ++point) {
      const Vec3 from = source_radius(point / kSourceShellPoints) * point_direction(point % kSourceShellPoints);
      light.lights_at(light.center() + radius * from, lights);
      for (std::size_t i = 0; i < count; ++i) {
        const PatchLight& p = lights[i];
        table[point * count + i] = {pack_direction(p.light.center), pack_radiance(p.light.radiance), p.light.radius, p.distance / radius};
      }
    }
  });
  return table;
}

}  // namespace sightline::square_lights
