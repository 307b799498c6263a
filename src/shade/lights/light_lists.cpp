#include "shade/lights/light_lists.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>

#include "base/core/error.h"

namespace sightline {
namespace {

Color positive(const Color& c) { return glm::max(c, Color(0)); }

/// A rectangle (origin at its corner) or a disk (origin at its centre).
template <class Shape>
FlatLight flat_from(const Shape& shape, bool is_disk) {
  FlatLight light;
  light.origin = is_disk ? shape.center : shape.center - shape.half_u - shape.half_v;
  light.e1 = is_disk ? shape.half_u : 2.f * shape.half_u;
  light.e2 = is_disk ? shape.half_v : 2.f * shape.half_v;
  const Vec3d cross = glm::cross(Vec3d(light.e1), Vec3d(light.e2));
  const double length = glm::length(cross);
  if (length > 0) light.normal = Vec3(cross / length);
  light.area = static_cast<float>(is_disk ? std::numbers::pi * length : length);
  const Vec3 reach = glm::abs(shape.center) + glm::abs(shape.half_u) + glm::abs(shape.half_v);
  light.point_error = 4 * std::numeric_limits<float>::epsilon() * max_component(reach);
  return light;
}

PunctualLight punctual_from(const PointLight& l) {
  PunctualLight light;
  light.position = l.position;
  light.intensity = positive(l.intensity);
  return light;
}
PunctualLight punctual_from(const DirectionalLight& l) {
  PunctualLight light;
  light.kind = PunctualLight::kDirectional;
  light.direction = normalize_or(l.direction, Vec3(0, -1, 0));
  light.intensity = positive(l.irradiance);
  return light;
}
PunctualLight punctual_from(const SpotLight& l) {
  PunctualLight light;
  light.kind = PunctualLight::kSpot;
  light.position = l.position;
  light.direction = normalize_or(l.direction, Vec3(0, 0, -1));
  light.intensity = positive(l.intensity);
  const double outer = std::clamp(static_cast<double>(l.outer_angle_rad), 0.0, std::numbers::pi);
  const double inner = std::clamp(static_cast<double>(l.inner_angle_rad), 0.0, outer);
  light.cos_outer = static_cast<float>(std::cos(outer));
  light.cos_inner = static_cast<float>(std::cos(inner));
  light.falloff = l.falloff;
  return light;
}

/// W through all directions; a directional light lights the disk of the scene's bounding sphere.
float power_of(const PunctualLight& light, double scene_disk_area) {
  const double intensity = static_cast<double>(luminance(light.intensity));
  switch (light.kind) {
    case PunctualLight::kPoint:
      return static_cast<float>(4 * std::numbers::pi * intensity);
    case PunctualLight::kDirectional:
      return static_cast<float>(scene_disk_area * intensity);
    case PunctualLight::kSpot:
      return static_cast<float>(spot_solid_angle(light) * intensity);
  }
  return 0;
}

float power_of(const SphereEmitter& sphere) {
  const float sides = (sphere.emits_outside ? 1.f : 0.f) + (sphere.emits_inside ? 1.f : 0.f);
  return luminance(sphere.radiance) * 4 * kPi * kPi * sphere.radius * sphere.radius * sides;
}

bool is_usable(const PointLight& l) { return is_finite(l.position) && is_finite(l.intensity); }
bool is_usable(const SpotLight& l) {
  return is_finite(l.position) && is_finite(l.direction) && is_finite(l.intensity) && std::isfinite(l.inner_angle_rad) &&
         std::isfinite(l.outer_angle_rad);
}
bool is_usable(const DirectionalLight& l) { return is_finite(l.direction) && is_finite(l.irradiance); }
bool is_usable(const SphereLight& l) { return is_finite(l.center) && l.radius > 0 && std::isfinite(l.radius) && is_finite(l.radiance); }
template <class Flat>
bool is_usable(const Flat& l) {
  return is_finite(l.center) && is_finite(l.half_u) && is_finite(l.half_v) && is_finite(l.radiance);
}

template <class Shape>
std::vector<const Shape*> lights_of(const std::vector<Light>& lights) {
  std::vector<const Shape*> found;
  for (const Light& light : lights) {
    const auto* shape = std::get_if<Shape>(&light.shape);
    if (shape && is_usable(*shape)) found.push_back(shape);
  }
  return found;
}

}  // namespace

LightLists::LightLists(const Scene& scene, const TextureSet& textures, const Bounds& bounds, const Context& context,
                       const EnvironmentLight* previous) {
  for (const Light& light : scene.lights) {
    if (std::visit([](const auto& shape) { return is_usable(shape); }, light.shape)) continue;
    context.warn(fmt::format("light '{}' is not finite or has no size; it is left out", light.name));
  }
  const auto next_index = [&] { return size(); };
  const auto add_flat = [&](const auto& shape, std::uint32_t flags) {
    FlatLight light = flat_from(shape, (flags & FlatEmitter::kDisk) != 0);
    light.emitter = static_cast<std::uint32_t>(emitters.size());
    FlatEmitter emitter;
    emitter.radiance = positive(shape.radiance);
    emitter.flags = flags;
    emitters.push_back(emitter);
    flats.push_back(light);
    powers.push_back(luminance(emitter.radiance) * light.area * kPi);
  };
  for (const RectangleLight* light : lights_of<RectangleLight>(scene.lights)) add_flat(*light, 0);
  meshes = MeshLights(scene, textures, context, flats, emitters, powers);
  disk_begin = next_index();
  for (const DiskLight* light : lights_of<DiskLight>(scene.lights)) add_flat(*light, FlatEmitter::kDisk);

  // A scene without extent still gives directional lights a chance to be chosen.
  const float radius = bounds.half_diagonal();
  const double scene_disk_area = std::numbers::pi * (radius > 0 && std::isfinite(radius) ? static_cast<double>(radius) * radius : 1.0);
  const auto add_punctual = [&](const auto& found) {
    for (const auto* light : found) {
      punctuals.push_back(punctual_from(*light));
      powers.push_back(power_of(punctuals.back(), scene_disk_area));
    }
  };
  punctual_begin = next_index();
  add_punctual(lights_of<PointLight>(scene.lights));
  directional_begin = next_index();
  add_punctual(lights_of<DirectionalLight>(scene.lights));
  spot_begin = next_index();
  add_punctual(lights_of<SpotLight>(scene.lights));

  sphere_begin = next_index();
  for (const SphereLight* light : lights_of<SphereLight>(scene.lights)) {
    SphereEmitter sphere;
    sphere.center = light->center;
    sphere.radius = light->radius;
    sphere.radiance = positive(light->radiance);
    spheres.push_back(sphere);
    powers.push_back(power_of(sphere));
  }
  light_of_sphere.assign(scene.spheres.size(), kNoLight);
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const Sphere& shape = scene.spheres[i];
    const Color radiance = usable_emission(scene, shape.material);
    if (is_black(radiance) || !is_finite(shape.center) || !(shape.radius > 0) || !std::isfinite(shape.radius)) continue;
    const Material& material = scene.materials[shape.material.index];
    SphereEmitter sphere;
    sphere.center = shape.center;
    sphere.radius = shape.radius;
    sphere.radiance = radiance;
    sphere.emits_outside = material.emission_two_sided || !shape.reverse_orientation;
    sphere.emits_inside = material.emission_two_sided || shape.reverse_orientation;
    sphere.is_mesh = true;
    sphere.texture = material.emission.texture;
    sphere.source = static_cast<std::uint32_t>(i);
    light_of_sphere[i] = next_index();
    spheres.push_back(sphere);
    const float mean = sphere.texture.valid() ? std::max(0.f, luminance(Color(textures.mean(sphere.texture)))) : 1.f;
    powers.push_back(power_of(sphere) * mean);
  }
  if (!spheres.empty()) scene_spheres = scene.spheres;

  if (scene.environment) {
    environment.emplace(*scene.environment, context, previous);
    environment_index = next_index();
    powers.push_back(static_cast<float>(environment->total_luminance() * scene_disk_area));
  }
}

}  // namespace sightline
