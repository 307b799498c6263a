// Live materials: a parameter changes, tables of the BRDF are made anew, a picture shows it.
#include <fmt/format.h>

#include <functional>

#include "bench/median.h"
#include "bench/square_lights/parts.h"

namespace sightline {

using Json = nlohmann::ordered_json;

namespace {

/// A material with a parameter that is turned a little at a time.
struct EditedMaterial {
  const char *key, *name;
  bool isotropic;
  SurfaceModel (*model)(float turn);
};

const std::vector<EditedMaterial>& edited_materials() {
  static const std::vector<EditedMaterial> table = {
      {"phong", "Phong, exponent", true,
       [](float turn) -> SurfaceModel { return PhongMaterial{Color(0.35f), Color(0.35f), 40.f + 2 * turn}; }},
      {"cook-torrance", "Cook-Torrance, roughness", true,
       [](float turn) -> SurfaceModel {
         CookTorranceMaterial m;
         m.roughness = 0.25f + 0.01f * turn;
         return m;
       }},
      {"ward", "Ward, alpha", true,
       [](float turn) -> SurfaceModel {
         WardMaterial m;
         m.alpha_x = m.alpha_y = 0.15f + 0.01f * turn;
         return m;
       }},
      {"ward-anisotropic", "Ward, alpha across", false,
       [](float turn) -> SurfaceModel {
         WardMaterial m;
         m.alpha_x = 0.1f, m.alpha_y = 0.3f + 0.01f * turn;
         return m;
       }},
  };
  return table;
}

}  // namespace

Json square_edit(SquareStage stage, const SquareBenchShared& shared, const Context& context) {
  const int edits = shared.options.quick ? 2 : 9;
  context.info(fmt::format("bench square-lights: materials edited, {}", stage.name));
  if (moving_part_count(stage.scene) == 0) remove_ground(stage.scene);
  const RenderRequest request = square_request(shared.options, shared.bakes, {});
  Json rows = Json::array();
  // Prepared and drawn `edits` times; `change` is what happens before each.
  const auto measure = [&](const char* key, const char* name, const Json& isotropic, const std::function<void(int)>& change) {
    BuiltView view = build_stage(stage, 0, context);
    shoot(view, request, context);
    std::vector<double> whole, edited, prepares, passes;
    for (int i = 0; i < edits; ++i) {
      const Stopwatch watch;
      change(i);
      edit_stage(view, stage, 0, context);
      edited.push_back(watch.seconds());
      const Shot shot = shoot(view, request, context);
      whole.push_back(watch.seconds()), prepares.push_back(shot.prepare_seconds), passes.push_back(shot.seconds);
    }
    rows.push_back({{"key", key},
                    {"name", name},
                    {"isotropic", isotropic},
                    {"edit_seconds", median(edited)},
                    {"prepare_seconds", median(prepares)},
                    {"pass_seconds", median(passes)},
                    {"seconds", median(whole)}});
  };
  set_content_material(stage.scene, glossy_material());
  measure("none", "nothing", Json(), [](int) {});
  for (const EditedMaterial& material : edited_materials()) {
    set_content_material(stage.scene, material.model(-1));
    measure(material.key, material.name, material.isotropic,
            [&](int i) { set_content_material(stage.scene, material.model(static_cast<float>(i))); });
  }
  return {{"view", stage.name},
          {"size", {stage.size_px.x, stage.size_px.y}},
          {"vertices", vertex_count(stage.scene)},
          {"rows", std::move(rows)}};
}

}  // namespace sightline
