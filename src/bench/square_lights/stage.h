// A view whose scene the parts of the square-lights benchmark change: lit, posed, turned, given other materials.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/bench_shot.h"
#include "bench/square_lights/square_bench.h"
#include "scene/material.h"
#include "scene/scene.h"

namespace sightline {

struct SquareStage {
  std::string name;
  Scene scene;  ///< as it was loaded: not posed
  Camera camera;
  IVec2 size_px{0};
};

/// A standard view or builtin scene with an environment: its own, else the forest of the data folder, else a sky made here. `quick`
/// thins the ground out. Nothing, with a warning, where the view's files are missing or the method does not know what is in it.
std::optional<SquareStage> load_stage(const std::string& name, const SquareBenchOptions& options, const Context& context);

/// False, with a warning, where the method does not know a light or a material of the scene.
bool square_lights_know(const Scene& scene, const std::string& name, const Context& context);
/// A file of the data folder, or of the first of several folders that has it.
std::optional<std::filesystem::path> data_file(const SquareBenchOptions& options, const std::string& name);

/// The stage at a time of its animation, built anew or, given what was built before, edited.
BuiltView build_stage(const SquareStage& stage, float time_s, const Context& context);
void edit_stage(BuiltView& view, const SquareStage& stage, float time_s, const Context& context);

/// Leaves out the ground of builtin:ground: what tables are made of is then the content alone.
void remove_ground(Scene& scene);
/// Of all meshes, as often as they stand in the scene.
std::uint64_t vertex_count(const Scene& scene);
/// Animated nodes that something hangs on: pieces that move.
int moving_part_count(const Scene& scene);
/// Gives the content, not the ground, a material.
void set_content_material(Scene& scene, const SurfaceModel& model);
/// The material of the error measurements: Phong's lobe with exponent 50 over Lambert, as the paper's figures have it.
SurfaceModel glossy_material();
/// The environment turned by `rotation` as well.
void turn_light(Scene& scene, const Mat3& rotation);

/// A picture by the method under test, a sample a pixel through its centre; `settings` over those of all pictures of this run.
RenderRequest square_request(const SquareBenchOptions& options, const std::shared_ptr<BakeStore>& bakes,
                             const std::vector<std::string>& settings);
/// The reference of the same: primary hits and light samples, no bounces.
RenderRequest light_request(int samples);
int truth_samples(const SquareBenchOptions& options);
/// The environment as the cube map that the method makes of it, for the reference to render the very same light.
void light_by_cube(Scene& scene, const SquareBenchOptions& options, const Context& context);
/// Texels along an edge of that.
int cube_size(const SquareBenchOptions& options);

}  // namespace sightline
