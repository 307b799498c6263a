#include "session/setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "base/core/error.h"
#include "base/settings/settings.h"
#include "image/io/image_io.h"
#include "session/options_text.h"
#include "shade/lights/cube_resample.h"

namespace sightline {
namespace {

EnvironmentMapping mapping_from_name(const std::string& name) {
  if (name == "latlong") return EnvironmentMapping::latlong;
  if (name == "angular") return EnvironmentMapping::angular;
  if (name == "octahedral") return EnvironmentMapping::octahedral;
  if (name == "cube") return EnvironmentMapping::cube;
  throw usage_error(fmt::format("unknown environment mapping '{}'", name)).remedy("known: latlong, angular, octahedral, cube");
}

// Names for a message of one line, not more of them than it can hold.
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t shown = 12;
  const std::string rest = names.size() > shown ? fmt::format(", ... ({} in all; sightline info lists them)", names.size()) : "";
  return fmt::format("known: {}{}",
                     fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(std::min(shown, names.size())), ", "), rest);
}

Camera look_at_camera(const Vec3& eye, const Vec3& target, Vec3 up, float fov_deg) {
  const Vec3 back = eye - target;
  if (!(length_squared(back) > 0)) throw usage_error("--eye and --target are the same point");
  const Vec3 z = glm::normalize(back);
  if (length_squared(glm::cross(up, z)) < 1e-12f * length_squared(up)) up = std::fabs(z.y) < 0.9f ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  const Vec3 x = glm::normalize(glm::cross(up, z));
  Camera camera;
  camera.name = "command line";
  camera.world_from_camera = Mat4(Vec4(x, 0), Vec4(glm::cross(z, x), 0), Vec4(z, 0), Vec4(eye, 1));
  camera.fov_rad = glm::radians(fov_deg);
  return camera;
}

}  // namespace

Environment load_environment(const std::string& path, const std::string& mapping, float scale, float rotate_deg) {
  Environment environment;
  environment.mapping = mapping_from_name(mapping);
  environment.image = std::make_shared<const Image>(read_image(path));
  environment.name = path;
  environment.scale = Color(scale);
  environment.world_from_environment = Mat3(glm::rotate(Mat4(1), glm::radians(rotate_deg), Vec3(0, 1, 0)));
  return environment;
}

void turn_environment(Scene& scene, float degrees) {
  if (!scene.environment || degrees == 0) return;
  Mat3& world_from_environment = scene.environment->world_from_environment;
  world_from_environment = Mat3(glm::rotate(Mat4(1), glm::radians(degrees), Vec3(0, 1, 0))) * world_from_environment;
}

bool has_light(const Scene& scene) {
  if (!scene.lights.empty() || scene.environment) return true;
  for (const Material& material : scene.materials) {
    if (!is_black(material.emission.value)) return true;
  }
  return false;
}

namespace {

void add_default_light(Scene& scene, const LightRequest& request, const Context& context) {
  if (has_light(scene) || !request.default_light) return;
  const std::string warning =
      "the scene has no light: a uniform white environment of radiance 1 is added (--no-default-light leaves it dark)";
  scene.warnings.push_back(warning);
  context.warn(warning);
  scene.environment = Environment{.image = nullptr, .name = "default", .mapping = {}, .scale = Color(1), .world_from_environment = Mat3(1)};
}

}  // namespace

void apply_lights(Scene& scene, const LightRequest& request, const Context& context) {
  if (request.environment) {
    scene.environment =
        load_environment(*request.environment, request.environment_mapping, request.environment_scale, request.environment_rotate_deg);
  } else if (scene.environment) {
    scene.environment->scale *= request.environment_scale;
    turn_environment(scene, request.environment_rotate_deg);
  }
  for (const std::string& text : request.area) scene.lights.push_back(parse_light_area(text));
  for (const std::string& text : request.point) scene.lights.push_back(parse_light_point(text));
  for (const std::string& text : request.directional) scene.lights.push_back(parse_light_directional(text));
  add_default_light(scene, request, context);
  if (request.environment_cube == 0) return;
  if (!scene.environment) throw usage_error("--environment-cube: the scene has no environment").remedy("add one with --environment FILE");
  scene.environment = environment_as_cube(*scene.environment, request.environment_cube, context);
}

Camera choose_camera(const Scene& scene, const ViewRequest& request) {
  Camera camera;
  if (request.eye) {
    const Vec3 target = request.target ? *request.target : (scene.framing ? *scene.framing : scene_bounds(scene)).center();
    return look_at_camera(*request.eye, target, request.up.value_or(Vec3(0, 1, 0)), request.fov_deg.value_or(45));
  }
  if (request.target || request.up) throw usage_error("--target and --up need --eye");
  if (request.camera) {
    std::vector<std::string> known;
    std::size_t index = 0;
    const auto [end, status] = std::from_chars(request.camera->data(), request.camera->data() + request.camera->size(), index);
    const bool is_index = status == std::errc{} && end == request.camera->data() + request.camera->size();
    const Camera* found = nullptr;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
      known.push_back(scene.cameras[i].name.empty() ? fmt::format("{}", i) : scene.cameras[i].name);
      if (scene.cameras[i].name == *request.camera || (is_index && i == index && !found)) found = &scene.cameras[i];
    }
    if (!found) {
      const std::string nearest = nearest_name(*request.camera, known);
      const std::string hint = nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest);
      throw usage_error(fmt::format("no camera '{}' in the scene", *request.camera))
          .remedy(known.empty() ? "it has none; use --eye and --target" : hint + listed(known));
    }
    camera = *found;
  } else if (!scene.cameras.empty()) {
    camera = scene.cameras.front();
  } else {
    camera = framing_camera(scene.framing ? *scene.framing : scene_bounds(scene));
  }
  if (request.fov_deg) {
    camera.fov_rad = glm::radians(*request.fov_deg);
    camera.fov_axis = Camera::FovAxis::vertical;
  }
  return camera;
}

IVec2 choose_size(const Scene& scene, const ViewRequest& request) {
  const IVec2 size = request.size_px.value_or(scene.hints.size_px.value_or(IVec2(1280, 720)));
  // Pixel numbers are 32-bit.
  if (size.x < 1 || size.y < 1 || static_cast<std::int64_t>(size.x) * size.y > std::numeric_limits<std::int32_t>::max())
    throw usage_error(fmt::format("a picture of {}x{} pixels is not possible", size.x, size.y))
        .remedy("use --size with fewer than 2^31 pixels");
  return size;
}

}  // namespace sightline
