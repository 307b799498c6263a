// Two promises of lights that turn: it does not matter which turns, light or scene, and nothing pops on the way around.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/square_lights/motion.h"
#include "bench/square_lights/parts.h"

namespace sightline {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kSteps = 360, kQuickSteps = 24, kTruthPairs = 36, kQuickTruthPairs = 6;
constexpr IVec2 kSize(200, 150), kQuickSize(64, 48);
constexpr double kPercentile = 0.999;

/// Every instance on a node of its own that is turned: what turns keeps its own space, in which tables are made. All instances of a node
/// turn as one.
Scene turnable(Scene scene) {
  scene = pose(std::move(scene), 0);
  scene.nodes.clear(), scene.skins.clear();
  for (Mesh& mesh : scene.meshes) mesh.deformation.reset(), mesh.skin = {}, mesh.weights_node = {};
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    Node turn;
    turn.name = fmt::format("turn {}", i);
    // Animated, but not by itself: rotation is set before posing.
    turn.rotation_track.times_s = {0};
    turn.rotation_track.values = {Vec4(0, 0, 0, 1)};
    scene.nodes.push_back(turn);
    Node placed;
    placed.parent = NodeId(scene.nodes.size() - 1);
    placed.has_matrix = true, placed.matrix = scene.instances[i].world_from_object;
    scene.instances[i].node = NodeId(scene.nodes.size());
    scene.nodes.push_back(placed);
  }
  return scene;
}

void turn_scene(Scene& scene, const Mat3& rotation) {
  const glm::quat q = glm::quat_cast(rotation);
  for (Node& node : scene.nodes) {
    if (node.is_animated()) node.rotation_track.values = {Vec4(q.x, q.y, q.z, q.w)};
  }
}

/// Colours and distances of the first hits.
struct Deep {
  ColorImage image;
  std::vector<float> depth;
};

Deep shoot_deep(const BuiltView& view, RenderRequest request, const Context& context) {
  request.aovs.add(Aov::depth);
  RenderResult result =
      render(view.world, view.camera, view.size_px, PixelFilter(PixelFilter::Kind::centre), request, context, Stopwatch());
  if (result.stop == StopReason::interrupted) context.check_cancelled();
  Deep deep{result.frame.color_image(), {}};
  for (std::uint32_t i = 0; i < deep.image.pixels.size(); ++i) deep.depth.push_back(result.frame.value(Aov::depth, i).x);
  return deep;
}

/// Light turned by R against everything else turned back. Pixels whose ray, rounded another way, meets another surface are left out.
Json turned_back(SquareStage stage, const SquareBenchShared& shared, const Context& context) {
  if (!stage.scene.spheres.empty()) return {};
  const Mat3 rotation = turned_about(Vec3(0.3f, 1, -0.2f), 1.1f);
  stage.scene = turnable(std::move(stage.scene));
  const RenderRequest request = square_request(shared.options, shared.bakes, {});
  SquareStage light = stage;
  turn_light(light.scene, rotation);
  const Deep a = shoot_deep(build_stage(light, 0, context), request, context);
  const Mat3 back = glm::transpose(rotation);
  turn_scene(stage.scene, back);
  stage.camera = rotated(stage.camera, back);
  const Deep b = shoot_deep(build_stage(stage, 0, context), request, context);
  double difference = 0, sum = 0, mean = 0;
  std::vector<double> relative;
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    if (!(a.depth[i] > 0) && !(b.depth[i] > 0)) continue;
    if (!(std::fabs(a.depth[i] - b.depth[i]) <= 1e-3f * a.depth[i])) {
      ++left_out;
      continue;
    }
    const glm::dvec3 p(a.image.pixels[i]), q(b.image.pixels[i]);
    difference += glm::dot(p - q, p - q), sum += glm::dot(p, p), mean += (p.x + p.y + p.z) / 3;
    const glm::dvec3 d = glm::abs(p - q);
    relative.push_back(std::max({d.x, d.y, d.z}));
  }
  if (relative.empty()) return {};
  mean /= static_cast<double>(relative.size());
  std::sort(relative.begin(), relative.end());
  return {{"pixels", relative.size()},
          {"left_out", left_out},
          {"relative_rms", std::sqrt(difference / std::max(1e-30, sum))},
          {"largest_of_mean", relative.back() / std::max(1e-30, mean)}};
}

/// The 99.9th percentile of |I(t + 1) - I(t)| over pixels and steps, for the steps asked for.
double step_change(SquareStage& stage, const RenderRequest& request, int steps, int pairs, const std::vector<std::uint8_t>& mask,
                   const Context& context) {
  const Scene start = stage.scene;
  BuiltView view = build_stage(stage, 0, context);
  const auto at = [&](int step) {
    context.check_cancelled();
    stage.scene = start;
    turn_light(stage.scene, turned_about(Vec3(0, 1, 0), 2 * kPi * static_cast<float>(step) / static_cast<float>(steps)));
    edit_stage(view, stage, 0, context);
    return shoot(view, request, context).image;
  };
  std::vector<float> changes;
  int before = -1;
  ColorImage last;
  for (int pair = 0; pair < pairs; ++pair) {
    const int step = static_cast<int>(static_cast<std::int64_t>(pair) * steps / pairs);
    if (step != before) last = at(step);
    ColorImage next = at(step + 1);
    before = step + 1;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (!mask[i]) continue;
      const Color d = glm::abs(next.pixels[i] - last.pixels[i]);
      changes.push_back((d.x + d.y + d.z) / 3);
    }
    last = std::move(next);
  }
  stage.scene = start;
  if (changes.empty()) return 0;
  const auto rank = static_cast<std::ptrdiff_t>(kPercentile * static_cast<double>(changes.size() - 1));
  std::nth_element(changes.begin(), changes.begin() + rank, changes.end());
  return changes[static_cast<std::size_t>(rank)];
}

}  // namespace

Json square_rotation(SquareStage stage, const SquareBenchShared& shared, const Context& context) {
  context.info(fmt::format("bench square-lights: the environment turns, {}", stage.name));
  const bool quick = shared.options.quick;
  stage.size_px = shared.options.size_px.value_or(quick ? kQuickSize : kSize);
  set_content_material(stage.scene, glossy_material());
  Json result = {{"view", stage.name}, {"size", {stage.size_px.x, stage.size_px.y}}};
  result["turned"] = turned_back(stage, shared, context);
  const std::vector<std::uint8_t> mask = surface_mask(build_stage(stage, 0, context), light_request(1), context);
  const int steps = quick ? kQuickSteps : kSteps;
  const auto change = [&](const char* lights, int pairs) {
    return step_change(stage, square_request(shared.options, shared.bakes, {lights}), steps, pairs, mask, context);
  };
  const double ours = change("lights=30", steps);
  // Every texel changes smoothly: fewer steps say the same.
  const double truth = change("lights=all-tables", quick ? kQuickTruthPairs : kTruthPairs);
  result["steps"] = steps;
  result["change"] = ours;
  result["change_of_all_texels"] = truth;
  result["ratio"] = truth > 0 ? Json(ours / truth) : Json();
  return result;
}

}  // namespace sightline
