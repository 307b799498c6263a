#include "methods/square_lights/local_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/math/frame.h"
#include "shade/lights/flat_light.h"
#include "shade/lights/mesh_lights.h"

namespace sightline::square_lights {
namespace {

/// Patches that are smaller than this in solid angle need no exact mean direction.
constexpr float kSmall = 1e-3f;

/// Solid angle of the spherical triangle of three directions, signed by their sense [VanOosterom1983].
double triangle_solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double numerator = glm::dot(a, glm::cross(b, c));
  const double denominator = la * lb * lc + glm::dot(a, b) * lc + glm::dot(a, c) * lb + glm::dot(b, c) * la;
  return 2 * std::atan2(numerator, denominator);
}

/// Integral of the direction over a spherical polygon, along its normals by the arcs [Lambert1760].
Vec3d direction_integral(const std::array<Vec3d, 4>& corners) {
  Vec3d sum(0);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3d &a = corners[i], &b = corners[(i + 1) % 4], normal = glm::cross(a, b);
    const double sine = glm::length(normal);
    if (sine > 0) sum += normal * (std::atan2(sine, glm::dot(a, b)) / sine);
  }
  return 0.5 * sum;
}

/// A cell of the unit square as a cell of the unit disk, of equal area.
std::array<Vec2, 4> disk_cell(std::size_t x, std::size_t y, std::size_t edge) {
  const auto at = [edge](std::size_t i, std::size_t j) {
    return sample_concentric_disk({static_cast<float>(i) / static_cast<float>(edge), static_cast<float>(j) / static_cast<float>(edge)});
  };
  return {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)};
}

/// Two halves, cut across the longer edge.
std::array<AreaPatch, 2> halves(const AreaPatch& patch) {
  std::array<AreaPatch, 2> result{patch, patch};
  const bool along_u = length_squared(patch.half_u) >= length_squared(patch.half_v);
  const Vec3 half = 0.5f * (along_u ? patch.half_u : patch.half_v);
  for (std::size_t i = 0; i < 2; ++i) {
    (along_u ? result[i].half_u : result[i].half_v) = half;
    result[i].center += i == 0 ? -half : half;
  }
  return result;
}

/// Where two pieces differ, position by the size of the whole and normal alike.
using Feature = std::array<float, 6>;
Feature feature(const AreaPatch& p, float scale) {
  const Vec3 n = normalize_or(glm::cross(p.half_u, p.half_v), Vec3(0));
  return {p.center.x * scale, p.center.y * scale, p.center.z * scale, n.x, n.y, n.z};
}

struct Cluster {
  std::size_t begin, end;
  float spread = 0;  ///< area times variance along the widest axis
  std::size_t axis = 0;
};

Cluster measure(std::span<const AreaPatch> pieces, std::size_t begin, std::size_t end, float scale) {
  Cluster cluster{begin, end};
  std::array<double, 6> mean{}, square{};
  double area = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const Feature f = feature(pieces[i], scale);
    const double a = pieces[i].area();
    area += a;
    for (std::size_t k = 0; k < 6; ++k) mean[k] += a * f[k], square[k] += a * f[k] * f[k];
  }
  for (std::size_t k = 0; k < 6 && area > 0; ++k) {
    const auto spread = static_cast<float>(square[k] - mean[k] * mean[k] / area);
    if (spread > cluster.spread) cluster.spread = spread, cluster.axis = k;
  }
  return cluster;
}

/// One square for pieces that lie close together and face alike.
AreaPatch gather(std::span<const AreaPatch> pieces) {
  Vec3d normal(0), center(0);
  glm::dvec3 flux(0);
  double area = 0;
  bool two_sided = true;
  for (const AreaPatch& p : pieces) {
    const double a = p.area();
    normal += 4.0 * Vec3d(glm::cross(p.half_u, p.half_v));
    center += a * Vec3d(p.center);
    flux += a * glm::dvec3(p.radiance);
    area += a;
    two_sided = two_sided && p.two_sided;
  }
  AreaPatch result;
  result.two_sided = two_sided;
  if (!(area > 0)) return result;
  result.center = Vec3(center / area);
  const double shown = glm::length(normal);
  const Frame3 frame = frame_from_normal(normalize_or(Vec3(normal), Vec3(0, 0, 1)));
  const float half = 0.5f * static_cast<float>(std::sqrt(std::max(shown, 0.25 * area)));
  result.half_u = half * frame.tangent;
  result.half_v = half * frame.bitangent;
  result.radiance = Color(flux / area);
  return result;
}

AreaPatch patch_of(const FlatLight& light, const FlatEmitter& emitter, const Color& radiance) {
  AreaPatch patch;
  patch.radiance = radiance;
  patch.two_sided = emitter.is(FlatEmitter::kTwoSided);
  if (emitter.is(FlatEmitter::kTriangle)) {
    // Half of the parallelogram's area, around the centroid.
    patch.center = light.origin + (light.e1 + light.e2) / 3.f;
    patch.half_u = 0.35355339f * light.e1;
    patch.half_v = 0.35355339f * (light.e2 - 0.5f * light.e1);
  } else {
    patch.center = light.origin + 0.5f * (light.e1 + light.e2);
    patch.half_u = 0.5f * light.e1;
    patch.half_v = 0.5f * light.e2;
  }
  if (glm::dot(glm::cross(patch.half_u, patch.half_v), light.normal) < 0) patch.half_v = -patch.half_v;
  return patch;
}

}  // namespace

PatchLight patch_light(const AreaPatch& patch, const Vec3& position) {
  const Vec3 away = patch.center - position, normal = glm::cross(patch.half_u, patch.half_v);
  const float distance = glm::length(away);
  PatchLight result{{normalize_or(away, Vec3(0, 0, 1)), 0, patch.radiance}, distance};
  const bool front = glm::dot(away, normal) < 0;
  if (!(distance > 0) || !(front || patch.two_sided)) return result;
  const Vec3d u(patch.half_u), v(patch.half_v), c(away);
  const std::array<Vec3d, 4> corners{c - u - v, c + u - v, c + u + v, c - u + v};
  const double angle =
      std::fabs(triangle_solid_angle(corners[0], corners[1], corners[2]) + triangle_solid_angle(corners[0], corners[2], corners[3]));
  result.light.radius = static_cast<float>(std::sqrt(0.5 * angle));
  if (angle > kSmall) {
    std::array<Vec3d, 4> unit = corners;
    for (Vec3d& corner : unit) corner = glm::length(corner) > 0 ? glm::normalize(corner) : corner;
    const Vec3 mean(direction_integral(unit));
    const Vec3 direction = normalize_or(mean, result.light.center);
    result.light.center = glm::dot(direction, away) < 0 ? -direction : direction;
  }
  return result;
}

LocalLight LocalLight::rectangle(const RectangleLight& light, int patches) {
  const std::array<AreaPatch, 1> whole{AreaPatch{light.center, light.half_u, light.half_v, light.radiance, false}};
  return pieces(whole, patches);
}

LocalLight LocalLight::disk(const DiskLight& light, int patches) {
  LocalLight result;
  const auto edge = static_cast<std::size_t>(std::max(1.0, std::round(std::sqrt(patches))));
  for (std::size_t y = 0; y < edge; ++y) {
    for (std::size_t x = 0; x < edge; ++x) {
      std::array<Vec2, 4> p = disk_cell(x, y, edge);
      // A whole disk, whose cell wraps around it, is the square of its area.
      if (edge == 1) p = {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)};
      const Vec2 middle = 0.25f * (p[0] + p[1] + p[2] + p[3]), u = 0.25f * (p[1] + p[2] - p[0] - p[3]),
                 v = 0.25f * (p[2] + p[3] - p[0] - p[1]);
      // Corners joined by straight lines enclose a little less than the cell.
      const float area = 4 * std::fabs(u.x * v.y - u.y * v.x), grow = std::sqrt(kPi / (static_cast<float>(edge * edge) * area));
      const auto place = [&light](const Vec2& q) { return q.x * light.half_u + q.y * light.half_v; };
      AreaPatch patch{light.center + place(middle), grow * place(u), grow * place(v), light.radiance, false};
      if (u.x * v.y - u.y * v.x < 0) patch.half_v = -patch.half_v;
      result.patches_.push_back(patch);
    }
  }
  result.bound();
  return result;
}

LocalLight LocalLight::sphere(const SphereLight& light, int patches) {
  LocalLight result;
  result.sphere_edge_ = static_cast<std::size_t>(std::max(1.0, std::round(std::sqrt(patches))));
  result.sphere_radiance_ = light.radiance;
  result.center_ = light.center;
  result.radius_ = light.radius;
  return result;
}

LocalLight LocalLight::pieces(std::span<const AreaPatch> pieces, int patches) {
  LocalLight result;
  const auto wanted = static_cast<std::size_t>(std::max(patches, 1));
  std::vector<AreaPatch> all(pieces.begin(), pieces.end());
  std::erase_if(all, [](const AreaPatch& p) { return !(p.area() > 0) || !std::isfinite(p.area()); });
  if (all.size() <= wanted) {
    // The largest is halved until there are enough.
    const auto smaller = [](const AreaPatch& a, const AreaPatch& b) { return a.area() < b.area(); };
    std::make_heap(all.begin(), all.end(), smaller);
    while (!all.empty() && all.size() < wanted) {
      std::pop_heap(all.begin(), all.end(), smaller);
      const std::array<AreaPatch, 2> parts = halves(all.back());
      all.back() = parts[0];
      std::push_heap(all.begin(), all.end(), smaller);
      all.push_back(parts[1]);
      std::push_heap(all.begin(), all.end(), smaller);
    }
    result.patches_ = std::move(all);
    result.bound();
    return result;
  }
  // The most spread out group is cut at the middle of its widest axis.
  result.patches_ = all;
  result.bound();
  const float scale = result.radius_ > 0 ? 1 / result.radius_ : 1.f;
  std::vector<Cluster> clusters{measure(all, 0, all.size(), scale)};
  while (clusters.size() < wanted) {
    const auto widest =
        std::max_element(clusters.begin(), clusters.end(), [](const auto& a, const auto& b) { return a.spread < b.spread; });
    const Cluster cut = *widest;
    if (!(cut.spread > 0) || cut.end - cut.begin < 2) break;
    const auto less = [&](const AreaPatch& a, const AreaPatch& b) { return feature(a, scale)[cut.axis] < feature(b, scale)[cut.axis]; };
    std::stable_sort(all.begin() + static_cast<std::ptrdiff_t>(cut.begin), all.begin() + static_cast<std::ptrdiff_t>(cut.end), less);
    double area = 0, before = 0;
    for (std::size_t i = cut.begin; i < cut.end; ++i) area += all[i].area();
    std::size_t middle = cut.begin;
    while (middle + 1 < cut.end && before < 0.5 * area) before += all[middle++].area();
    *widest = measure(all, cut.begin, middle, scale);
    clusters.push_back(measure(all, middle, cut.end, scale));
  }
  result.patches_.clear();
  for (const Cluster& c : clusters) result.patches_.push_back(gather(std::span(all).subspan(c.begin, c.end - c.begin)));
  return result;
}

void LocalLight::bound() {
  if (patches_.empty()) return;
  const auto for_each_corner = [this](auto&& visit) {
    for (const AreaPatch& p : patches_) {
      for (const float a : {-1.f, 1.f}) {
        for (const float b : {-1.f, 1.f}) visit(p.center + a * p.half_u + b * p.half_v);
      }
    }
  };
  Vec3 low(patches_.front().center), high(low);
  for_each_corner([&](const Vec3& corner) { low = glm::min(low, corner), high = glm::max(high, corner); });
  center_ = 0.5f * (low + high);
  radius_ = 0;
  for_each_corner([&](const Vec3& corner) { radius_ = std::max(radius_, glm::length(corner - center_)); });
}

void LocalLight::lights_at(const Vec3& position, std::span<PatchLight> lights) const {
  if (!is_sphere()) {
    for (std::size_t i = 0; i < patches_.size(); ++i) lights[i] = patch_light(patches_[i], position);
    return;
  }
  const Vec3 away = center_ - position;
  const float distance2 = length_squared(away), distance = std::sqrt(distance2);
  const Frame3 frame = frame_from_normal(normalize_or(away, Vec3(0, 0, 1)));
  // A cap of directions, cut into parts of equal solid angle; nothing from within. 1 - cos of its edge, without cancellation far away.
  const float sine2 = distance2 > radius_ * radius_ ? radius_ * radius_ / distance2 : 0.f;
  const float height = sine2 / (1 + std::sqrt(1 - sine2));
  const auto edge = static_cast<float>(sphere_edge_);
  const float radius = std::sqrt(kPi * height) / edge;
  for (std::size_t i = 0; i < count(); ++i) {
    // Mean direction of the part, from its quarters.
    Vec3 mean(0);
    for (int q = 0; q < 4; ++q) {
      const std::size_t row = i / sphere_edge_;
      const int lower = q / 2;
      const Vec2 p = sample_concentric_disk({(static_cast<float>(i % sphere_edge_) + 0.25f + 0.5f * static_cast<float>(q % 2)) / edge,
                                             (static_cast<float>(row) + 0.25f + 0.5f * static_cast<float>(lower)) / edge});
      const float drop = glm::dot(p, p) * height, k = std::sqrt(height * (2 - drop));
      mean += Vec3(p.x * k, p.y * k, 1 - drop);
    }
    const Vec3 direction = sphere_edge_ == 1 ? frame.normal : frame.to_world(glm::normalize(mean));
    lights[i] = {{direction, radius, sphere_radiance_}, std::max(distance - radius_, 0.f)};
  }
}

LocalLight LocalLight::transformed(const Mat4& to_from_here) const {
  LocalLight result = *this;
  const float scale = std::cbrt(std::fabs(glm::determinant(Mat3(to_from_here))));
  const bool mirrored = glm::determinant(Mat3(to_from_here)) < 0;
  result.center_ = transform_point(to_from_here, center_);
  result.radius_ = radius_ * scale;
  for (AreaPatch& p : result.patches_) {
    p.center = transform_point(to_from_here, p.center);
    p.half_u = transform_vector(to_from_here, p.half_u);
    p.half_v = transform_vector(to_from_here, p.half_v) * (mirrored ? -1.f : 1.f);
  }
  return result;
}

std::vector<LocalLight> collect_local_lights(const Scene& scene, const LightTable& lights, const TextureSet& textures, int patches) {
  std::vector<LocalLight> result;
  std::map<std::uint32_t, std::vector<AreaPatch>> by_instance;
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    const FlatLight* flat = lights.flat(i);
    const FlatEmitter* emitter = lights.flat_emitter(i);
    if (flat == nullptr || emitter == nullptr || !(flat->area > 0)) continue;
    Color radiance = emitter->radiance;
    if (emitter->is(FlatEmitter::kTextured)) radiance *= glm::max(Color(textures.mean(emitter->texture)), Color(0));
    if (is_black(radiance)) continue;
    if (emitter->is(FlatEmitter::kDisk)) {
      const bool turned = glm::dot(glm::cross(flat->e1, flat->e2), flat->normal) < 0;
      result.push_back(LocalLight::disk({flat->origin, flat->e1, turned ? -flat->e2 : flat->e2, radiance}, patches));
    } else if (emitter->is(FlatEmitter::kMesh)) {
      by_instance[emitter->source].push_back(patch_of(*flat, *emitter, radiance));
    } else {
      const std::array<AreaPatch, 1> whole{patch_of(*flat, *emitter, radiance)};
      result.push_back(LocalLight::pieces(whole, patches));
    }
  }
  for (const auto& [instance, pieces] : by_instance) result.push_back(LocalLight::pieces(pieces, patches));
  for (const Light& light : scene.lights) {
    if (const auto* sphere = std::get_if<SphereLight>(&light.shape)) result.push_back(LocalLight::sphere(*sphere, patches));
  }
  for (const Sphere& sphere : scene.spheres) {
    const Color radiance = usable_emission(scene, sphere.material);
    if (!is_black(radiance)) result.push_back(LocalLight::sphere({sphere.center, sphere.radius, radiance}, patches));
  }
  return result;
}

}  // namespace sightline::square_lights
