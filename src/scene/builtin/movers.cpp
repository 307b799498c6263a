// Rigid bodies that move along closed paths and shadow each other: movers, pair.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/core/error.h"
#include "scene/builtin/parts.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/seeded.h"
#include "scene/builtin/solids.h"

namespace sightline::builtin {
namespace {

/// All motions close after this time: 120 frames at 30 frames a second.
constexpr float kPeriodSeconds = 4;
constexpr int kGroundSide = 100;

/// A circle about a centre, in a plane that is tilted about +X, and a spin about the body's own axis.
struct Motion {
  Vec3 center{0};
  float radius = 1, tilt_rad = 0;
  float phase_rad = 0;
  int turns = 1;       ///< round the circle in a period; negative: clockwise seen from above
  float bob = 0;       ///< height of an up and down of its own, twice a period
  Vec3 axis{0, 1, 0};  ///< unit
  int spins = 1;       ///< about the axis in a period
};

/// Place and velocity at a time.
void follow(const Motion& m, float time_s, Vec3& place, Vec3& velocity) {
  const float speed = 2 * kPi * static_cast<float>(m.turns) / kPeriodSeconds, angle_rad = m.phase_rad + speed * time_s;
  const float c = std::cos(angle_rad), s = std::sin(angle_rad);
  const Vec3 u(1, 0, 0), v(0, std::sin(m.tilt_rad), -std::cos(m.tilt_rad));
  const float bob_speed = 4 * kPi / kPeriodSeconds, bob_angle_rad = bob_speed * time_s + 3 * m.phase_rad;
  place = m.center + m.radius * (c * u + s * v) + Vec3(0, m.bob * std::sin(bob_angle_rad), 0);
  velocity = m.radius * speed * (c * v - s * u) + Vec3(0, m.bob * bob_speed * std::cos(bob_angle_rad), 0);
}

Node moving_node(std::string name, const Motion& motion) {
  Node node;
  node.name = std::move(name);
  // A cubic through 32 places with their velocities stays within a few millionths of the circle.
  constexpr int kKeys = 32;
  node.translation_track.interpolation = Interpolation::cubic_spline;
  for (int key = 0; key <= kKeys; ++key) {
    const float time_s = kPeriodSeconds * static_cast<float>(key) / kKeys;
    Vec3 place, velocity;
    follow(motion, time_s, place, velocity);
    node.translation_track.times_s.push_back(time_s);
    for (const Vec3& value : {velocity, place, velocity}) node.translation_track.values.emplace_back(value, 0);
  }
  // Eighths of a turn, between which the rotation runs at a constant speed.
  const int steps = 8 * std::abs(motion.spins);
  for (int step = 0; step <= steps; ++step) {
    const float half_angle_rad = kPi * static_cast<float>(motion.spins) * static_cast<float>(step) / static_cast<float>(steps);
    node.rotation_track.times_s.push_back(kPeriodSeconds * static_cast<float>(step) / static_cast<float>(steps));
    node.rotation_track.values.emplace_back(std::sin(half_angle_rad) * motion.axis, std::cos(half_angle_rad));
  }
  return node;
}

void add_moving(Scene& scene, Mesh mesh, const Color& reflectance, const Motion& motion) {
  const std::string name = mesh.name;
  add_mesh(scene, std::move(mesh), add_diffuse(scene, name, reflectance));
  scene.instances.back().node = NodeId(scene.nodes.size());
  scene.nodes.push_back(moving_node(name, motion));
}

/// What both scenes end with: ground at height 0 below `reach`, a camera that sees all of the motion, and the time.
Scene staged(Scene scene, const Bounds& reach, bool ground) {
  if (ground) {
    const float edge = 2.2f * glm::length(reach.extent());
    add_mesh(scene, ground_mesh({reach.center().x, 0, reach.center().z}, edge, kGroundSide), add_diffuse(scene, "ground", Color(0.5f)));
  }
  scene.animation_duration_s = kPeriodSeconds;
  scene.framing = reach;
  scene.cameras.push_back(framing_camera(reach));
  scene.hints.size_px = IVec2(800, 600);
  return pose(std::move(scene), 0);
}

struct MoversSettings {
  int parts = 5;
  std::uint64_t vertices = 80000;
  bool ground = true;
  std::uint64_t seed = 1;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("parts", &MoversSettings::parts, {.help = "bodies, each moving on its own", .minimum = 1, .maximum = 64});
    visit("vertices", &MoversSettings::vertices, {.help = "of all bodies together, about", .minimum = 1000, .maximum = 1e8});
    visit("ground", &MoversSettings::ground, {.help = "100 x 100 vertices below them"});
    visit("seed", &MoversSettings::seed, {.help = "chooses shapes, axes and phases"});
  }
};

/// Bodies of radius 1 go round in storeys: those of a storey one after another, every other storey the other way, so that each passes above
/// and below all of the next ones. No two come closer than a tenth: storeys are 2.6 apart of which bobbing takes 0.5, and neighbours on a
/// circle 2.5.
struct Storeys {
  static constexpr float kSpacing = 2.6f, kNeighbours = 2.5f, kBob = 0.25f, kLowest = 1.4f;
  explicit Storeys(int parts) {
    // Fewer above: 5 are 3 and 2, 12 are 5, 4 and 3.
    int storeys = 1;
    while ((storeys + 1) * (storeys + 2) / 2 + storeys <= parts) ++storeys;
    for (int storey = 0, left = parts; storey < storeys; ++storey) {
      const int rest = storeys - storey;
      // What is left, as a falling sequence of `rest` numbers.
      const int count = std::min(left, (left + rest * (rest - 1) / 2 + rest - 1) / rest);
      counts.push_back(count);
      left -= count;
    }
  }
  float radius(std::size_t storey) const {
    const int count = counts[storey];
    // A single body needs no circle, but should not stand still.
    return count < 2 ? 1.f : std::max(1.5f, 0.5f * kNeighbours / std::sin(kPi / static_cast<float>(count)));
  }
  static float height(std::size_t storey) { return kLowest + kSpacing * static_cast<float>(storey); }

  std::vector<int> counts;
};

Scene build_movers(const MoversSettings& s, const LoadOptions&, const Context& context) {
  if (s.vertices < kLeastSolidVertices * static_cast<std::uint64_t>(s.parts)) {
    throw usage_error("so many bodies need more vertices").remedy("give vertices= at least 200 a part");
  }
  constexpr Color kColors[] = {{0.75f, 0.30f, 0.22f}, {0.25f, 0.45f, 0.70f}, {0.72f, 0.62f, 0.25f}, {0.35f, 0.62f, 0.35f},
                               {0.60f, 0.40f, 0.65f}, {0.70f, 0.70f, 0.68f}, {0.30f, 0.62f, 0.62f}};
  using MakeSolid = Mesh (*)(std::uint64_t, std::uint64_t);
  constexpr MakeSolid kSolids[] = {torus_knot, bumpy_ball, gear};
  const Storeys storeys(s.parts);
  Scene scene;
  Bounds reach;
  std::uint64_t vertices_left = s.vertices;
  int part = 0;
  for (std::size_t storey = 0; storey < storeys.counts.size(); ++storey) {
    const float radius = storeys.radius(storey), height = Storeys::height(storey);
    for (int k = 0; k < storeys.counts[storey]; ++k, ++part) {
      context.check_cancelled();
      Seeded random(s.seed, 100 + static_cast<std::uint64_t>(part));
      const Motion motion{
          .center = {0, height, 0},
          .radius = radius,
          .phase_rad = 2 * kPi * static_cast<float>(k) / static_cast<float>(storeys.counts[storey]) + static_cast<float>(storey),
          .turns = storey % 2 == 0 ? 1 : -1,
          .bob = Storeys::kBob,
          .axis = glm::normalize(Vec3(0, 0.6f, 0) + random.on_sphere()),
          .spins = part % 2 == 0 ? 1 : -2};
      // What one body's grid misses of its share, the next ones make up for.
      const std::uint64_t share = vertices_left / static_cast<std::uint64_t>(s.parts - part);
      Mesh mesh = kSolids[part % 3](share, mix(s.seed) + static_cast<std::uint64_t>(part));
      vertices_left -= std::min<std::uint64_t>(vertices_left, mesh.positions.size());
      mesh.name = fmt::format("{} {}", mesh.name, part);
      add_moving(scene, std::move(mesh), kColors[static_cast<std::size_t>(part) % std::size(kColors)], motion);
    }
    const Vec3 extent(radius + 1, 1 + Storeys::kBob, radius + 1);
    reach.add(Vec3(0, height, 0) - extent);
    reach.add(Vec3(0, height, 0) + extent);
  }
  return staged(std::move(scene), reach, s.ground);
}

struct PairSettings {
  std::uint64_t vertices = 40000;
  bool ground = true;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("vertices", &PairSettings::vertices, {.help = "of both bodies together, about", .minimum = 1000, .maximum = 1e8});
    visit("ground", &PairSettings::ground, {.help = "100 x 100 vertices below them"});
  }
};

Scene build_pair(const PairSettings& s, const LoadOptions&, const Context&) {
  // Opposite each other on a steep circle: each passes above the other once a period.
  const Motion knot{.center = {0, 2.05f, 0}, .radius = 1.04f, .tilt_rad = 1.0f, .axis = glm::normalize(Vec3(0.3f, 1, 0.2f)), .spins = 1};
  Motion ball = knot;
  ball.phase_rad = kPi;
  ball.axis = glm::normalize(Vec3(-0.5f, 0.6f, 0.4f));
  ball.spins = -1;
  Scene scene;
  add_moving(scene, torus_knot(s.vertices / 2, 4), {0.75f, 0.35f, 0.25f}, knot);
  const std::uint64_t rest = s.vertices - std::min<std::uint64_t>(s.vertices, scene.meshes[0].positions.size());
  add_moving(scene, bumpy_ball(rest, 1), {0.3f, 0.5f, 0.7f}, ball);
  Bounds reach;
  reach.add(Vec3(-2.04f, 0.05f, -1.6f));
  reach.add(Vec3(2.04f, 3.95f, 1.6f));
  return staged(std::move(scene), reach, s.ground);
}

}  // namespace

BuiltinScene movers_scene() {
  return declare<MoversSettings, build_movers>("movers",
                                               "bodies that go round above and beside each other, every 4 s: give it an environment");
}
BuiltinScene pair_scene() {
  return declare<PairSettings, build_pair>("pair", "a knot and a ball that circle each other every 4 s: give it an environment");
}

}  // namespace sightline::builtin
