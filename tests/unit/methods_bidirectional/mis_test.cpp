// The weights of all strategies of one path: they add up to 1, and each is what the densities say.
#include "methods/bidirectional/mis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "methods/bidirectional/camera.h"
#include "methods/bidirectional/vertex.h"
#include "scene/builtin/parts.h"
#include "shade/material_eval.h"
#include "support/studio.h"

namespace sightline::bidirectional {
namespace {

using test::Shot;

/// A room with surfaces of every kind and lights of every kind.
Scene crowded_room() {
  Scene scene = test::builtin_scene("glass");
  const MaterialId gold = builtin::add_material(scene, "gold", ConductorMaterial{.alpha_u = 0.3f, .alpha_v = 0.15f});
  const MaterialId coat = builtin::add_material(scene, "coat", CoatedDiffuseMaterial{.reflectance = Color(0.4f)});
  const MaterialId frosted = builtin::add_material(scene, "frosted", DielectricMaterial{.eta = 1.4f, .alpha_u = 0.3f, .alpha_v = 0.3f});
  const MaterialId paper = builtin::add_material(scene, "paper", DiffuseTransmissionMaterial{});
  const MaterialId pane = builtin::add_material(scene, "pane", DielectricMaterial{.thin = true});
  builtin::add_sphere(scene, "gold", {-0.6f, 1.4f, 0.2f}, 0.3f, gold);
  builtin::add_sphere(scene, "coat", {0.6f, 1.4f, -0.4f}, 0.3f, coat);
  builtin::add_sphere(scene, "frosted", {0, 1.1f, 0.3f}, 0.25f, frosted);
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({-0.9f, 0.9f, -0.9f}, {0.5f, 0, 0}, {0, 0.5f, 0.2f}).build("paper"), paper);
  builtin::add_mesh(scene, builtin::MeshBuilder().quad({0.3f, 0.9f, 0.8f}, {0.5f, 0, 0}, {0, 0.5f, 0.2f}).build("pane"), pane);
  builtin::add_sphere(scene, "lamp", {0.1f, 0.2f, 0.8f}, 0.1f, builtin::add_emitter(scene, "lamp", Color(20)));
  const auto add = [&](const auto& shape) { scene.lights.push_back({.name = "light", .shape = shape, .node = {}}); };
  add(PointLight{.position = {0, 1.8f, 0}, .intensity = Color(1)});
  add(SpotLight{.position = {0.5f, 1.8f, 0}, .direction = {0, -1, 0}, .intensity = Color(3)});
  add(DirectionalLight{.direction = glm::normalize(Vec3(0, -1, -1)), .irradiance = Color(2)});
  add(RectangleLight{.center = {0, 1, 0.9f}, .half_u = {0.1f, 0, 0}, .half_v = {0, 0.1f, 0}, .radiance = Color(5)});
  add(DiskLight{.center = {0, 1.5f, 0.9f}, .half_u = {0.1f, 0, 0}, .half_v = {0, -0.1f, 0}, .radiance = Color(5)});
  add(SphereLight{.center = {-0.3f, 1.6f, 0.7f}, .radius = 0.05f, .radiance = Color(30)});
  scene.environment = Environment{};
  return scene;
}

/// What scattered at a surface of the path, as densities of both sides and whether it was a delta.
struct Event {
  double pdf_eye = 0, pdf_light = 0;
  bool delta = false;
};

/// A whole path: surfaces[0] is the first that the camera sees, and the light comes last.
struct FullPath {
  Vec3 camera{0};
  std::vector<Surface> surfaces;
  std::vector<Event> events;
  std::uint32_t light = kNoLight;
  Vec3 light_point{0}, light_normal{0};
  Vec3 to_light{0};  ///< unit, from the last surface
  bool infinite = false, delta_light = false, findable = false, is_mesh = false;
  float direct_pdf = 0;  ///< as LightTable::sample gives it

  std::size_t size() const { return surfaces.size(); }
  Vec3 position(int i) const {
    return i < 0 ? camera : i < static_cast<int>(size()) ? surfaces[static_cast<std::size_t>(i)].position : light_point;
  }
  Vec3 normal(int i) const {
    return i < 0 ? Vec3(0) : i < static_cast<int>(size()) ? surfaces[static_cast<std::size_t>(i)].geometric_normal : light_normal;
  }
  /// Unit, from i to i + 1, which is nearer to the light.
  Vec3 edge(int i) const { return i + 1 == static_cast<int>(size()) ? to_light : glm::normalize(position(i + 1) - position(i)); }
  bool at_infinity(int i) const { return infinite && i + 1 == static_cast<int>(size()); }
  double squared(int i) const { return at_infinity(i) ? 1 : static_cast<double>(length_squared(position(i + 1) - position(i))); }
  double cosine(int vertex, int i) const {
    const Vec3 n = normal(vertex);
    return is_black(n) ? 1 : std::fabs(static_cast<double>(glm::dot(n, edge(i))));
  }
};

/// The very steps of the subpaths, along a path that is already there.
class Strategies {
 public:
  Strategies(const FullPath& path, const LightTable& lights, const CameraImportance& camera, Heuristic h)
      : path_(path), camera_(camera), h_(h), emission_(lights.emission_pdf(path.light, path.light_point, -path.to_light)) {
    const int last = static_cast<int>(path.size()) - 1;
    // By area, or by solid angle at infinity.
    const bool by_area = !path.infinite && !path.delta_light;
    to_light_area_ = by_area ? path.cosine(last + 1, last) / path.squared(last) : 1.0;
    direct_ = static_cast<double>(path.direct_pdf) * to_light_area_;
  }

  int vertex_count() const { return static_cast<int>(path_.size()) + 2; }

  /// Weight of the strategy with s light vertices; 0 where it cannot make the path.
  double weight(int s) const {
    const int surfaces = static_cast<int>(path_.size()), eye = surfaces + 1 - s;  // surfaces of the eye subpath, but for s = 0
    if (s == 0) {
      if (!path_.findable) return 0;
      MisVertex hit = eye_vertex(surfaces);
      return emission_weight(h_, {direct_, emission_.start, emission_.leave}, hit, false);
    }
    if (s == 1) {
      if (path_.events.back().delta) return 0;
      const MisVertex x = eye_vertex(surfaces - 1);
      const Event& e = path_.events.back();
      const double leave = static_cast<double>(emission_.leave) * path_.cosine(surfaces - 1, surfaces - 1) / path_.squared(surfaces - 1);
      return light_sample_weight(h_, {direct_, emission_.start, leave}, path_.findable ? e.pdf_eye * to_light_area_ : 0.0, x,
                                 x.sum(h_, e.pdf_light, false));
    }
    const int y = eye;  // index of the light subpath's end among the surfaces
    const Event& at_light = path_.events[static_cast<std::size_t>(y)];
    const MisVertex light = light_vertex(y);
    const double light_sum = light.sum(h_, at_light.pdf_eye, false);
    if (at_light.delta) return 0;
    if (y == 0) return connection_weight(h_, camera_area_pdf(), light.pdf, light_sum, 0, 1, 0);
    const Event& at_eye = path_.events[static_cast<std::size_t>(y - 1)];
    if (at_eye.delta) return 0;
    const MisVertex x = eye_vertex(y - 1);
    const double to_light = path_.cosine(y, y - 1) / path_.squared(y - 1), to_eye = path_.cosine(y - 1, y - 1) / path_.squared(y - 1);
    return connection_weight(h_, at_eye.pdf_eye * to_light, light.pdf, light_sum, at_light.pdf_light * to_eye, x.pdf,
                             x.sum(h_, at_eye.pdf_light, false));
  }

  /// The density of the same strategy, straight from its definition; 0 where it cannot make the path.
  double density(int s) const {
    const int surfaces = static_cast<int>(path_.size());
    if (s == 0 && !path_.findable) return 0;
    if (s == 1 && path_.events.back().delta) return 0;
    const int first_light = surfaces + 1 - s;  // first surface of the light side
    if (s >= 2 && path_.events[static_cast<std::size_t>(first_light)].delta) return 0;
    if (s >= 2 && first_light > 0 && path_.events[static_cast<std::size_t>(first_light - 1)].delta) return 0;
    double p = 1;
    for (int i = 0; i < std::min(first_light, surfaces); ++i) {
      p *= i == 0 ? camera_area_pdf()
                  : path_.events[static_cast<std::size_t>(i - 1)].pdf_eye * path_.cosine(i, i - 1) / path_.squared(i - 1);
    }
    if (s == 0) return p * path_.events.back().pdf_eye * to_light_area_;
    if (s == 1) return p * direct_;
    p *= static_cast<double>(emission_.start);
    for (int i = surfaces - 1; i >= first_light; --i) {
      const double pdf = i == surfaces - 1 ? static_cast<double>(emission_.leave) : path_.events[static_cast<std::size_t>(i + 1)].pdf_light;
      p *= pdf * path_.cosine(i, i) / path_.squared(i);
    }
    return p;
  }

 private:
  double camera_area_pdf() const { return camera_.pdf(path_.camera, path_.edge(-1)) * path_.cosine(0, -1) / path_.squared(-1); }
  /// Vertex `last` of the eye subpath; the light itself is `size()`.
  MisVertex eye_vertex(int last) const {
    MisVertex v;
    v.connect = 1;
    for (int i = 0; i <= last; ++i) {
      const double pdf = i == 0 ? camera_.pdf(path_.camera, path_.edge(-1)) : path_.events[static_cast<std::size_t>(i - 1)].pdf_eye;
      const bool light_at_infinity = path_.at_infinity(i - 1);
      arrive(v, pdf, light_at_infinity ? 1.0 : path_.cosine(i, i - 1), i == 0 ? 1.0 : path_.cosine(i - 1, i - 1), path_.squared(i - 1));
      if (i == last) break;
      const Event& e = path_.events[static_cast<std::size_t>(i)];
      v = after(v, h_, e.pdf_light, e.delta);
    }
    return v;
  }
  /// Surface `last` as a vertex of the light subpath.
  MisVertex light_vertex(int last) const {
    const int surfaces = static_cast<int>(path_.size());
    MisVertex v;
    v.previous_sum = path_.findable ? 1 : 0;
    v.previous_pdf = emission_.start;
    v.connect = h_(direct_ / static_cast<double>(emission_.start));
    for (int i = surfaces - 1; i >= last; --i) {
      const double pdf = i == surfaces - 1 ? static_cast<double>(emission_.leave) : path_.events[static_cast<std::size_t>(i + 1)].pdf_light;
      const bool light_at_infinity = path_.at_infinity(i);
      arrive(v, pdf, path_.cosine(i, i), light_at_infinity ? 1.0 : path_.cosine(i + 1, i), path_.squared(i));
      if (i == last) break;
      const Event& e = path_.events[static_cast<std::size_t>(i)];
      v = after(v, h_, e.pdf_eye, e.delta);
    }
    return v;
  }

  const FullPath& path_;
  const CameraImportance& camera_;
  Heuristic h_;
  EmissionPdf emission_;
  double to_light_area_, direct_;
};

/// Walks from the camera and ends on a light: one that was hit, or a light sample.
class PathMaker {
 public:
  PathMaker(const Shot& shot, const View& view) : world_(*shot.world), view_(view) {}

  std::optional<FullPath> make(std::mt19937& random) {
    std::uniform_real_distribution<float> u(0, 1);
    const auto number = [&] { return std::min(u(random), 0x1.fffffep-1f); };
    FullPath path;
    Vec3 origin, direction;
    view_.ray_through(number() * static_cast<float>(view_.width()), number() * static_cast<float>(view_.height()), {number(), number()},
                      origin, direction);
    path.camera = origin;
    const std::size_t wanted = 1 + static_cast<std::size_t>(number() * 6);
    const LightTable& lights = world_.lights();
    RayBatch rays;
    rays.resize(1);
    HitBatch hits;
    SurfaceBatch surfaces;
    RayCounts counts;
    while (true) {
      rays.set(0, {origin, 0, direction, std::numeric_limits<float>::infinity()});
      world_.tracer().intersect(rays, hits, BatchKind::bounce, counts);
      world_.surfaces(rays, hits, surfaces);
      const auto load = [](const Vec3Batch& b) { return Vec3(b.x[0], b.y[0], b.z[0]); };
      if (!hits.hit(0) || surfaces.light[0] != kNoLight) {
        if (path.size() == 0) return std::nullopt;
        const Surface& last = path.surfaces.back();
        path.infinite = !hits.hit(0), path.findable = true;
        path.to_light = direction;
        if (path.infinite) {
          path.light = lights.environment_entry();
          path.direct_pdf = lights.environment_pdf(last.position, last.geometric_normal, direction);
          return path;
        }
        path.light = surfaces.light[0], path.is_mesh = true;
        path.light_point = load(surfaces.position), path.light_normal = load(surfaces.geometric_normal);
        path.to_light = glm::normalize(path.light_point - last.position);
        if (is_black(lights.emission(path.light, {}, glm::dot(path.light_normal, direction) < 0))) return std::nullopt;
        path.direct_pdf = lights.pdf(last.position, last.geometric_normal, path.light, path.light_point, path.light_normal, path.to_light);
        return path;
      }
      Surface s;
      s.position = load(surfaces.position), s.geometric_normal = load(surfaces.geometric_normal);
      s.error = surfaces.error[0];
      s.plain = surfaces.plain[0] != 0;
      const SurfaceDetail detail = world_.detail(rays, hits, 0, 0);
      s.frame = s.plain ? frame_from_normal(load(surfaces.shading_normal)) : detail.frame;
      s.tangent = detail.frame.tangent;
      s.bsdf = make_bsdf(world_.scene(), world_.textures(), MaterialId(surfaces.material[0]), detail.texture, 0);
      path.surfaces.push_back(s);
      const Vec3 wo = -direction;
      if (path.size() == wanted && !s.bsdf.is_delta()) return with_light_sample(path, wo, number(), {number(), number()});
      if (path.size() > 12) return std::nullopt;
      const auto sample = sample_from_eye(s, wo, number(), {number(), number()});
      if (!sample || !(sample->pdf > 0) || !(sample->pdf_reverse > 0)) return std::nullopt;
      path.events.push_back({sample->pdf, sample->pdf_reverse, sample->is_delta});
      direction = sample->direction;
      origin = offset_origin(s.position, s.geometric_normal, s.error, direction);
    }
  }

 private:
  std::optional<FullPath> with_light_sample(FullPath path, const Vec3& wo, float u_pick, const Vec2& u) const {
    const Surface& last = path.surfaces.back();
    const LightSample sample = world_.lights().sample(last.position, last.geometric_normal, u_pick, u);
    if (!(sample.pdf > 0)) return std::nullopt;
    const ScatterEval eval = evaluate_scatter(last, wo, sample.wi);
    if (is_black(eval.f_cos) || !(eval.pdf_light > 0) || !(eval.pdf_eye > 0)) return std::nullopt;
    path.events.push_back({eval.pdf_eye, eval.pdf_light, false});
    path.light = sample.light, path.light_point = sample.point, path.light_normal = sample.normal;
    path.to_light = sample.wi;
    path.infinite = std::isinf(sample.distance), path.delta_light = sample.is_delta;
    path.is_mesh = sample.is_mesh;
    path.findable = !sample.is_delta && (sample.is_mesh || path.infinite);
    path.direct_pdf = sample.pdf;
    return path;
  }

  const World& world_;
  const View& view_;
};

TEST(BidirectionalMis, WeightsOfAllStrategiesOfAPathAddUpToOne) {
  const Shot shot = test::shot_of(crowded_room(), {40, 30});
  const View view(shot.camera, shot.size_px, PixelFilter());
  const CameraImportance camera(view);
  PathMaker maker(shot, view);
  std::mt19937 random(1);
  int paths = 0, with_delta = 0, to_infinity = 0, delta_lights = 0, found = 0, longest = 0;
  double worst = 0, worst_weight = 0;
  while (paths < 100000) {
    const std::optional<FullPath> path = maker.make(random);
    if (!path) continue;
    ++paths;
    bool delta = false;
    for (const Event& e : path->events) delta |= e.delta;
    with_delta += delta, to_infinity += path->infinite, delta_lights += path->delta_light, found += path->findable;
    longest = std::max(longest, static_cast<int>(path->size()));
    for (const bool power : {true, false}) {
      const Heuristic h{power};
      const Strategies strategies(*path, shot.world->lights(), camera, h);
      double sum = 0, densities = 0;
      for (int s = 0; s < strategies.vertex_count(); ++s) densities += h(strategies.density(s));
      for (int s = 0; s < strategies.vertex_count(); ++s) {
        const double weight = strategies.weight(s);
        sum += weight;
        worst_weight = std::max(worst_weight, std::fabs(weight - h(strategies.density(s)) / densities));
      }
      worst = std::max(worst, std::fabs(sum - 1));
    }
  }
  EXPECT_LT(worst, 1e-5);
  EXPECT_LT(worst_weight, 1e-5);
  // The room has shown all it has.
  EXPECT_GT(with_delta, 10000);
  EXPECT_GT(to_infinity, 1000);
  EXPECT_GT(delta_lights, 1000);
  EXPECT_GT(found, 10000);
  EXPECT_LT(found, 99000);
  EXPECT_GE(longest, 6);
}

TEST(BidirectionalMis, LightsSeenDirectlyAreSharedWithTheLightImage) {
  for (const bool power : {true, false}) {
    const Heuristic h{power};
    for (const double camera_pdf : {1e-3, 1.0, 50.0}) {
      for (const double start : {1e-2, 3.0}) {
        MisVertex hit;
        hit.connect = 1;
        arrive(hit, camera_pdf, 0.5, 1, 2);
        const double by_eye = emission_weight(h, {0, start, 0}, hit, true);
        const double by_light = connection_weight(h, hit.pdf, start, 1, 0, 1, 0);
        EXPECT_NEAR(by_eye + by_light, 1, 1e-12);
        EXPECT_NEAR(by_light, h(start) / (h(start) + h(camera_pdf * 0.25)), 1e-12);
        // Without a light image the eye has it all.
        hit.connect = 0;
        EXPECT_EQ(emission_weight(h, {0, start, 0}, hit, true), 1);
      }
    }
  }
}

}  // namespace
}  // namespace sightline::bidirectional
