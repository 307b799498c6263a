// From what a user asks for to a scene with camera and lights, ready to be built.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/core/context.h"
#include "film/view.h"
#include "scene/scene.h"

namespace sightline {

/// Changes to a loaded scene and the choice of a view, as the command line states them.
struct ViewRequest {
  std::optional<std::string> camera;  ///< name or index
  std::optional<Vec3> eye, target, up;
  std::optional<float> fov_deg;  ///< vertical
  std::optional<IVec2> size_px;
  std::string filter = "gaussian";
};

struct LightRequest {
  std::optional<std::string> environment;  ///< file
  float environment_scale = 1, environment_rotate_deg = 0;
  std::string environment_mapping = "latlong";
  float environment_turn_deg = 0;  ///< added to the rotation for each frame of an animation
  int environment_cube = 0;        ///< texels along an edge of the cube map that replaces the environment, 0 = it stays as it is
  std::vector<std::string> area, point, directional;  ///< option texts
  bool default_light = true;                          ///< a white environment where there is no light at all
};

/// Adds the lights asked for. A scene that then has none gets a uniform white environment and one warning, unless switched off.
void apply_lights(Scene& scene, const LightRequest& request, const Context& context);
/// Turns the scene's environment, if it has one, counter-clockwise about +Y seen from above.
void turn_environment(Scene& scene, float degrees);
/// True if anything in the scene emits.
bool has_light(const Scene& scene);
/// The camera asked for: by name, by eye and target, the scene's first, else framing. Throws Error{usage} naming the known cameras.
Camera choose_camera(const Scene& scene, const ViewRequest& request);
/// Size asked for, the scene's, else 1280x720.
IVec2 choose_size(const Scene& scene, const ViewRequest& request);
/// An environment from an image file. rotate_deg turns counter-clockwise about +Y seen from above.
Environment load_environment(const std::string& path, const std::string& mapping, float scale, float rotate_deg);

}  // namespace sightline
