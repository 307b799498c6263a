// Thin curved tubes through a ball, in the manner of Laine's hairball: the worst case of many visibility methods.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel/parallel.h"
#include "scene/array_builder.h"
#include "scene/builtin/parts.h"
#include "scene/builtin/rooms.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/seeded.h"
#include "scene/materialize.h"

namespace sightline::builtin {
namespace {

struct HairballSettings {
  std::uint64_t triangles = 2850000;
  std::uint64_t seed = 1;
  float radius = 0.0025f;
  bool box = false;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("triangles", &HairballSettings::triangles, {.help = "about how many", .minimum = 100, .maximum = 4e9});
    visit("seed", &HairballSettings::seed, {.help = "of the curves"});
    visit("radius", &HairballSettings::radius, {.help = "of a hair; the ball has radius 1", .minimum = 1e-6, .maximum = 0.1});
    visit("box", &HairballSettings::box, {.help = "in the closed room of builtin:room, lit from above"});
  }
};

constexpr std::uint32_t kSides = 5;

/// How a hair is cut: 57 pieces in the full ball, fewer when only few triangles are asked for.
struct Tessellation {
  std::uint32_t segments;
  std::uint64_t hairs;
  std::uint64_t triangles_per_hair() const { return std::uint64_t{2} * kSides * segments; }
  std::uint64_t vertices_per_hair() const { return std::uint64_t{kSides} * (segments + 1); }
};

Tessellation tessellation(std::uint64_t triangles) {
  const std::uint32_t segments = triangles >= 57'000 ? 57 : 10;
  const std::uint64_t per_hair = std::uint64_t{2} * kSides * segments;
  return {segments, std::max<std::uint64_t>(1, (triangles + per_hair / 2) / per_hair)};
}

/// A hair enters the ball, bends near its middle, and leaves elsewhere; a slow wave on top makes it curl. All points lie in the ball.
class HairCurve {
 public:
  HairCurve(std::uint64_t seed, std::uint64_t hair, float radius) : limit_(1 - radius) {
    Seeded random(seed, hair);
    control_ = {random.on_sphere(), 1.1f * random.in_ball(), 1.1f * random.in_ball(), random.on_sphere()};
    for (int i = 0; i < 2; ++i) {
      wave_axis_[static_cast<std::size_t>(i)] = random.on_sphere() * random.uniform(0.01f, 0.06f);
      wave_turns_[static_cast<std::size_t>(i)] = random.uniform(1, 4) * 2 * kPi;
      wave_phase_[static_cast<std::size_t>(i)] = random.uniform(0, 2 * kPi);
    }
  }
  Vec3 at(float t) const {
    const float s = 1 - t;
    Vec3 p = s * s * s * control_[0] + 3 * s * s * t * control_[1] + 3 * s * t * t * control_[2] + t * t * t * control_[3];
    for (std::size_t i = 0; i < 2; ++i) p += wave_axis_[i] * (std::sin(wave_turns_[i] * t + wave_phase_[i]) - std::sin(wave_phase_[i]));
    const float length = glm::length(p);
    return length > limit_ ? p * (limit_ / length) : p;
  }

 private:
  float limit_;
  std::array<Vec3, 4> control_{};
  std::array<Vec3, 2> wave_axis_{};
  std::array<float, 2> wave_turns_{}, wave_phase_{};
};

/// Rings around the curve; the frame is carried along without twist by reflecting it twice a step [Wang2008].
void fill_hair(const HairCurve& curve, float radius, std::uint32_t segments, std::uint32_t first_vertex, Vec3* positions,
               UVec3* triangles) {
  const float step = 1 / static_cast<float>(segments);
  const auto tangent_at = [&](float t) {
    const float a = std::max(0.f, t - 0.25f * step), b = std::min(1.f, t + 0.25f * step);
    return normalize_or(curve.at(b) - curve.at(a), {0, 0, 1});
  };
  Vec3 point = curve.at(0), tangent = tangent_at(0);
  Vec3 side = glm::normalize(glm::cross(tangent, std::fabs(tangent.x) < 0.6f ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
  for (std::uint32_t ring = 0; ring <= segments; ++ring) {
    const float t = static_cast<float>(ring) * step;
    if (ring > 0) {
      const Vec3 next = curve.at(t), next_tangent = tangent_at(t);
      const Vec3 v1 = next - point;
      const float c1 = length_squared(v1);
      if (c1 > 0) {
        const Vec3 side_l = side - (2 / c1) * glm::dot(v1, side) * v1, tangent_l = tangent - (2 / c1) * glm::dot(v1, tangent) * v1;
        const Vec3 v2 = next_tangent - tangent_l;
        const float c2 = length_squared(v2);
        side = c2 > 0 ? side_l - (2 / c2) * glm::dot(v2, side_l) * v2 : side_l;
      }
      side = normalize_or(side - glm::dot(side, next_tangent) * next_tangent, side);
      point = next;
      tangent = next_tangent;
    }
    const Vec3 other = glm::cross(tangent, side);
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const float phi = 2 * kPi * static_cast<float>(k) / kSides;
      positions[ring * kSides + k] = point + radius * (std::cos(phi) * side + std::sin(phi) * other);
    }
  }
  for (std::uint32_t ring = 0; ring < segments; ++ring) {
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const std::uint32_t a = first_vertex + ring * kSides + k, b = first_vertex + ring * kSides + (k + 1) % kSides;
      *triangles++ = {a, b, a + kSides};
      *triangles++ = {b, b + kSides, a + kSides};
    }
  }
}

Mesh hairball_mesh(const HairballSettings& s, const Context& context) {
  const Tessellation cut = tessellation(s.triangles);
  const std::uint64_t vertices = cut.hairs * cut.vertices_per_hair(), triangles = cut.hairs * cut.triangles_per_hair();
  require_memory(context, vertices * sizeof(Vec3) + triangles * sizeof(UVec3), "the hairball's arrays");
  ArrayBuilder<Vec3> positions(vertices);
  ArrayBuilder<UVec3> faces(triangles);
  parallel_for(context, cut.hairs, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t hair = begin; hair < end; ++hair) {
      const std::size_t first = hair * cut.vertices_per_hair();
      fill_hair(HairCurve(s.seed, hair, s.radius), s.radius, cut.segments, static_cast<std::uint32_t>(first),
                positions.values.data() + first, faces.values.data() + hair * cut.triangles_per_hair());
    }
  });
  Mesh mesh;
  mesh.name = "hairball";
  for (const Vec3& p : positions.values) mesh.bounds.add(p);
  mesh.positions = positions.array;
  mesh.triangles = faces.array;
  return mesh;
}

Scene build_hairball(const HairballSettings& s, const LoadOptions&, const Context& context) {
  Scene scene;
  add_mesh(scene, hairball_mesh(s, context), add_diffuse(scene, "hair", Color(0.7f)));
  if (s.box) return place_in_room(std::move(scene), false);
  scene.lights.push_back(
      {.name = "sun", .shape = DirectionalLight{.direction = glm::normalize(Vec3(-0.5f, -1, -0.4f)), .irradiance = Color(3)}, .node = {}});
  scene.environment = Environment{};
  scene.environment->scale = Color(0.4f, 0.5f, 0.65f);
  add_camera(scene, {1.6f, 1.2f, 3}, Vec3(0), 36);
  scene.hints.size_px = IVec2(1280, 960);
  return scene;
}

}  // namespace

BuiltinScene hairball_scene() { return declare<HairballSettings, build_hairball>("hairball", "thin curved tubes through a ball"); }

}  // namespace sightline::builtin
