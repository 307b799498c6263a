#include "vpl_scenes.h"

#include <cmath>
#include <limits>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "base/sample/warp.h"
#include "methods/visibility_cache/surface_point.h"
#include "scene/builtin/parts.h"

namespace sightline::test {
namespace {

using builtin::MeshBuilder;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Room finish(std::string name, Scene scene, const Vec3& eye, const Vec3& target, float fov) {
  builtin::add_camera(scene, eye, target, fov);
  const Camera camera = scene.cameras.at(0);
  return {std::move(name), World::build(std::move(scene), {}, Context()), camera};
}

void add_wall(Scene& scene, const Vec3& origin, const Vec3& u, const Vec3& v, const Color& reflectance) {
  builtin::add_mesh(scene, MeshBuilder().quad(origin, u, v).build("wall"), builtin::add_diffuse(scene, "wall", reflectance));
}

/// Walls of [-1, 1]³ that face inward, the one at +x left out.
void add_walls(Scene& scene, bool coloured, float white) {
  const auto color = [&](const Color& c) { return coloured ? c : Color(white); };
  add_wall(scene, {-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, color(Color(0.7f, 0.6f, 0.5f)));  // floor
  add_wall(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, color(Color(0.8f)));               // ceiling
  add_wall(scene, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, color(Color(0.6f, 0.7f, 0.8f)));  // back
  add_wall(scene, {1, -1, 1}, {-2, 0, 0}, {0, 2, 0}, color(Color(0.5f)));               // front
  add_wall(scene, {-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, color(Color(0.8f, 0.2f, 0.1f)));  // left
}

/// The wall at +x, with a hole of half the height and `width`.
void add_window_wall(Scene& scene, float width) {
  const Color grey(0.4f, 0.6f, 0.4f);
  const float h = width / 2;
  add_wall(scene, {1, -1, -1}, {0, 0, 2}, {0, 0.5f, 0}, grey);
  add_wall(scene, {1, 0.5f, -1}, {0, 0, 2}, {0, 0.5f, 0}, grey);
  add_wall(scene, {1, -0.5f, -1}, {0, 0, 1 - h}, {0, 1, 0}, grey);
  add_wall(scene, {1, -0.5f, h}, {0, 0, 1 - h}, {0, 1, 0}, grey);
}

}  // namespace

Room make_room(RoomLight light) {
  Scene scene;
  add_walls(scene, true, 0);
  const bool window = light == RoomLight::directional || light == RoomLight::environment;
  if (window)
    add_window_wall(scene, 1.2f);
  else
    add_wall(scene, {1, -1, -1}, {0, 0, 2}, {0, 2, 0}, Color(0.1f, 0.7f, 0.2f));
  builtin::add_mesh(scene, MeshBuilder().box({-0.4f, -0.6f, -0.3f}, {0.25f, 0.4f, 0.25f}, 0.4f).build("block"),
                    builtin::add_diffuse(scene, "block", Color(0.6f)));
  std::string name;
  switch (light) {
    case RoomLight::area:
      name = "area";
      builtin::add_mesh(scene, MeshBuilder().quad({-0.3f, 0.9f, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}).build("light"),
                        builtin::add_emitter(scene, "light", Color(8, 7, 6)));
      break;
    case RoomLight::point:
      name = "point";
      scene.lights.push_back({.name = "point", .shape = PointLight{{0.3f, 0.5f, 0.2f}, Color(1, 2, 3)}, .node = {}});
      break;
    case RoomLight::directional:
      name = "directional";
      scene.lights.push_back(
          {.name = "sun", .shape = DirectionalLight{normalize_or(Vec3(-1, -0.5f, 0.2f), Vec3(0)), Color(5, 4, 3)}, .node = {}});
      break;
    case RoomLight::environment:
      name = "environment";
      scene.environment = Environment{};
      scene.environment->scale = Color(1, 2, 3);
      break;
  }
  return finish(std::move(name), std::move(scene), {0.8f, 0.3f, 0.8f}, {-0.5f, -0.3f, -0.5f}, 100);
}

Room make_closed_box(float reflectance, const Color& radiance, float light_size) {
  Scene scene;
  add_walls(scene, false, reflectance);
  add_wall(scene, {1, -1, -1}, {0, 0, 2}, {0, 2, 0}, Color(reflectance));
  const float h = light_size / 2;
  builtin::add_mesh(scene, MeshBuilder().quad({-h, 0.999f, -h}, {light_size, 0, 0}, {0, 0, light_size}).build("light"),
                    builtin::add_emitter(scene, "light", radiance));
  return finish("closed", std::move(scene), {0.8f, 0.3f, 0.8f}, {-0.5f, -0.3f, -0.5f}, 100);
}

Room make_slit_room() {
  Scene scene;
  add_walls(scene, true, 0);
  add_window_wall(scene, 0.1f);
  add_wall(scene, {-20, -1.1f, 20}, {40, 0, 0}, {0, 0, -40}, Color(0.5f));
  scene.lights.push_back(
      {.name = "sun", .shape = DirectionalLight{normalize_or(Vec3(-1, -0.5f, 0.2f), Vec3(0)), Color(5, 4, 3)}, .node = {}});
  return finish("slit", std::move(scene), {0.8f, 0.3f, 0.8f}, {-0.5f, -0.3f, -0.5f}, 100);
}

Room make_room_of(const SurfaceModel& model) {
  Scene scene;
  add_walls(scene, true, 0);
  add_wall(scene, {1, -1, -1}, {0, 0, 2}, {0, 2, 0}, Color(0.3f));
  const MaterialId material = builtin::add_material(scene, "model", model);
  builtin::add_sphere(scene, "ball", {-0.4f, -0.5f, -0.3f}, 0.4f, material);
  // A sheet whose vertex normals lean outward.
  Mesh sheet = MeshBuilder().quad({0.3f, -0.8f, 0.5f}, {0.5f, 0, -0.5f}, {0, 1, 0}).build("sheet");
  const Vec3 n = normalize_or(Vec3(1, 0, 1), Vec3(0)), t = normalize_or(Vec3(1, 0, -1), Vec3(0));
  std::vector<Vec3> normals;
  for (const Vec3& p : sheet.positions.span()) normals.push_back(normalize_or(n + 0.5f * (p.y > 0 ? 1.f : -1.f) * t, n));
  sheet.normals = SharedArray<Vec3>(normals);
  builtin::add_mesh(scene, std::move(sheet), material);
  scene.lights.push_back({.name = "point", .shape = PointLight{{0.1f, 0.6f, 0.2f}, Color(1, 2, 3)}, .node = {}});
  return finish("room of", std::move(scene), {0.9f, 0.7f, 0.9f}, {-0.5f, -0.4f, -0.5f}, 90);
}

Room make_mirror_room(bool mirror) {
  Scene scene;
  const Vec3 lamp(0.2f, -0.3f, 0.1f);
  const float x = -1;
  // The ceiling alone reflects.
  const MaterialId black = builtin::add_diffuse(scene, "black", Color(0));
  add_wall(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, Color(0.8f, 0.6f, 0.4f));
  builtin::add_mesh(scene, MeshBuilder().quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}).build("floor"), black);
  // Image of the lamp and a hole in place of the mirror, in a wall that is otherwise black: the same light on the ceiling.
  const float h = 0.5f;
  MeshBuilder around;
  around.quad({x, -1, -1}, {0, 0, 2}, {0, 1 - h, 0}).quad({x, h, -1}, {0, 0, 2}, {0, 1 - h, 0});
  around.quad({x, -h, -1}, {0, 0, 1 - h}, {0, 2 * h, 0}).quad({x, -h, h}, {0, 0, 1 - h}, {0, 2 * h, 0});
  builtin::add_mesh(scene, around.build("wall"), black);
  scene.lights.push_back({.name = "lamp", .shape = PointLight{lamp, Color(1)}, .node = {}});
  if (mirror) {
    MetallicRoughnessMaterial perfect;
    perfect.roughness = FloatParam{0.f};
    builtin::add_mesh(scene, MeshBuilder().quad({x, -h, h}, {0, 0, -2 * h}, {0, 2 * h, 0}).build("mirror"),
                      builtin::add_material(scene, "mirror", perfect));
  } else {
    scene.lights.push_back({.name = "image", .shape = PointLight{{2 * x - lamp.x, lamp.y, lamp.z}, Color(1)}, .node = {}});
  }
  return finish("mirror", std::move(scene), {0.8f, 0.3f, 0.8f}, {-0.5f, 0.3f, -0.5f}, 100);
}

std::vector<Receiver> receivers() { return {{{0.2f, -1, 0.3f}, {0, 1, 0}}, {{0.1f, 0.2f, -1}, {0, 0, 1}}, {{-1, 0.1f, 0.2f}, {1, 0, 0}}}; }

Mean path_traced_irradiance(const World& world, const Receiver& receiver, int max_bounces, int paths, std::uint32_t seed) {
  const vpl::SurfaceReader reader(world);
  RayBatch rays, shadow;
  HitBatch hits;
  SurfaceBatch surfaces;
  RayCounts counts;
  std::vector<Color> throughput(static_cast<std::size_t>(paths), Color(kPi)), sum(throughput.size(), Color(0)), direct(throughput.size());
  rays.resize(throughput.size());
  AlignedVector<std::uint8_t> occluded(padded(throughput.size()));
  const auto random = [&](std::size_t path, int pair) {
    return sobol_2d(hash_combine(0x12345u, seed), static_cast<std::uint32_t>(path), static_cast<std::uint32_t>(pair));
  };
  for (std::size_t i = 0; i < throughput.size(); ++i) {
    const Vec3 direction = frame_from_normal(receiver.normal).to_world(sample_cosine_hemisphere(random(i, 0)));
    rays.set(i, {offset_origin(receiver.position, receiver.normal, 1e-6f, direction), 0, direction, kInfinity});
  }
  for (int bounce = 0; bounce < max_bounces; ++bounce) {
    world.tracer().intersect(rays, hits, BatchKind::bounce, counts);
    world.surfaces(rays, hits, surfaces);
    shadow.resize(throughput.size());
    for (std::size_t i = 0; i < throughput.size(); ++i) {
      direct[i] = Color(0);
      shadow.set(i, {Vec3(0), 0, Vec3(0, 0, 1), -1});
      const Vec3 arrived = load(rays.direction, i);
      if (!hits.hit(i)) {
        rays.set(i, {Vec3(0), 0, Vec3(0, 0, 1), -1});
        continue;
      }
      const Vec3 position = load(surfaces.position, i), winding = load(surfaces.geometric_normal, i);
      const Vec3 normal = glm::dot(winding, arrived) > 0 ? -winding : winding;
      const LightSample light = world.lights().sample(position, normal, random(i, 4 * bounce + 1).x, random(i, 4 * bounce + 2));
      const float cosine = glm::dot(normal, light.wi);
      const Vec3 origin = offset_origin(position, normal, surfaces.error[i], normal);
      const bool passes = cosine < 0 && !surfaces.plain[i];
      if (light.pdf > 0 && (cosine > 0 || passes)) {
        direct[i] = throughput[i] * light.radiance / light.pdf;
        if (surfaces.plain[i])
          direct[i] *= load(surfaces.albedo, i) * (cosine * kInvPi);
        else
          direct[i] *= vpl::scattered(reader.read(rays, hits, surfaces, i, 0, 0), -arrived, light.wi);
        const Vec3 start = passes ? offset_origin(position, normal, surfaces.error[i], -normal) : origin;
        if (std::isinf(light.distance))
          shadow.set(i, {start, 0, light.wi, kInfinity});
        else
          shadow.set(i, {start, 0, offset_origin(light.point, light.normal, light.point_error, -light.wi) - start, 1});
      }
      throughput[i] *= load(surfaces.albedo, i);
      rays.set(i, {origin, 0, frame_from_normal(normal).to_world(sample_cosine_hemisphere(random(i, 4 * bounce + 3))), kInfinity});
    }
    world.tracer().occluded(shadow, occluded, BatchKind::shadow_diffuse, counts);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += occluded[i] ? Color(0) : direct[i];
  }
  Vec3d mean(0), squares(0);
  for (const Color& c : sum) mean += Vec3d(c), squares += Vec3d(c) * Vec3d(c);
  const double n = static_cast<double>(sum.size());
  mean /= n;
  return {Color(mean), Color(glm::sqrt(glm::max(squares / n - mean * mean, 0.0) / n))};
}

Color virtual_irradiance(const World& world, const Receiver& receiver, const VirtualPointLights& lights) {
  RayBatch rays;
  RayCounts counts;
  rays.resize(lights.size);
  std::vector<Color> sent(lights.size);
  for (std::size_t i = 0; i < lights.size; ++i) {
    const Vec3 position = load(lights.position, i), normal = load(lights.normal, i);
    const Vec3 towards = receiver.position - position;
    const double squared = static_cast<double>(length_squared(towards));
    const Vec3 w = towards / static_cast<float>(std::sqrt(squared));
    const float cosines = std::fabs(glm::dot(normal, w)) * std::max(0.f, -glm::dot(receiver.normal, w));
    sent[i] =
        radiance_towards(lights, i, w) * std::min(static_cast<float>(static_cast<double>(cosines) / squared), lights.max_geometry_term);
    const Vec3 origin = offset_origin(position, normal, lights.error[i], towards);
    rays.set(i, {origin, 0, offset_origin(receiver.position, receiver.normal, 1e-6f, receiver.normal) - origin, 1});
  }
  AlignedVector<std::uint8_t> occluded(padded(lights.size));
  world.tracer().occluded(rays, occluded, BatchKind::shadow_diffuse, counts);
  Color sum(0);
  for (std::size_t i = 0; i < lights.size; ++i) sum += occluded[i] ? Color(0) : sent[i];
  return sum;
}

std::vector<Mean> mean_virtual_irradiance(const Room& room, const std::vector<Receiver>& at, VirtualPointLightOptions options, int seeds) {
  const View view(room.camera, {64, 48}, PixelFilter());
  Context context;
  context.threads = 1;
  RayCounts rays;
  std::vector<Vec3d> sum(at.size(), Vec3d(0)), squares(at.size(), Vec3d(0));
  for (int s = 0; s < seeds; ++s) {
    const VirtualPointLights lights = make_virtual_point_lights(*room.world, view, options, context, rays);
    for (std::size_t k = 0; k < at.size(); ++k) {
      const Vec3d e(virtual_irradiance(*room.world, at[k], lights));
      sum[k] += e, squares[k] += e * e;
    }
    ++options.seed;
  }
  std::vector<Mean> means;
  const double n = seeds;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const Vec3d mean = sum[k] / n;
    means.push_back({Color(mean), Color(glm::sqrt(glm::max(squares[k] / n - mean * mean, 0.0) / (n - 1)))});
  }
  return means;
}

}  // namespace sightline::test
