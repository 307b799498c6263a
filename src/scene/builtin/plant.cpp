// CAD-like geometry of any size: square units with pipe racks, elbows, bolted flanges, gratings and tanks, as instances or as one stream.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "base/core/error.h"
#include "scene/builtin/parts.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/seeded.h"
#include "scene/materialize.h"

namespace sightline::builtin {
namespace {

struct PlantSettings {
  std::uint64_t triangles = 1000000;
  std::uint64_t seed = 1;
  bool instanced = true;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("triangles", &PlantSettings::triangles, {.help = "about how many, instances counted each time", .minimum = 1000, .maximum = 4e9});
    visit("seed", &PlantSettings::seed, {.help = "of the layout"});
    visit("instanced", &PlantSettings::instanced, {.help = "units are instances of eight meshes; else one mesh, made as a stream"});
  }
};

constexpr float kUnitEdge = 14;  ///< metres from one unit to the next
constexpr std::size_t kVariants = 8;
constexpr std::size_t kPlantChunk = 60000;

/// One unit's geometry, grown part by part until it has the wanted number of triangles.
class UnitMaker {
 public:
  explicit UnitMaker(std::uint64_t limit) : limit_(limit) {}
  bool full() const { return chunk_.triangles.size() >= limit_; }
  MeshChunk take() { return std::move(chunk_); }

  void box(const Vec3& low, const Vec3& high) {
    if (full()) return;
    std::array<std::uint32_t, 8> corner{};
    for (std::size_t c = 0; c < 8; ++c) corner[c] = add({c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z});
    static constexpr int kBoxFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : kBoxFaces) {
      const auto at = [&](int i) { return corner[static_cast<std::size_t>(f[i])]; };
      chunk_.triangles.emplace_back(at(0), at(1), at(2));
      chunk_.triangles.emplace_back(at(0), at(2), at(3));
    }
  }
  /// A closed rod along `axis`.
  void rod(const Vec3& from, const Vec3& axis, float radius, int sides) {
    if (full()) return;
    const auto [u, v] = frame(axis);
    const std::uint32_t low = ring(from, u, v, radius, sides), high = ring(from + axis, u, v, radius, sides);
    join(low, high, sides);
    for (std::uint32_t k = 1; k + 1 < static_cast<std::uint32_t>(sides); ++k) {
      chunk_.triangles.emplace_back(low, low + k + 1, low + k);
      chunk_.triangles.emplace_back(high, high + k, high + k + 1);
    }
  }
  /// A quarter bend that leaves `start` along `from` and ends along `to` (unit, perpendicular).
  void elbow(const Vec3& start, const Vec3& from, const Vec3& to, float bend, float radius, int sides) {
    if (full()) return;
    constexpr int kSteps = 8;
    const Vec3 normal = glm::cross(from, to), center = start + bend * to;
    std::uint32_t previous = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const float angle = 0.5f * kPi * static_cast<float>(i) / kSteps;
      const Vec3 outward = std::sin(angle) * from - std::cos(angle) * to;
      const std::uint32_t current = ring(center + bend * outward, outward, -normal, radius, sides);
      if (i > 0) join(previous, current, sides);
      previous = current;
    }
  }
  /// Two disks held together by hexagonal bolts.
  void flange(const Vec3& center, const Vec3& axis, float radius, int sides) {
    rod(center - 0.06f * axis, 0.055f * axis, 1.7f * radius, sides);
    rod(center + 0.005f * axis, 0.055f * axis, 1.7f * radius, sides);
    const auto [u, v] = frame(axis);
    for (int k = 0; k < 8; ++k) {
      const float angle = 2 * kPi * static_cast<float>(k) / 8;
      rod(center - 0.1f * axis + 1.4f * radius * (std::cos(angle) * u + std::sin(angle) * v), 0.2f * axis, 0.12f * radius, 6);
    }
  }

 private:
  static std::pair<Vec3, Vec3> frame(const Vec3& axis) {
    const Vec3 n = glm::normalize(axis);
    const Vec3 u = glm::normalize(glm::cross(std::fabs(n.y) < 0.9f ? Vec3(0, 1, 0) : Vec3(1, 0, 0), n));
    return {u, glm::cross(n, u)};
  }
  std::uint32_t add(const Vec3& p) {
    chunk_.positions.push_back(p);
    return static_cast<std::uint32_t>(chunk_.positions.size() - 1);
  }
  std::uint32_t ring(const Vec3& center, const Vec3& u, const Vec3& v, float radius, int sides) {
    const auto first = static_cast<std::uint32_t>(chunk_.positions.size());
    for (int k = 0; k < sides; ++k) {
      const float angle = 2 * kPi * static_cast<float>(k) / static_cast<float>(sides);
      add(center + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    return first;
  }
  void join(std::uint32_t low, std::uint32_t high, int sides) {
    const auto n = static_cast<std::uint32_t>(sides);
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t l = (k + 1) % n;
      chunk_.triangles.emplace_back(low + k, low + l, high + k);
      chunk_.triangles.emplace_back(low + l, high + l, high + k);
    }
  }

  std::uint64_t limit_;
  MeshChunk chunk_;
};

MeshChunk make_unit(std::uint64_t seed, std::uint64_t variant, std::uint64_t limit) {
  Seeded random(seed, variant);
  UnitMaker unit(limit);
  unit.box({-6.5f, -0.2f, -6.5f}, {6.5f, 0, 6.5f});
  for (int i = 0; i < 2; ++i) {  // tanks
    const float radius = random.uniform(0.9f, 1.5f), x = i ? 4.3f : -4.3f;
    unit.rod({x, 0, 4}, {0, random.uniform(2.5f, 6), 0}, radius, 48);
  }
  for (int i = 0; i < 4; ++i) {  // rack: columns and beams
    const float x = -6 + 4 * static_cast<float>(i);
    unit.box({x - 0.12f, 0, -4.1f}, {x + 0.12f, 6, -3.9f});
    unit.box({x - 0.12f, 0, 0.9f}, {x + 0.12f, 6, 1.1f});
    for (int level = 0; level < 3; ++level) {
      const float y = 2.5f + 1.6f * static_cast<float>(level);
      unit.box({x - 0.1f, y - 0.25f, -4}, {x + 0.1f, y, 1});
    }
  }
  for (int level = 0; level < 3; ++level) {  // pipes, every one with flanges and a bend down to the floor
    const float y = 2.5f + 1.6f * static_cast<float>(level);
    for (float z = -3.6f; z < 0.7f;) {
      const float radius = random.uniform(0.06f, 0.22f), bend = 3 * radius;
      z += 1.7f * radius;
      const float end = random.uniform(3, 6) - bend;
      unit.rod({-6.4f, y + radius, z}, {end + 6.4f, 0, 0}, radius, 20);
      unit.elbow({end, y + radius, z}, {1, 0, 0}, {0, -1, 0}, bend, radius, 20);
      unit.rod({end + bend, 0, z}, {0, y + radius - bend, 0}, radius, 20);
      for (float x = -5; x < end; x += random.uniform(1.5f, 3)) unit.flange({x, y + radius, z}, {1, 0, 0}, radius, 24);
      z += 1.7f * radius + 0.08f;
    }
  }
  // Gratings: walkways of thin bars, as many as the limit leaves room for.
  for (int level = 0; level < 4 && !unit.full(); ++level) {
    const float y = 1.2f + 1.6f * static_cast<float>(level);
    for (float x = -6; x < 6; x += 0.03f) unit.box({x, y, 1.3f}, {x + 0.005f, y + 0.03f, 2.5f});
    for (float z = 1.3f; z < 2.5f; z += 0.1f) unit.box({-6, y + 0.01f, z}, {6, y + 0.03f, z + 0.006f});
  }
  return unit.take();
}

struct Placement {
  std::size_t variant;
  Vec3 offset;
};

/// The units, and where they stand; the same whether they become instances or a stream.
struct Plan {
  std::vector<MeshChunk> units;
  std::vector<Placement> placements;
  Bounds bounds;
};

Plan make_plan(const PlantSettings& s) {
  Plan plan;
  std::uint64_t sum = 0;
  for (std::size_t v = 0; v < kVariants; ++v) {
    plan.units.push_back(make_unit(s.seed, v, std::min<std::uint64_t>(s.triangles, kPlantChunk)));
    sum += plan.units.back().triangles.size();
  }
  const std::uint64_t count = std::max<std::uint64_t>(1, (s.triangles * kVariants + sum / 2) / sum);
  const auto side = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t column = i % side, row = i / side;
    const Vec3 offset(kUnitEdge * static_cast<float>(column), 0, -kUnitEdge * static_cast<float>(row));
    plan.placements.push_back({i % kVariants, offset});
    for (const Vec3& p : plan.units[i % kVariants].positions) plan.bounds.add(p + offset);
  }
  return plan;
}

/// Unit after unit, each a chunk.
class PlantSource final : public MeshSource {
 public:
  explicit PlantSource(Plan plan) : plan_(std::move(plan)) {
    for (const Placement& p : plan_.placements) {
      vertices_ += plan_.units[p.variant].positions.size();
      triangles_ += plan_.units[p.variant].triangles.size();
    }
  }
  std::uint64_t vertex_count() const override { return vertices_; }
  std::uint64_t triangle_count() const override { return triangles_; }
  Bounds bounds() const override { return plan_.bounds; }
  void restart() override { next_ = 0; }
  bool next(MeshChunk& chunk) override {
    if (next_ == plan_.placements.size()) return false;
    const Placement& place = plan_.placements[next_++];
    chunk = plan_.units[place.variant];
    for (Vec3& p : chunk.positions) p += place.offset;
    return true;
  }

 private:
  Plan plan_;
  std::size_t next_ = 0;
  std::uint64_t vertices_ = 0, triangles_ = 0;
};

Scene build_plant(const PlantSettings& s, const LoadOptions& options, const Context& context) {
  Scene scene;
  Plan plan = make_plan(s);
  const Bounds bounds = plan.bounds;
  const MaterialId paint = add_diffuse(scene, "paint", Color(0.55f, 0.57f, 0.58f));
  if (s.instanced) {
    for (std::size_t v = 0; v < kVariants; ++v) {
      Mesh mesh;
      mesh.name = "unit " + std::to_string(v);
      mesh.positions = SharedArray<Vec3>(plan.units[v].positions);
      mesh.triangles = SharedArray<UVec3>(plan.units[v].triangles);
      for (const Vec3& p : mesh.positions) mesh.bounds.add(p);
      mesh.materials = {paint};
      scene.meshes.push_back(std::move(mesh));
    }
    for (const Placement& p : plan.placements) {
      Instance instance;
      instance.mesh = MeshId(p.variant);
      instance.world_from_object[3] = Vec4(p.offset, 1);
      scene.instances.push_back(std::move(instance));
    }
  } else {
    Mesh mesh;
    mesh.name = "plant";
    mesh.bounds = bounds;
    mesh.source = std::make_shared<PlantSource>(std::move(plan));
    if (!options.keep_sources) mesh = materialize(mesh, context);
    add_mesh(scene, std::move(mesh), paint);
  }
  scene.lights.push_back(
      {.name = "sun",
       .shape = DirectionalLight{.direction = glm::normalize(Vec3(-0.6f, -1, -0.5f)), .irradiance = Color(3, 2.8f, 2.5f)},
       .node = {}});
  scene.environment = Environment{};
  scene.environment->scale = Color(0.4f, 0.5f, 0.65f);
  add_camera(scene, {-11, 9, 15}, {6, 1.5f, -8}, 45);
  scene.hints.size_px = IVec2(1280, 960);
  return scene;
}

}  // namespace

BuiltinScene plant_scene() {
  return declare<PlantSettings, build_plant>("plant", "pipe racks, bolted flanges, gratings and tanks, any size, instanced or as a stream");
}

}  // namespace sightline::builtin
