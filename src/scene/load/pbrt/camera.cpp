// Film, camera, integrator and sampler: what ends in the camera and the render hints.
#include <cmath>

#include "scene/load/pbrt/builder.h"
#include "scene/load/pbrt/transform.h"

namespace sightline::pbrt {

void Builder::film(const std::string& type, const ParameterList& parameters, const Place& place) {
  if (type != "rgb" && type != "gbuffer" && type != "spectral" && type != "image") {
    warn(place, fmt::format("film type '{}' is read as 'rgb'", shown(type)));
  }
  const IVec2 size(parameters.integer("xresolution", 1280), parameters.integer("yresolution", 720));
  constexpr int kLargestSide = 1 << 17;
  if (size.x < 1 || size.y < 1 || size.x > kLargestSide || size.y > kLargestSide) {
    throw error_at(place, fmt::format("a film of {} x {} pixels is not possible", size.x, size.y));
  }
  scene_.hints.size_px = size;
  scene_.hints.output = parameters.text("filename", "");

  // pbrt's sensor multiplies what it gets by exposure time × ISO / 100; light is linear, so all lights are scaled instead.
  imaging_ratio_ = parameters.number("exposuretime", 1) * parameters.number("iso", 100) / 100;
  if (!(imaging_ratio_ > 0) || !std::isfinite(imaging_ratio_)) throw error_at(place, "the film's exposure is not positive");
  imaging_ratio_ *= parameters.number("scale", 1);  // pbrt-v3
  if (const std::string sensor = parameters.text("sensor", "cie1931"); sensor != "cie1931") {
    warn(place, fmt::format("sensor '{}' is not supported; cie1931 is used", shown(sensor)));
  }
  if (parameters.number("whitebalance", 0) != 0) warn(place, "white balance is not supported");
  for (const std::string_view name : {"cropwindow", "pixelbounds", "maxcomponentvalue"}) {
    if (parameters.has(name)) warn(place, fmt::format("the film's {} is not supported; the whole picture is kept as it is", name));
  }
  parameters.ignore({"cropwindow", "pixelbounds", "maxcomponentvalue", "diagonal", "savefp16", "coordinatesystem"});
  report_unused(parameters, "the film");
}

void Builder::camera(const std::string& type, const ParameterList& parameters, const Mat4d& camera_from_world, const Place& place) {
  Camera camera;
  camera.name = type;
  // pbrt looks along +z with x to the right and y up, whatever the handedness of the world; Sightline along -z.
  if (determinant(camera_from_world) == 0) throw error_at(place, "the camera's transformation cannot be inverted");
  const Mat4d world_from_camera = glm::inverse(camera_from_world) * scaling({1, 1, -1});
  if (!is_finite_transform(world_from_camera)) throw error_at(place, "the camera's transformation cannot be inverted");
  camera.world_from_camera = Mat4(world_from_camera);
  camera.fov_axis = Camera::FovAxis::shorter;

  if (type == "orthographic") {
    camera.projection = Camera::Projection::orthographic;
    camera.ortho_height = 2;  // the window [-1, 1] of the shorter side
  } else {
    if (type != "perspective") warn(place, fmt::format("camera type '{}' is not supported; perspective is used", shown(type)));
    const float fov = parameters.number("fov", 90);
    if (!(fov > 0) || !(fov < 180)) throw error_at(place, fmt::format("a field of view of {} degrees is not possible", fov));
    camera.fov_rad = glm::radians(fov);
  }
  camera.lens_radius = parameters.number("lensradius", 0);
  camera.focal_distance = parameters.number("focaldistance", 1e6f);
  if (!(camera.lens_radius >= 0) || !(camera.focal_distance > 0)) throw error_at(place, "lens radius or focal distance is negative");
  if (const std::span<const float> window = parameters.numbers("screenwindow", "float"); window.size() == 4) {
    if (!(window[0] < window[1]) || !(window[2] < window[3])) throw error_at(place, "the screen window is empty");
    camera.screen_window = Vec4(window[0], window[2], window[1], window[3]);
  } else if (!window.empty()) {
    throw error_at(place, "a screen window has four numbers");
  } else if (const float aspect = parameters.number("frameaspectratio", 0); aspect > 0) {
    camera.screen_window = aspect > 1 ? Vec4(-aspect, -1, aspect, 1) : Vec4(-1, -1 / aspect, 1, 1 / aspect);
  }
  parameters.ignore({"shutteropen", "shutterclose"});  // nothing moves while it is open
  report_unused(parameters, "the camera");
  if (scene_.cameras.empty())
    scene_.cameras.push_back(std::move(camera));
  else
    warn(place, "a second camera is ignored");
}

void Builder::integrator(const std::string& type, const ParameterList& parameters, const Place& place) {
  constexpr int kDefaultDepth = 5;
  if (type == "path" || type == "volpath" || type == "bdpt" || type == "simplepath" || type == "simplevolpath" || type == "mlt" ||
      type == "sppm" || parameters.has("maxdepth")) {
    const int depth = parameters.integer("maxdepth", kDefaultDepth);
    scene_.hints.max_bounces = std::max(0, depth - 1);
  } else {
    warn(place, fmt::format("integrator '{}' says nothing about the number of bounces", shown(type)));
  }
  if (parameters.boolean("regularize", false)) warn(place, "path regularisation is not supported");
  // How light is sampled is the renderer's own business.
  for (const Parameter& parameter : parameters.all()) parameter.used = true;
}

void Builder::sampler(const std::string& type, const ParameterList& parameters, const Place& place) {
  std::int64_t samples = parameters.integer("pixelsamples", 16);
  if (type == "stratified") {
    samples = std::int64_t{parameters.integer("xsamples", 4)} * parameters.integer("ysamples", 4);
  }
  constexpr std::int64_t kMost = 1 << 24;
  if (samples < 1 || samples > kMost) throw error_at(place, fmt::format("{} samples a pixel are not possible", samples));
  scene_.hints.spp = static_cast<int>(samples);
  parameters.ignore({"seed", "randomization", "jitter"});
  report_unused(parameters, "the sampler");
}

}  // namespace sightline::pbrt
