// LightSource and AreaLightSource.
#include <cmath>

#include "scene/load/pbrt/builder.h"
#include "scene/load/pbrt/transform.h"

namespace sightline::pbrt {
namespace {

Vec3 point_in_world(const Mat4d& m, const Vec3& p) { return Vec3(Vec3d(m * glm::dvec4(Vec3d(p), 1))); }
Vec3 direction_in_world(const Mat4d& m, const Vec3& v) { return normalize_or(Vec3(Mat3d(m) * Vec3d(v)), Vec3(0)); }

}  // namespace

void Builder::light(const std::string& type, const ParameterList& parameters, const GraphicsState& state, const Place& place) {
  const Mat4d& world_from_light = state.world_from_object;
  float scale = parameters.number("scale", 1);
  Color tint(1);
  if (parameters.find("scale", "rgb") != nullptr) {  // pbrt-v3
    tint = surface_color(parameters, "scale", Color(1), state.color_space);
  }
  if (!std::isfinite(scale) || scale < 0) throw error_at(place, "a light's scale is negative");
  const Color factor = tint * (scale * imaging_ratio_);
  const auto positive = [&](std::string_view name) -> std::optional<float> {
    const float value = parameters.number(name, -1);
    return value > 0 && std::isfinite(value) ? std::optional<float>(value) : std::nullopt;
  };

  Light light;
  light.name = type;
  if (type == "point") {
    PointLight shape;
    shape.position = point_in_world(world_from_light, parameters.point("from").value_or(Vec3(0)));
    shape.intensity = factor * light_color(parameters, "I", state);
    if (const auto power = positive("power")) shape.intensity *= *power / (4 * kPi);
    light.shape = shape;
  } else if (type == "spot") {
    SpotLight shape;
    const Vec3 from = parameters.point("from").value_or(Vec3(0)), to = parameters.point("to").value_or(Vec3(0, 0, 1));
    shape.position = point_in_world(world_from_light, from);
    shape.direction = direction_in_world(world_from_light, to - from);
    const float cone = glm::radians(std::clamp(parameters.number("coneangle", 30), 0.f, 180.f));
    const float delta =
        glm::radians(parameters.has("conedelta") ? parameters.number("conedelta", 5) : parameters.number("conedeltaangle", 5));
    shape.outer_angle_rad = cone;
    shape.inner_angle_rad = std::clamp(cone - delta, 0.f, cone);
    shape.falloff = SpotLight::Falloff::pbrt;
    shape.intensity = factor * light_color(parameters, "I", state);
    if (const auto power = positive("power")) {
      const float cos_start = std::cos(shape.inner_angle_rad), cos_end = std::cos(shape.outer_angle_rad);
      shape.intensity *= *power / (2 * kPi * ((1 - cos_start) + (cos_start - cos_end) / 2));
    }
    if (shape.direction == Vec3(0)) throw error_at(place, "a spot light has no direction");
    light.shape = shape;
  } else if (type == "distant") {
    DirectionalLight shape;
    const Vec3 from = parameters.point("from").value_or(Vec3(0)), to = parameters.point("to").value_or(Vec3(0, 0, 1));
    shape.direction = direction_in_world(world_from_light, to - from);
    shape.irradiance = factor * light_color(parameters, "L", state);
    if (const auto illuminance = positive("illuminance")) shape.irradiance *= *illuminance;
    if (shape.direction == Vec3(0)) throw error_at(place, "a distant light has no direction");
    light.shape = shape;
  } else if (type == "infinite") {
    std::string file = parameters.text("filename", "");
    if (file.empty()) file = parameters.text("mapname", "");  // pbrt-v3
    EnvironmentEntry entry;
    entry.scale = factor * light_color(parameters, "L", state);
    entry.world_from_object = world_from_light;
    entry.place = place;
    entry.illuminance = positive("illuminance").value_or(-1);
    if (!file.empty()) entry.image = add_image(file, place);
    if (parameters.find("portal", "point3") != nullptr)
      warn(place, "the portal of an infinite light is ignored: it shines through walls' openings only by sampling");
    parameters.ignore({"samples", "nsamples"});
    report_unused(parameters, "the infinite light");
    if (!environment_) {
      environment_ = entry;
    } else if (!environment_->image && !entry.image && environment_->illuminance < 0 && entry.illuminance < 0) {
      environment_->scale += entry.scale;  // two constant ones add up
    } else {
      warn(place, "a second infinite light is ignored");
    }
    return;
  } else {
    warn(place, fmt::format("light type '{}' is not supported; the light is left out", shown(type)));
    return;
  }
  parameters.ignore({"samples", "nsamples"});
  report_unused(parameters, fmt::format("light type '{}'", type));
  if (in_object()) warn(place, "a light inside an object definition is placed once, not with each instance");
  scene_.lights.push_back(std::move(light));
}

Slot Builder::area_light(const std::string& type, const ParameterList& parameters, const GraphicsState& state, const Place& place) {
  if (type != "diffuse" && type != "area") {
    warn(place, fmt::format("area light type '{}' is read as 'diffuse'", shown(type)));
  }
  AreaLight light;
  light.place = place;
  const float scale = parameters.number("scale", 1);
  if (!std::isfinite(scale) || scale < 0) throw error_at(place, "a light's scale is negative");
  light.radiance = scale * imaging_ratio_ * light_color(parameters, "L", state);
  light.power = parameters.number("power", -1);
  light.two_sided = parameters.boolean("twosided", false);
  if (const std::string file = parameters.text("filename", ""); !file.empty()) {
    ImageTexture node;
    node.image = ImageId(static_cast<std::size_t>(add_image(file, place)));
    node.filter = TextureFilter::linear;
    light.image = add_texture({"area light", node}, {});
    if (light.power > 0) warn(place, "the power of an area light with an image is taken as if the image were white");
  }
  parameters.ignore({"samples", "nsamples"});
  report_unused(parameters, "the area light");
  area_lights_.push_back(light);
  return static_cast<Slot>(area_lights_.size()) - 1;
}

}  // namespace sightline::pbrt
