#include "scene/load/gltf/cameras_lights.h"

#include "base/core/error.h"

namespace sightline::gltf {
namespace {

float positive(const JsonView& number) {
  const auto value = static_cast<float>(number.as_number());
  if (!(value > 0)) throw input_error(fmt::format("{} is not larger than 0", value)).at(number.path());
  return value;
}

SpotLight read_spot(const JsonView& light, const Color& intensity) {
  SpotLight spot;
  spot.intensity = intensity;
  if (const std::optional<JsonView> cone = light.find("spot")) {
    spot.inner_angle_rad = cone->number_or("innerConeAngle", 0);
    spot.outer_angle_rad = cone->number_or("outerConeAngle", kPi / 4);
    if (!(spot.outer_angle_rad > 0 && spot.outer_angle_rad <= kPi / 2 + 1e-4f && spot.inner_angle_rad >= 0 &&
          spot.inner_angle_rad <= spot.outer_angle_rad)) {
      throw input_error(
          fmt::format("cone angles {} and {} are not within 0 <= inner < outer <= pi/2", spot.inner_angle_rad, spot.outer_angle_rad))
          .at(cone->path());
    }
  }
  return spot;
}

}  // namespace

void add_camera(Import& import, const JsonView& reference, NodeId node) {
  const JsonView json = import.document.element("cameras", import.document.resolve("cameras", reference));
  Camera camera;
  camera.name = json.find("name") ? json.name() : import.scene.nodes[node.index].name;
  camera.node = node;
  const JsonView type = json.require("type");
  if (type.as_string() == "perspective") {
    const JsonView fov = json.require("perspective").require("yfov");
    camera.fov_rad = positive(fov);
    if (!(camera.fov_rad < kPi)) throw input_error(fmt::format("a field of view of {} is not below pi", camera.fov_rad)).at(fov.path());
  } else if (type.as_string() == "orthographic") {
    camera.projection = Camera::Projection::orthographic;
    const JsonView magnification = json.require("orthographic").require("ymag");
    camera.ortho_height = 2 * std::fabs(static_cast<float>(magnification.as_number()));
    if (!(camera.ortho_height > 0)) throw input_error("a magnification of 0 shows nothing").at(magnification.path());
  } else {
    throw input_error(fmt::format("'{}' is no camera type", type.as_string())).at(type.path());
  }
  import.scene.cameras.push_back(camera);
}

void add_light(Import& import, const JsonView& node_extension, NodeId node) {
  const std::optional<JsonView> extension = import.document.root().extension("KHR_lights_punctual");
  const JsonView reference = node_extension.require("light");
  if (!extension) throw input_error("the file declares no lights").at(reference.path());
  const JsonView lights = extension->require("lights");
  const std::uint64_t index = reference.as_unsigned();
  if (index >= lights.size()) throw input_error(fmt::format("there is no light {}, only {}", index, lights.size())).at(reference.path());
  const JsonView json = lights.at(static_cast<std::size_t>(index));

  Color color{1};
  json.vector_or("color", {&color.x, 3});
  const float intensity = json.number_or("intensity", 1);
  if (color.x < 0 || color.y < 0 || color.z < 0 || intensity < 0) throw input_error("a light may not be negative").at(json.path());
  color *= intensity;

  // Candela and lux are taken 1:1 as W/sr and W/m²; lights shine along -Z of their node.
  Light light;
  light.name = json.find("name") ? json.name() : import.scene.nodes[node.index].name;
  light.node = node;
  const JsonView type = json.require("type");
  if (type.as_string() == "point") {
    light.shape = PointLight{.intensity = color};
  } else if (type.as_string() == "spot") {
    light.shape = read_spot(json, color);
  } else if (type.as_string() == "directional") {
    light.shape = DirectionalLight{.direction = {0, 0, -1}, .irradiance = color};
  } else {
    throw input_error(fmt::format("'{}' is no light type", type.as_string())).at(type.path());
  }
  import.scene.lights.push_back(light);
}

}  // namespace sightline::gltf
