#include "support/studio.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <type_traits>

#include "film/view.h"
#include "methods/reference/settings.h"
#include "scene/builtin/builtin.h"
#include "visibility/visibility.h"

namespace sightline::test {

Scene builtin_scene(std::string_view spec) { return build_builtin(spec, {}, Context()); }

Shot shot_of(Scene scene, IVec2 size_px, WorldOptions::Backend backend) {
  const Camera camera = scene.cameras.at(0);
  WorldOptions options;
  options.backend = backend;
  return {World::build(std::move(scene), options, Context()), camera, size_px};
}

Frame empty_frame(const Shot& shot, const Exposure& exposure, std::uint32_t first_sample) {
  return Frame(shot.size_px.x, shot.size_px.y, exposure.aovs, first_sample);
}

void expose_range(const Shot& shot, const Exposure& exposure, SampleRange range, Picture& picture, const Context& context) {
  const Method& method = find_method(exposure.method);
  const View view(shot.camera, shot.size_px, PixelFilter(exposure.filter));
  RenderJob job;
  job.world = shot.world;
  job.view = &view;
  job.settings = method.default_settings();
  // The command line does not offer this: it makes noise, and proves that the other techniques are right.
  if (exposure.bsdf_only) {
    ReferenceSettings settings;
    settings.light_samples = 0;
    settings.mode = ReferenceSettings::Mode::path;
    job.settings = SettingsValue::of(settings);
  }
  for (const std::string& setting : exposure.settings) job.settings.apply(setting);
  job.max_bounces = exposure.max_bounces;
  job.light_samples = exposure.light_samples;
  job.total_spp = static_cast<std::uint32_t>(exposure.spp);
  const VisibilityInfo& info = find_visibility(method.default_visibility());
  const std::unique_ptr<Visibility> visibility = info.make(shot.world, info.settings, context);
  job.visibility = visibility.get();
  const std::unique_ptr<const Bake> bake = method.prepare(job, context);
  job.bake = bake.get();
  method.render_pass(job, range, picture.frame, picture.statistics, context);
}

Picture expose(const Shot& shot, const Exposure& exposure) {
  Context context;
  context.seed = exposure.seed;
  context.threads = exposure.threads;
  Picture picture{empty_frame(shot, exposure), {}};
  expose_range(shot, exposure, {0, static_cast<std::uint32_t>(exposure.spp)}, picture, context);
  return picture;
}

bool same_sums(const Frame& a, const Frame& b) {
  if (a.aovs().bits() != b.aovs().bits() || !std::ranges::equal(a.samples_per_tile(), b.samples_per_tile())) return false;
  for (std::size_t k = 0; k < kAovCount; ++k) {
    const Aov aov = static_cast<Aov>(k);
    if (a.aovs().has(aov) && !std::ranges::equal(a.sums(aov), b.sums(aov))) return false;
    if (!std::ranges::equal(a.light_image_sums(aov), b.light_image_sums(aov))) return false;
  }
  return true;
}

void centre_ray(const Shot& shot, std::uint32_t pixel, Vec3& origin, Vec3& direction) {
  const View view(shot.camera, shot.size_px, PixelFilter(PixelFilter::Kind::centre));
  const auto width = static_cast<std::uint32_t>(shot.size_px.x);
  view.ray_through(static_cast<float>(pixel % width) + 0.5f, static_cast<float>(pixel / width) + 0.5f, Vec2(0.5f), origin, direction);
}

namespace {

/// Applies a similarity: x -> factor x + by.
Scene placed(Scene scene, float factor, const Vec3& by) {
  const Mat4 similarity = glm::scale(glm::translate(Mat4(1), by), Vec3(factor));
  const auto point = [&](Vec3& p) { p = factor * p + by; };
  for (Instance& instance : scene.instances) instance.world_from_object = similarity * instance.world_from_object;
  for (Sphere& sphere : scene.spheres) {
    point(sphere.center);
    sphere.radius *= factor;
    sphere.world_from_object = similarity * sphere.world_from_object;
  }
  for (Light& light : scene.lights) {
    std::visit(
        [&]<class Shape>(Shape& shape) {
          if constexpr (std::is_same_v<Shape, PointLight> || std::is_same_v<Shape, SpotLight>) {
            point(shape.position);
            shape.intensity *= factor * factor;
          } else if constexpr (std::is_same_v<Shape, RectangleLight> || std::is_same_v<Shape, DiskLight>) {
            point(shape.center);
            shape.half_u *= factor, shape.half_v *= factor;
          } else if constexpr (std::is_same_v<Shape, SphereLight>) {
            point(shape.center);
            shape.radius *= factor;
          }
        },
        light.shape);
  }
  for (Camera& camera : scene.cameras) {
    camera.world_from_camera[3] = Vec4(factor * Vec3(camera.world_from_camera[3]) + by, 1);
    camera.ortho_height *= factor, camera.lens_radius *= factor, camera.focal_distance *= factor;
  }
  for (Medium& medium : scene.media) medium.sigma_a /= factor;
  return scene;
}

}  // namespace

Scene scaled(Scene scene, float factor) { return placed(std::move(scene), factor, Vec3(0)); }
Scene moved(Scene scene, const Vec3& by) { return placed(std::move(scene), 1, by); }

}  // namespace sightline::test
