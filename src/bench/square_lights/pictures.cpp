// The paper's figures with scenes of ours, each picture beside the reference under the same cube map.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "bench/square_lights/figures.h"
#include "bench/square_lights/parts.h"
#include "bench/square_lights/sphere_maps.h"
#include "bench/thumbnail.h"
#include "methods/square_lights/texel_exchange.h"
#include "session/material_option.h"

namespace sightline {
namespace {

constexpr int kPictureWidth = 400;

/// Makes pictures of one stage and adds them, the reference first.
class Figure {
 public:
  Figure(SquareStage stage, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures, const Context& context)
      : stage_(std::move(stage)), shared_(shared), pictures_(pictures), context_(context) {
    light_by_cube(stage_.scene, shared.options, context);
  }
  SquareStage& stage() { return stage_; }

  /// What was changed in the stage takes effect, and begins a row of pictures.
  void reference(const std::string& title, float time_s) {
    view_.emplace(build_stage(stage_, time_s, context_));
    truth_ = shoot(*view_, light_request(truth_samples(shared_.options)), context_);
    mask_ = surface_mask(*view_, light_request(1), context_);
    title_ = title;
    exposure_ = viewing_exposure(truth_.image);
    add("reference", fmt::format("{} light samples, {:.2f} s", truth_samples(shared_.options), truth_.seconds), truth_.image);
  }
  void ours(const std::string& name, const std::vector<std::string>& settings) {
    const Shot shot = shoot(*view_, square_request(shared_.options, shared_.bakes, settings), context_);
    const nlohmann::ordered_json errors = square_differences(truth_.image, shot.image, mask_);
    add(name,
        fmt::format("{:.3f} s, l2 {:.3f} %, FLIP {:.4f}", shot.seconds, 100 * errors["l2"].get<double>(), errors["flip"].get<double>()),
        shot.image);
  }
  void add(const std::string& name, const std::string& caption, const ColorImage& image) {
    pictures_.push_back({fmt::format("{}: {}", title_, name), caption, thumbnail(image, kPictureWidth), exposure_});
  }

 private:
  SquareStage stage_;
  const SquareBenchShared& shared_;
  std::vector<BenchPicture>& pictures_;
  const Context& context_;
  std::optional<BuiltView> view_;
  Shot truth_;
  std::vector<std::uint8_t> mask_;
  std::string title_;
  float exposure_ = 0;
};

/// Figure 6: the environment, its regions, its squares, as the method's defaults have them.
void light_figure(const SquareStage& stage, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures, const Context& context) {
  const BuiltView view = build_stage(stage, 0, context);
  const square_lights::LightCube cube = bench_light_cube(*view.world, cube_size(shared.options), context);
  const square_lights::MergeTree tree =
      square_lights::MergeTree::build(cube, {square_lights::MergeOptions::Criterion::ward, true}, context);
  const ColorImage light = cube_picture(cube);
  const float exposure = viewing_exposure(light);
  pictures.push_back({fmt::format("Figure 6, {}: the cube map", stage.name), fmt::format("{} texels", cube.count()), light, exposure});
  for (const std::size_t count : {std::size_t{30}, std::size_t{100}}) {
    const square_lights::TexelExchange exchange = square_lights::exchange_texels(cube, tree, count);
    pictures.push_back({fmt::format("Figure 6, {}: {} regions", stage.name, count), "", region_picture(cube, exchange.region), 0.f});
    pictures.push_back({fmt::format("Figure 6, {}: {} squares", stage.name, count), "", square_picture(exchange.lights), exposure});
  }
}

/// Figures 9 and 10: numbers of lights, and wavelets.
void count_figure(const SquareStage& stage, const char* title, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures,
                  const Context& context) {
  Figure figure(stage, shared, pictures, context);
  set_content_material(figure.stage().scene, glossy_material());
  figure.reference(fmt::format("{}, {}", title, stage.name), 0);
  figure.ours("every texel, traced, at vertices", {"lights=all"});
  figure.ours("every texel, by tables", {"lights=all-tables"});
  for (const int count : {10, 30, 100}) figure.ours(fmt::format("{} squares", count), {fmt::format("lights={}", count)});
  figure.ours("30 squares, light by pixel", {"shading=pixel"});
  for (const int count : {30, 100}) figure.ours(fmt::format("{} wavelets", count), {"basis=haar", fmt::format("lights={}", count)});
}

/// Figures 13 and 14: what moves, at three times.
void motion_figure(const SquareStage& stage, const char* title, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures,
                   const Context& context) {
  Figure figure(stage, shared, pictures, context);
  for (const float part : {0.f, 0.3f, 0.65f}) {
    const float time_s = part * stage.scene.animation_duration_s;
    figure.reference(fmt::format("{}, {} at {:.2f} s", title, stage.name, time_s), time_s);
    figure.ours("30 squares", {});
    figure.ours("30 squares, least distance", {"combine=distance"});
  }
}

/// Figure 15: reflectances.
void material_figure(const SquareStage& stage, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures,
                     const Context& context) {
  struct Named {
    const char *name, *text, *file;
  };
  constexpr std::array<Named, 7> kMaterials = {
      {{"Phong", "phong,diffuse=0.1,specular=0.6,exponent=60", nullptr},
       {"Cook-Torrance", "cook-torrance,diffuse=0.12:0.07:0.03,specular=1,roughness=0.25,f0=0.7:0.45:0.25", nullptr},
       {"Ward", "ward,diffuse=0.05,specular=0.5,alpha_x=0.15,alpha_y=0.15", nullptr},
       {"Ward, anisotropic", "ward,diffuse=0.05,specular=0.5,alpha_x=0.06,alpha_y=0.35", nullptr},
       {"measured: blue acrylic", "measured,file=", "brdf/acryl_blue.brdf"},
       {"measured: garnet red", "measured,file=", "brdf/garnet_red.brdf"},
       {"measured: mystique", "measured,file=", "brdf/mystique.brdf"}}};
  Figure figure(stage, shared, pictures, context);
  for (const Named& material : kMaterials) {
    std::string text = material.text;
    if (material.file) {
      const std::optional<std::filesystem::path> file = data_file(shared.options, material.file);
      if (!file) continue;
      text += file->string();
    }
    apply_material(figure.stage().scene, parse_material(text, {}));
    figure.reference(fmt::format("Figure 15, {}, {}", material.name, stage.name), 0);
    figure.ours("30 squares", {});
    figure.ours("100 squares, light by pixel", {"lights=100", "shading=pixel"});
  }
}

/// Figure 16, left: a local light above the content, in a dim environment.
void local_light_figure(const SquareStage& stage, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures,
                        const Context& context) {
  SquareStage lit = stage;
  const Bounds bounds = lit.scene.framing ? *lit.scene.framing : scene_bounds(lit.scene);
  const float radius = bounds.half_diagonal();
  // Facing down: cross(half_u, half_v) = -Y.
  RectangleLight lamp;
  lamp.center = bounds.center() + radius * Vec3(0.6f, 1.6f, 0.4f);
  lamp.half_u = Vec3(0.4f * radius, 0, 0), lamp.half_v = Vec3(0, 0, 0.4f * radius);
  lamp.radiance = Color(40, 34, 26);
  lit.scene.lights.push_back({.name = "lamp", .shape = lamp, .node = {}});
  lit.scene.environment->scale *= 0.05f;
  if (!square_lights_know(lit.scene, lit.name + " with a lamp", context)) return;
  Figure figure(lit, shared, pictures, context);
  set_content_material(figure.stage().scene, glossy_material());
  figure.reference(fmt::format("Figure 16, a local light, {}", stage.name), 0);
  figure.ours("30 squares and the lamp", {});
  figure.ours("the same, light by pixel", {"shading=pixel"});
}

/// Figure 16, right: a mesh that bends, without visibility.
void deforming_figure(const SquareStage& stage, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures,
                      const Context& context) {
  Figure figure(stage, shared, pictures, context);
  for (const float part : {0.f, 0.4f}) {
    const float time_s = part * stage.scene.animation_duration_s;
    figure.reference(fmt::format("Figure 16, a skin, {} at {:.2f} s", stage.name, time_s), time_s);
    figure.ours("30 squares, no visibility", {});
    figure.ours("the same, light by pixel", {"shading=pixel"});
  }
}

}  // namespace

void square_pictures(const SquareStage& stage, const SquareBenchShared& shared, std::vector<BenchPicture>& pictures,
                     const Context& context) {
  context.info(fmt::format("bench square-lights: pictures, {}", stage.name));
  const FigureSet figures = figures_of(stage.name);
  const bool moves = stage.scene.animation_duration_s > 0;
  if (figures.lights && stage.scene.environment) light_figure(stage, shared, pictures, context);
  if (figures.counts) count_figure(stage, figures.counts, shared, pictures, context);
  if (figures.motion && moves) motion_figure(stage, figures.motion, shared, pictures, context);
  if (figures.materials) material_figure(stage, shared, pictures, context);
  if (figures.local_light) local_light_figure(stage, shared, pictures, context);
  if (figures.deforming && moves) deforming_figure(stage, shared, pictures, context);
}

}  // namespace sightline
