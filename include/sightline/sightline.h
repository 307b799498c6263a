// Rendering from a program: load a scene, choose a method, get pixels and statistics.
//
//   sightline::Renderer renderer;
//   renderer.load("scene.gltf");
//   const sightline::Picture picture = renderer.render({.width = 640, .height = 480, .spp = 64});
//
// Failures are sightline::Error (error.h). Nothing is printed; give the Renderer a log to hear of warnings.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sightline/error.h"
#include "sightline/version.h"

namespace sightline {

struct Float3 {
  float x = 0, y = 0, z = 0;
};

/// A camera at `eye` that looks at `target`. The field of view is vertical.
struct LookAt {
  Float3 eye{0, 0, 1}, target{0, 0, 0}, up{0, 1, 0};
  float fov_deg = 40;
};

/// What to render with. Zero and empty mean: what the scene says, else the method's own.
struct RenderOptions {
  std::string method = "reference";
  std::string visibility;
  std::vector<std::pair<std::string, std::string>> settings;  ///< of the method or the visibility, as `sightline methods NAME` lists them
  int width = 0, height = 0;                                  ///< pixels; both or none
  std::string camera;                                         ///< name or number of one of the scene's cameras
  std::optional<LookAt> look_at;                              ///< instead of a camera of the scene
  int spp = 0;
  int light_samples = 0;
  int max_bounces = -1;  ///< indirect bounces; 0 is direct light only, negative the scene's own
  std::uint64_t seed = 0;
  double time_limit_s = 0;  ///< 0: none
  float time_s = 0;         ///< of the scene's animation
};

/// Linear Rec.709 radiance, interleaved RGB, row 0 at the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> rgb;
  std::string statistics_json;  ///< the keys of docs/cli.md
  bool complete = true;         ///< false where a time limit or cancel() ended it early

  Float3 pixel(int x, int y) const {
    const std::size_t i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
};

struct RendererOptions {
  int threads = 0;                              ///< 0: all that this process may use
  std::uint64_t memory_budget_bytes = 0;        ///< 0: no limit
  std::string data_directory;                   ///< where built-in scenes look for their content=
  bool default_light = true;                    ///< light a scene that has no light with a white environment
  std::function<void(const std::string&)> log;  ///< receives warnings; may be called from any thread
};

/// One scene at a time, and pictures of it. Not for several threads at once, but for cancel().
class Renderer {
 public:
  explicit Renderer(RendererOptions options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Reads a scene file (.gltf .glb .pbrt .obj .ply) or a built-in scene ("builtin:cornell"), in place of the one before.
  void load(const std::string& scene);
  /// Adds a light: the texts that --light-area, --light-point, --light-directional take (docs/cli.md), or an environment image.
  void add_area_light(const std::string& text);
  void add_point_light(const std::string& text);
  void add_directional_light(const std::string& text);
  void set_environment(const std::string& file, float scale = 1);

  /// The same options and seed give the same pixels, on any number of threads.
  Picture render(const RenderOptions& options = {});
  /// Ends the render() that runs, from any thread or signal handler; its picture holds what was done. Does nothing otherwise.
  void cancel() noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Names that RenderOptions::method and ::visibility take.
std::vector<std::string> method_names();
std::vector<std::string> visibility_names();

}  // namespace sightline
