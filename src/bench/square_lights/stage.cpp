#include "bench/square_lights/stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "base/core/error.h"
#include "bench/bench_views.h"
#include "methods/method.h"
#include "session/material_option.h"
#include "session/setup.h"
#include "shade/lights/cube_resample.h"

namespace sightline {
namespace {

constexpr const char* kMethod = "square-lights";
constexpr const char* kForest = "environments/phalzer_forest_01_1k.hdr";
constexpr const char* kGround = "ground";
constexpr int kCube = 32, kQuickCube = 8, kTruthSamples = 4096, kQuickTruthSamples = 64;
// Vertices along an edge of the ground where all is quick.
constexpr std::uint32_t kQuickGround = 25;

/// A blue sky over green land with a sun a few degrees wide, for runs without data.
Environment plain_sky() {
  constexpr int kSkyWidth = 128, kSkyHeight = 64;
  const Vec3 sun = glm::normalize(Vec3(0.5f, 0.7f, 0.5f));
  Image image{kSkyWidth, kSkyHeight, 3, Image::Floats()};
  auto& values = std::get<Image::Floats>(image.data);
  for (int y = 0; y < kSkyHeight; ++y) {
    for (int x = 0; x < kSkyWidth; ++x) {
      const float theta = kPi * (static_cast<float>(y) + 0.5f) / kSkyHeight, phi = 2 * kPi * (static_cast<float>(x) + 0.5f) / kSkyWidth;
      const Vec3 d(-std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      Color color = d.y > 0 ? glm::mix(Color(0.9f, 0.95f, 1.f), Color(0.25f, 0.5f, 1.f), d.y) : Color(0.15f, 0.2f, 0.1f);
      if (glm::dot(d, sun) > std::cos(0.1f)) color = Color(60, 55, 45);
      for (int c = 0; c < 3; ++c) values.push_back(color[c]);
    }
  }
  Environment environment;
  environment.image = std::make_shared<const Image>(std::move(image));
  environment.name = "sky";
  return environment;
}

/// The ground with fewer vertices: a flat grid of the same size.
void thin_out(Mesh& ground) {
  const Vec3 lower = ground.bounds.lower, edge = ground.bounds.upper - lower;
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  for (std::uint32_t i = 0; i < kQuickGround * kQuickGround; ++i) {
    const std::uint32_t row = i / kQuickGround;
    const float u = static_cast<float>(i % kQuickGround) / (kQuickGround - 1), v = static_cast<float>(row) / (kQuickGround - 1);
    positions.push_back(lower + Vec3(u, 0.5f, v) * edge);
    if (i % kQuickGround + 1 == kQuickGround || row + 1 == kQuickGround) continue;
    triangles.emplace_back(i, i + kQuickGround, i + 1);
    triangles.emplace_back(i + 1, i + kQuickGround, i + kQuickGround + 1);
  }
  ground.positions = SharedArray<Vec3>(positions);
  ground.triangles = SharedArray<UVec3>(triangles);
  if (!ground.normals.empty()) ground.normals = SharedArray<Vec3>(std::vector<Vec3>(positions.size(), Vec3(0, 1, 0)));
  ground.uvs = {}, ground.tangents = {}, ground.triangle_materials = {};
}

}  // namespace

bool square_lights_know(const Scene& scene, const std::string& name, const Context& context) {
  try {
    check_supported(find_method(kMethod), scene);
    return true;
  } catch (const Error& error) {
    context.warn(fmt::format("{}: left out: {}", name, error.what()));
    return false;
  }
}

std::optional<SquareStage> load_stage(const std::string& name, const SquareBenchOptions& options, const Context& context) {
  std::optional<BenchView> view = load_bench_view(name, options.data, context);
  if (!view) {
    context.warn(fmt::format("{}: its files are not below the data folder (--data or SIGHTLINE_DATA); left out", name));
    return std::nullopt;
  }
  Scene& scene = view->scene;
  if (!scene.environment || !scene.environment->image) {
    const std::optional<std::filesystem::path> forest = data_file(options, kForest);
    scene.environment = forest ? load_environment(forest->string(), "latlong", 1, 0) : plain_sky();
  }
  for (Mesh& mesh : scene.meshes) {
    if (options.quick && mesh.name == kGround && !mesh.source) thin_out(mesh);
  }
  if (!square_lights_know(scene, name, context)) return std::nullopt;
  const IVec2 size = options.size_px.value_or(options.quick ? view->size_px / 8 : view->size_px);
  return SquareStage{name, std::move(scene), view->camera, size};
}

std::optional<std::filesystem::path> data_file(const SquareBenchOptions& options, const std::string& name) {
  const std::string folders = options.data.string();
  for (std::size_t begin = 0; begin <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    std::filesystem::path file = std::filesystem::path(folders.substr(begin, end - begin)) / name;
    std::error_code ignored;
    if (end > begin && std::filesystem::exists(file, ignored)) return file;
    begin = end + 1;
  }
  return std::nullopt;
}

BuiltView build_stage(const SquareStage& stage, float time_s, const Context& context) {
  return {stage.name, World::build(pose(stage.scene, time_s), {}, context), stage.camera, stage.size_px};
}

void edit_stage(BuiltView& view, const SquareStage& stage, float time_s, const Context& context) {
  view.world = World::edit(*view.world, pose(stage.scene, time_s), context);
}

void remove_ground(Scene& scene) {
  std::erase_if(scene.instances, [&](const Instance& instance) { return scene.meshes[instance.mesh.index].name == kGround; });
}

std::uint64_t vertex_count(const Scene& scene) {
  std::uint64_t count = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh.index];
    count += mesh.source ? mesh.source->vertex_count() : mesh.positions.size();
  }
  return count;
}

int moving_part_count(const Scene& scene) {
  std::set<NodeId> parts;
  for (const Instance& instance : scene.instances) {
    NodeId node = instance.node;
    while (node.valid() && !scene.nodes[node.index].is_animated()) node = scene.nodes[node.index].parent;
    if (node.valid()) parts.insert(node);
  }
  return static_cast<int>(parts.size());
}

void set_content_material(Scene& scene, const SurfaceModel& model) { apply_material(scene, {"", model}); }

SurfaceModel glossy_material() { return PhongMaterial{Color(0.35f, 0.33f, 0.3f), Color(0.35f), 50.f}; }

void turn_light(Scene& scene, const Mat3& rotation) {
  if (scene.environment) scene.environment->world_from_environment = rotation * scene.environment->world_from_environment;
}

RenderRequest square_request(const SquareBenchOptions& options, const std::shared_ptr<BakeStore>& bakes,
                             const std::vector<std::string>& settings) {
  RenderRequest request;
  request.method = kMethod;
  if (options.quick) request.settings = {fmt::format("cube={}", kQuickCube), "rays=32", "occluder_rays=32"};
  request.settings.insert(request.settings.end(), settings.begin(), settings.end());
  request.spp = 1, request.max_bounces = 0;
  request.bakes = bakes;
  return request;
}

RenderRequest light_request(int samples) {
  RenderRequest request;
  request.method = "reference";
  request.spp = 1, request.light_samples = samples, request.max_bounces = 0;
  return request;
}

int truth_samples(const SquareBenchOptions& options) {
  return options.truth_samples > 0 ? options.truth_samples : options.quick ? kQuickTruthSamples : kTruthSamples;
}

int cube_size(const SquareBenchOptions& options) { return options.quick ? kQuickCube : kCube; }

void light_by_cube(Scene& scene, const SquareBenchOptions& options, const Context& context) {
  if (scene.environment) scene.environment = environment_as_cube(*scene.environment, cube_size(options), context);
}

}  // namespace sightline
