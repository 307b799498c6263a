#include "world/world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "unit/trace/trace_scenes.h"

namespace sightline {
namespace {

using namespace test;
using glm::dvec3;
using glm::dvec4;

std::shared_ptr<const World> build(Scene scene, WorldOptions options = {}) {
  const Context context;
  return World::build(std::move(scene), options, context);
}

Vec3 at(const Vec3Batch& batch, std::size_t i) { return {batch.x[i], batch.y[i], batch.z[i]}; }

struct Traced {
  RayBatch rays;
  HitBatch hits;
  SurfaceBatch surfaces;
};

Traced trace(const World& world, const RayBatch& rays) {
  Traced result{rays, {}, {}};
  RayCounts counts;
  world.tracer().intersect(rays, result.hits, BatchKind::bounce, counts);
  world.surfaces(rays, result.hits, result.surfaces);
  return result;
}

// The hit point in double precision, from the scene as given.
dvec3 exact_point(const World& world, const HitBatch& hits, std::size_t i) {
  const Instance& instance = world.scene().instances[hits.instance[i]];
  const PlacedMesh& placed = world.tracer().placement().instances[hits.instance[i]];
  const UVec3 t = world.scene().meshes[instance.mesh.index].triangles[hits.primitive[i]];
  const double u = hits.u[i], v = hits.v[i];
  const dvec3 p = (1 - u - v) * dvec3(placed.positions[t.x]) + u * dvec3(placed.positions[t.y]) + v * dvec3(placed.positions[t.z]);
  return dvec3(glm::dmat4(placed.world_from_positions()) * dvec4(p, 1));
}

// Distance of a reconstructed hit from the plane of its triangle, and the sum of the normal's components that bounds it per component.
double distance_from_plane(const World& world, const HitBatch& hits, const Vec3& position, std::size_t i) {
  const Instance& instance = world.scene().instances[hits.instance[i]];
  const PlacedMesh& placed = world.tracer().placement().instances[hits.instance[i]];
  const UVec3 t = world.scene().meshes[instance.mesh.index].triangles[hits.primitive[i]];
  const auto corner = [&](std::uint32_t vertex) {
    return dvec3(glm::dmat4(placed.world_from_positions()) * dvec4(dvec3(placed.positions[vertex]), 1));
  };
  const dvec3 n = glm::normalize(glm::cross(corner(t.y) - corner(t.x), corner(t.z) - corner(t.x)));
  return std::abs(glm::dot(dvec3(position) - corner(t.x), n)) / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
}

// Random transforms: turned, stretched, mirrored, moved.
Mat4 random_transform(std::mt19937& random, float distance) {
  const Vec3 stretch = 0.2f + glm::abs(random_point(random, 2));
  Mat4 m = glm::translate(Mat4(1), random_point(random, distance));
  m = glm::rotate(m, random_point(random, 3).x, random_direction(random));
  m = glm::scale(m, random_point(random, 1).x < 0 ? -stretch : stretch);
  return glm::rotate(m, random_point(random, 3).x, random_direction(random));
}

TEST(World, ErrorBoundsHoldThePointInDoublePrecision) {
  std::mt19937 random(1);
  for (const float distance : {0.f, 10.f, 1e4f}) {
    Scene scene;
    scene.meshes.push_back(triangle_soup(random, 60, 1, 0.5f, random_point(random, 3)));
    std::vector<Vec3> centers;
    for (int k = 0; k < 12; ++k) {
      Instance instance;
      instance.mesh = MeshId(0);
      instance.world_from_object = random_transform(random, distance);
      scene.instances.push_back(instance);
      centers.push_back(transform_point(instance.world_from_object, scene.meshes[0].bounds.center()));
    }
    place(scene, triangle_soup(random, 60, 1, 0.5f), scene.instances[0].world_from_object);
    const auto world = build(scene);
    std::size_t hit_count = 0;
    double largest_share = 0;
    for (const Vec3& center : centers) {
      const Traced traced = trace(*world, random_rays(random, 800, 2, center));
      for (std::size_t i = 0; i < traced.hits.size; ++i) {
        if (!traced.hits.hit(i)) continue;
        ++hit_count;
        const dvec3 difference = glm::abs(dvec3(at(traced.surfaces.position, i)) - exact_point(*world, traced.hits, i));
        const double largest = std::max({difference.x, difference.y, difference.z});
        // Near an edge the point is moved inside on purpose, but stays as close to the plane.
        ASSERT_LE(distance_from_plane(*world, traced.hits, at(traced.surfaces.position, i), i), traced.surfaces.error[i]) << distance;
        const float u = traced.hits.u[i], v = traced.hits.v[i];
        if (std::min({u, v, 1 - u - v}) < 0.1f || distance > 1000) continue;
        ASSERT_LE(largest, traced.surfaces.error[i]) << distance;
        largest_share = std::max(largest_share, largest / traced.surfaces.error[i]);
      }
    }
    EXPECT_GT(hit_count, 500u);
    if (distance < 1000) {
      EXPECT_GT(largest_share, 0.01);  // the bound is no wild guess
    }
  }
}

TEST(World, NormalsFollowTheWindingAndMirrorsFlipIt) {
  std::mt19937 random(2);
  Scene scene;
  Mesh mesh = box_mesh(Vec3(-1), Vec3(1));
  std::vector<Vec3> outward;
  for (const Vec3& p : mesh.positions) outward.push_back(glm::normalize(p));
  mesh.normals = outward;
  scene.meshes = {mesh, mesh};
  for (int k = 0; k < 9; ++k) {
    Instance instance;
    instance.mesh = MeshId(k == 8 ? 1 : 0);  // the last is baked
    instance.world_from_object = glm::translate(Mat4(1), Vec3{20.f * static_cast<float>(k), 0, 0}) * random_transform(random, 1);
    scene.instances.push_back(instance);
  }
  const auto world = build(scene);
  for (std::size_t k = 0; k < scene.instances.size(); ++k) {
    const Mat4& m = scene.instances[k].world_from_object;
    RayBatch rays;
    rays.resize(200);
    for (std::size_t i = 0; i < rays.size; ++i) {
      rays.set(i, {.origin = transform_point(m, random_point(random, 0.5f)), .direction = random_direction(random)});
    }
    const Traced traced = trace(*world, rays);
    for (std::size_t i = 0; i < rays.size; ++i) {
      ASSERT_TRUE(traced.hits.hit(i));
      // From within a closed box every outward normal points along the ray, mirrored or not.
      const Vec3 geometric = at(traced.surfaces.geometric_normal, i), shading = at(traced.surfaces.shading_normal, i);
      EXPECT_GT(glm::dot(geometric, rays.get(i).direction), 0) << k;
      EXPECT_GE(glm::dot(geometric, shading), 0);
      EXPECT_NEAR(glm::length(geometric), 1, 1e-5f);
      EXPECT_NEAR(glm::length(shading), 1, 1e-5f);
      // Normals go with the inverse transpose.
      const UVec3 t = mesh.triangles[traced.hits.primitive[i]];
      const float u = traced.hits.u[i], v = traced.hits.v[i];
      const Vec3 n = (1 - u - v) * mesh.normals[t.x] + u * mesh.normals[t.y] + v * mesh.normals[t.z];
      const Vec3 expected = glm::normalize(glm::transpose(glm::inverse(Mat3(m))) * n);
      EXPECT_GT(std::fabs(glm::dot(expected, shading)), 0.9999f);
    }
  }
}

// Rays that start on the inside of a closed box, offset by their error bound: each must meet another wall from within, and none its own.
void expect_no_leaks(const Scene& scene, float half, const Vec3& center, const Mat4& turn = Mat4(1)) {
  std::mt19937 random(3);
  const auto world = build(scene);
  RayBatch rays;
  rays.resize(4096);
  std::size_t own = 0, outside = 0, traced_count = 0;
  for (std::size_t i = 0; i < rays.size; ++i) {
    rays.set(i, {.origin = center + Mat3(turn) * random_point(random, 0.9f * half), .direction = random_direction(random)});
  }
  for (int bounce = 0; bounce < 6; ++bounce) {
    const Traced traced = trace(*world, rays);
    RayBatch next = rays;
    std::vector<bool> leaves(rays.size);
    for (std::size_t i = 0; i < rays.size; ++i) {
      if (!traced.hits.hit(i)) {
        ++outside;
        next.set(i, {.origin = center, .direction = random_direction(random)});
        continue;
      }
      const Vec3 normal = at(traced.surfaces.geometric_normal, i);
      outside += glm::dot(normal, rays.get(i).direction) <= 0;  // came through the wall from behind
      Vec3 local = glm::abs(glm::transpose(Mat3(turn)) * (at(traced.surfaces.position, i) - center));
      std::sort(&local.x, &local.x + 3);
      if (half - local.y < 8 * traced.surfaces.error[i]) {
        // As near to two walls as its error bound, a point may lie behind one of them: no ray starts from there.
        next.set(i, {.origin = center, .direction = random_direction(random)});
        continue;
      }
      leaves[i] = true;
      // Half of the rays graze the wall they leave.
      Vec3 direction = random_direction(random);
      if (i % 2) direction -= 0.9999f * glm::dot(direction, normal) * normal;
      if (glm::dot(direction, normal) > 0) direction = -direction;
      next.set(i, {.origin = offset_origin(at(traced.surfaces.position, i), normal, traced.surfaces.error[i], direction),
                   .direction = direction});
    }
    RayCounts counts;
    HitBatch hits;
    world->tracer().intersect(next, hits, BatchKind::primary, counts);
    for (std::size_t i = 0; i < rays.size; ++i) {
      own += leaves[i] && hits.instance[i] == traced.hits.instance[i] && hits.primitive[i] == traced.hits.primitive[i];
    }
    traced_count += rays.size;
    rays = next;
  }
  EXPECT_EQ(own, 0u) << "of " << traced_count;
  EXPECT_EQ(outside, 0u) << "of " << traced_count;
}

TEST(World, ClosedBoxesLeakAtNoScale) {
  for (const float scale : {1e-3f, 1.f, 1e4f, 1e7f}) {
    SCOPED_TRACE(scale);
    expect_no_leaks(scene_of(box_mesh(Vec3(-scale), Vec3(scale))), scale, Vec3(0));
    const Mat4 turn = glm::rotate(Mat4(1), 0.4f, Vec3{1, 2, 3});
    expect_no_leaks(scene_of(box_mesh(Vec3(-scale), Vec3(scale)), turn), scale, Vec3(0), turn);
  }
}

TEST(World, ClosedBoxesLeakNowhereFarFromTheOrigin) {
  const Vec3 center{1e4f, -1e4f, 1e4f};
  expect_no_leaks(scene_of(box_mesh(center - 1.f, center + 1.f)), 1, center);
  for (const Mat4& turn : {Mat4(1), glm::rotate(Mat4(1), 0.4f, Vec3{1, 2, 3}), glm::scale(Mat4(1), Vec3{1, -1, 1})}) {
    Scene scene = scene_of(box_mesh(Vec3(-1), Vec3(1)), glm::translate(Mat4(1), center) * turn);
    expect_no_leaks(scene, 1, center, turn);
    // The same box behind an instance transform: a second one stands elsewhere.
    scene.instances.push_back(scene.instances[0]);
    scene.instances[1].world_from_object = glm::translate(Mat4(1), -center);
    expect_no_leaks(scene, 1, center, turn);
  }
}

TEST(World, RaysLeaveSpheresCleanly) {
  std::mt19937 random(4);
  for (const float radius : {1e-3f, 1.f, 1e4f}) {
    for (const Vec3& center : {Vec3(0), Vec3{10.f * radius, -3.f * radius, 5.f * radius}}) {
      Scene scene;
      Sphere sphere;
      sphere.center = center;
      sphere.radius = radius;
      scene.spheres.push_back(sphere);
      const auto world = build(scene);
      const Traced traced = trace(*world, [&] {
        RayBatch rays;
        rays.resize(4096);
        for (std::size_t i = 0; i < rays.size; ++i) {
          const Vec3 origin = center + 3 * radius * random_direction(random);
          rays.set(i, {.origin = origin, .direction = center + 0.99f * radius * random_direction(random) - origin});
        }
        return rays;
      }());
      RayBatch next = traced.rays;
      for (std::size_t i = 0; i < next.size; ++i) {
        ASSERT_TRUE(traced.hits.hit(i));
        const Vec3 normal = at(traced.surfaces.geometric_normal, i), position = at(traced.surfaces.position, i);
        EXPECT_LE(std::fabs(glm::length(dvec3(position) - dvec3(center)) - radius), traced.surfaces.error[i]);
        EXPECT_LT(glm::dot(normal, traced.rays.get(i).direction), 0);
        Vec3 direction = random_direction(random);
        if (i % 2) direction -= 0.999f * glm::dot(direction, normal) * normal;
        if (glm::dot(direction, normal) < 0) direction = -direction;
        next.set(i, {.origin = offset_origin(position, normal, traced.surfaces.error[i], direction), .direction = direction});
      }
      std::vector<std::uint8_t> occluded(padded(next.size));
      RayCounts counts;
      world->tracer().occluded(next, occluded, BatchKind::shadow_diffuse, counts);
      std::size_t own = 0;
      for (std::size_t i = 0; i < next.size; ++i) own += occluded[i];
      EXPECT_EQ(own, 0u) << radius;
    }
  }
}

// A scene with a static part, shared meshes and a sphere.
Scene mixed_scene() {
  std::mt19937 random(5);
  Scene scene;
  scene.materials.resize(2);
  scene.materials[1].model = DiffuseMaterial{Color{0.2f, 0.3f, 0.4f}};
  for (int k = 0; k < 3; ++k) place(scene, triangle_soup(random, 80, 1, 0.3f));
  Instance instance = scene.instances[2];
  instance.world_from_object = glm::translate(Mat4(1), Vec3{0, 0.5f, 0});
  scene.instances.push_back(instance);
  scene.spheres.emplace_back();
  scene.spheres[0].radius = 0.4f;
  return scene;
}

void expect_same_picture(const World& a, const World& b) {
  std::mt19937 random(6);
  const RayBatch rays = random_rays(random, 3000, 1);
  const Traced x = trace(a, rays), y = trace(b, rays);
  int different = 0;
  for (std::size_t i = 0; i < rays.size; ++i) {
    different += x.hits.instance[i] != y.hits.instance[i] || (x.hits.hit(i) && std::fabs(x.hits.t[i] - y.hits.t[i]) > 1e-4f) ||
                 x.surfaces.material[i] != y.surfaces.material[i] ||
                 glm::length(at(x.surfaces.position, i) - at(y.surfaces.position, i)) > 1e-4f;
  }
  EXPECT_LE(different, 2);
}

TEST(WorldEdit, MaterialEditsBuildNoGeometry) {
  Scene scene = mixed_scene();
  const auto first = build(scene);
  EXPECT_EQ(first->tracer().statistics().static_scenes_built, 1u);
  EXPECT_EQ(first->tracer().statistics().mesh_scenes_built, 1u);
  scene.instances[0].material_override = MaterialId(1);
  const Context context;
  const auto second = World::edit(*first, scene, context);
  EXPECT_EQ(second->tracer().statistics().static_scenes_built, 0u);
  EXPECT_EQ(second->tracer().statistics().mesh_scenes_built, 0u);
  EXPECT_EQ(&second->textures(), &first->textures());
  EXPECT_EQ(&second->lights(), &first->lights());
  expect_same_picture(*second, *build(scene));
}

TEST(WorldEdit, MovingAStaticMeshPromotesItOnce) {
  Scene scene = mixed_scene();
  const auto first = build(scene);
  const Context context;
  scene.instances[1].world_from_object = glm::rotate(Mat4(1), 0.5f, Vec3{0, 1, 0});
  const auto second = World::edit(*first, scene, context);
  EXPECT_EQ(second->tracer().statistics().static_scenes_built, 1u);
  EXPECT_EQ(second->tracer().statistics().mesh_scenes_built, 1u);
  EXPECT_EQ(second->tracer().statistics().mesh_scenes_shared, 1u);
  expect_same_picture(*second, *build(scene));
  // From now on it moves for the price of the top level; back at its old place it stays an instance.
  for (const float angle : {1.f, 0.f}) {
    scene.instances[1].world_from_object = glm::rotate(Mat4(1), angle, Vec3{0, 1, 0});
    const auto third = World::edit(*second, scene, context);
    EXPECT_EQ(third->tracer().statistics().static_scenes_built, 0u);
    EXPECT_EQ(third->tracer().statistics().mesh_scenes_built, 0u);
    EXPECT_EQ(third->tracer().statistics().mesh_scenes_shared, 2u);
    expect_same_picture(*third, *build(scene));
  }
  // The first World is as it was.
  expect_same_picture(*first, *build(mixed_scene()));
}

TEST(WorldEdit, ShadowsChangeWithSurfacesAndLightsAlone) {
  Scene scene = mixed_scene();
  scene.lights.push_back({.name = "lamp", .shape = PointLight{}, .node = {}});
  const auto first = build(scene);
  EXPECT_NE(build(scene)->shadows(), first->shadows());
  const Context context;
  const auto kept_by = [&](auto change) {
    Scene changed = scene;
    change(changed);
    return World::edit(*first, std::move(changed), context)->shadows() == first->shadows();
  };
  EXPECT_TRUE(kept_by([](Scene&) {}));
  EXPECT_TRUE(kept_by([](Scene& s) { s.cameras.emplace_back(); }));
  EXPECT_FALSE(kept_by([](Scene& s) { s.instances[1].world_from_object[3].x += 1; }));
  EXPECT_FALSE(kept_by([](Scene& s) { s.instances.pop_back(); }));
  EXPECT_FALSE(
      kept_by([](Scene& s) { s.meshes[0].positions = std::vector<Vec3>(s.meshes[0].positions.begin(), s.meshes[0].positions.end()); }));
  EXPECT_FALSE(kept_by([](Scene& s) { std::get<PointLight>(s.lights[0].shape).position.x += 1; }));
  EXPECT_FALSE(kept_by([](Scene& s) { s.lights.clear(); }));
  EXPECT_FALSE(kept_by([](Scene& s) { s.materials.at(0).alpha_mode = AlphaMode::mask; }));
}

TEST(WorldEdit, BentMeshesRebuildThemselvesAlone) {
  Scene scene = mixed_scene();
  // A target that lifts the first mesh by 1, with a weight that goes from 0 to 1 within a second.
  auto deformation = std::make_shared<Deformation>();
  deformation->positions = scene.meshes[0].positions;
  deformation->targets.resize(1);
  deformation->targets[0].positions = std::vector<Vec3>(scene.meshes[0].positions.size(), Vec3{0, 1, 0});
  scene.meshes[0].deformation = deformation;
  scene.meshes[0].weights_node = NodeId(0);
  scene.nodes.resize(1);
  scene.nodes[0].weights = {0};
  scene.nodes[0].weights_track = {.interpolation = Interpolation::linear, .times_s = {0, 1}, .values = {0, 1}};
  const Context context;
  std::shared_ptr<const World> world = build(pose(scene, 0));
  for (const float time_s : {0.25f, 0.5f}) {
    world = World::edit(*world, pose(scene, time_s), context);
    EXPECT_EQ(world->tracer().statistics().static_scenes_built, 0u);
    EXPECT_EQ(world->tracer().statistics().mesh_scenes_built, 1u);
    expect_same_picture(*world, *build(pose(scene, time_s)));
    Scene lifted = mixed_scene();
    lifted.instances[0].world_from_object = glm::translate(Mat4(1), Vec3{0, time_s, 0}) * lifted.instances[0].world_from_object;
    expect_same_picture(*world, *build(lifted));
  }
}

TEST(WorldEdit, TurnedEnvironmentsLeaveGeometryAndTexturesAlone) {
  Scene scene = mixed_scene();
  scene.environment = Environment{};
  scene.environment->image = std::make_shared<const Image>(
      Image{8, 4, 1, Image::Floats{1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3, 4, 5}});
  const auto first = build(scene);
  const Context context;
  scene.environment->world_from_environment = Mat3(glm::rotate(Mat4(1), 0.5f, Vec3{0, 1, 0}));
  const auto second = World::edit(*first, scene, context);
  EXPECT_EQ(second->tracer().statistics().static_scenes_built, 0u);
  EXPECT_EQ(second->tracer().statistics().mesh_scenes_built, 0u);
  EXPECT_EQ(&second->textures(), &first->textures());
  EXPECT_NE(&second->lights(), &first->lights());
  // Samplers that were taken over are those of a World built anew.
  const auto anew = build(scene);
  for (int i = 0; i < 32; ++i) {
    const Vec3 d = glm::normalize(Vec3(std::sin(static_cast<float>(i)), std::cos(2.f * static_cast<float>(i)), 0.3f));
    EXPECT_EQ(second->lights().environment(d), anew->lights().environment(d));
    EXPECT_EQ(second->lights().environment_density(d), anew->lights().environment_density(d));
  }
}

TEST(WorldEdit, MeshesAndSpheresComeAndGo) {
  Scene scene = mixed_scene();
  auto world = build(scene);
  const Context context;
  std::mt19937 random(7);
  place(scene, triangle_soup(random, 50, 1, 0.3f));
  scene.spheres[0].center = {0.3f, 0, 0};
  auto next = World::edit(*world, scene, context);
  EXPECT_EQ(next->tracer().statistics().static_scenes_built, 0u);
  EXPECT_EQ(next->tracer().statistics().mesh_scenes_built, 1u);
  expect_same_picture(*next, *build(scene));
  world.reset();  // what is shared outlives the World that built it
  scene.instances.erase(scene.instances.begin());
  scene.spheres.clear();
  world = World::edit(*next, scene, context);
  next.reset();
  EXPECT_EQ(world->tracer().statistics().static_scenes_built, 1u);
  expect_same_picture(*world, *build(scene));
  scene.instances.clear();
  EXPECT_FALSE(trace(*World::edit(*world, scene, context), random_rays(random, 16, 1)).hits.hit(0));
}

TEST(WorldEdit, AlphaMasksSwitchedOnRebuildOnlyWhatHasThem) {
  Scene scene = mixed_scene();
  const auto first = build(scene);
  scene.materials[0].alpha_mode = AlphaMode::mask;
  scene.materials[0].alpha = 0.f;
  scene.meshes[2].materials = {MaterialId(0)};
  const Context context;
  const auto second = World::edit(*first, scene, context);
  EXPECT_EQ(second->tracer().statistics().static_scenes_built, 0u);
  EXPECT_EQ(second->tracer().statistics().mesh_scenes_built, 1u);
  expect_same_picture(*second, *build(scene));
  scene.materials[0].alpha_mode = AlphaMode::opaque;
  const auto third = World::edit(*second, scene, context);
  EXPECT_EQ(third->tracer().statistics().mesh_scenes_built, 0u);
  expect_same_picture(*third, *build(scene));
}

TEST(World, MaterialsComeFromPaletteOverrideAndDefault) {
  Scene scene;
  scene.materials.resize(3);
  scene.materials[0].model = DiffuseMaterial{Color{2, 0.5f, -1}};
  scene.materials[1].model = ConductorMaterial{};
  DiffuseMaterial textured;
  textured.reflectance.texture = TextureId(0);
  scene.textures.push_back({"white", ConstantTexture{}});
  scene.materials[2].model = textured;
  Mesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  Mesh with_palette = mesh;
  with_palette.materials = {MaterialId(1), MaterialId(0)};
  with_palette.triangle_materials = std::vector<std::uint16_t>{1, 0};
  place(scene, with_palette);
  place(scene, mesh, glm::translate(Mat4(1), Vec3{2, 0, 0}));
  place(scene, with_palette, glm::translate(Mat4(1), Vec3{4, 0, 0}));
  scene.instances[2].material_override = MaterialId(2);
  RayBatch rays;
  rays.resize(5);
  for (int i = 0; i < 5; ++i) {
    const Vec3 points[] = {{0.8f, 0.2f, 1}, {0.2f, 0.8f, 1}, {2.5f, 0.2f, 1}, {4.5f, 0.2f, 1}, {9, 9, 1}};
    rays.set(static_cast<std::size_t>(i), {.origin = points[i], .direction = {0, 0, -1}});
  }
  for (const auto backend : {WorldOptions::Backend::embree, WorldOptions::Backend::brute}) {
    WorldOptions options;
    options.backend = backend;
    const auto world = build(scene, options);
    const Traced traced = trace(*world, rays);
    const std::uint32_t materials[] = {0, 1, kDefaultMaterial, 2, kNoHit};
    const int plain[] = {1, 0, 1, 0, 0};
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_EQ(traced.surfaces.material[i], materials[i]) << i;
      EXPECT_EQ(traced.surfaces.plain[i], plain[i]) << i;
      EXPECT_EQ(traced.surfaces.light[i], kNoLight);
    }
    EXPECT_EQ(at(traced.surfaces.albedo, 0), (Vec3{1, 0.5f, 0}));
    EXPECT_EQ(at(traced.surfaces.albedo, 2), Vec3(0.7f));
    EXPECT_EQ(at(traced.surfaces.position, 4), Vec3(0));
  }
}

TEST(World, EmissiveTrianglesNameTheirLight) {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[1].emission = 3.f;
  Mesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  mesh.materials = {MaterialId(0), MaterialId(1)};
  mesh.triangle_materials = std::vector<std::uint16_t>{0, 1};
  place(scene, mesh);
  scene.spheres.emplace_back();
  scene.spheres[0].center = {5, 0, 0};
  scene.spheres[0].material = MaterialId(1);
  const auto world = build(scene);
  RayBatch rays;
  rays.resize(3);
  rays.set(0, {.origin = {0.8f, 0.2f, 1}, .direction = {0, 0, -1}});
  rays.set(1, {.origin = {0.2f, 0.8f, 1}, .direction = {0, 0, -1}});
  rays.set(2, {.origin = {5, 0, 3}, .direction = {0, 0, -1}});
  const Traced traced = trace(*world, rays);
  EXPECT_EQ(traced.surfaces.light[0], kNoLight);
  EXPECT_EQ(traced.surfaces.light[1], world->lights().light_of(0, 1));
  EXPECT_EQ(traced.surfaces.light[2], world->lights().light_of(kSphereBit, 0));
  EXPECT_NE(traced.surfaces.light[1], kNoLight);
  EXPECT_NE(traced.surfaces.light[2], kNoLight);
}

TEST(WorldDetail, DerivativesMatchFiniteDifferences) {
  std::mt19937 random(8);
  Scene scene;
  Mesh mesh = triangle_soup(random, 40, 1, 0.6f);
  mesh.uvs = SharedArray<Vec2>::make(mesh.positions.size(), [&](std::span<Vec2> uvs) {
    for (Vec2& uv : uvs) uv = Vec2(random_point(random, 1));
  });
  place(scene, mesh, random_transform(random, 1));
  const auto world = build(scene);
  const Traced traced = trace(*world, random_rays(random, 2000, 2));
  int checked = 0;
  for (std::size_t i = 0; i < traced.hits.size; ++i) {
    if (!traced.hits.hit(i)) continue;
    ++checked;
    const SurfaceDetail detail = world->detail(traced.rays, traced.hits, i, 0.01f);
    const UVec3 t = mesh.triangles[traced.hits.primitive[i]];
    const auto& p = world->tracer().placement().instances[0].positions;
    // Along any edge, the change of position is what the derivatives say for the change of uv.
    const Vec3 edge = p[t.y] - p[t.x];
    const Vec2 duv = mesh.uvs[t.y] - mesh.uvs[t.x];
    EXPECT_LT(glm::length(detail.dp_du * duv.x + detail.dp_dv * duv.y - edge), 2e-3f * glm::length(edge) + 1e-4f);
    // The footprint in uv, carried back to the surface, is the cone's: across the ray as wide as the cone, along it no narrower.
    const Vec3 dx = detail.dp_du * detail.texture.duv_dx.x + detail.dp_dv * detail.texture.duv_dx.y;
    const Vec3 dy = detail.dp_du * detail.texture.duv_dy.x + detail.dp_dv * detail.texture.duv_dy.y;
    EXPECT_NEAR(glm::length(dy), 0.01f, 1e-4f);
    EXPECT_GT(glm::length(dx), 0.0099f);
    EXPECT_NEAR(glm::dot(detail.frame.tangent, detail.frame.normal), 0, 1e-5f);
  }
  EXPECT_GT(checked, 100);
}

TEST(WorldDetail, SpheresAreParametrisedByLongitudeAndLatitude) {
  Scene scene;
  Sphere sphere;
  sphere.center = {1, 2, 3};
  sphere.radius = 2;
  scene.spheres.push_back(sphere);
  const auto world = build(scene);
  std::mt19937 random(9);
  RayBatch rays;
  rays.resize(500);
  for (std::size_t i = 0; i < rays.size; ++i) {
    const Vec3 d = random_direction(random);
    rays.set(i, {.origin = sphere.center + 5.f * d, .direction = -d});
  }
  const Traced traced = trace(*world, rays);
  for (std::size_t i = 0; i < rays.size; ++i) {
    ASSERT_TRUE(traced.hits.hit(i));
    const SurfaceDetail detail = world->detail(rays, traced.hits, i, 0.01f);
    const auto point = [&](const Vec2& uv) {
      const double phi = 2 * kPi * uv.x, theta = kPi * uv.y;
      return dvec3(sphere.center) + 2.0 * dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    };
    EXPECT_LT(glm::length(point(detail.uv) - dvec3(at(traced.surfaces.position, i))), 1e-4);
    const double h = 1e-4;
    const Vec2 du{static_cast<float>(h), 0}, dv{0, static_cast<float>(h)};
    EXPECT_LT(glm::length((point(detail.uv + du) - point(detail.uv)) / h - dvec3(detail.dp_du)), 0.05);
    EXPECT_LT(glm::length((point(detail.uv + dv) - point(detail.uv)) / h - dvec3(detail.dp_dv)), 0.05);
  }
}

TEST(World, TerminatorOffsetsLiftConvexPatchesOnly) {
  const std::array<Vec3, 3> vertices{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  const Vec3 b{0.3f, 0.4f, 0.3f}, up{0, 0, 1};
  EXPECT_EQ(terminator_offset(vertices, {{up, up, up}}, b), Vec3(0));
  const Vec3 center{1 / 3.f, 1 / 3.f, -0.5f};
  std::array<Vec3, 3> convex, concave;
  for (int i = 0; i < 3; ++i) {
    convex[i] = glm::normalize(vertices[i] - center);
    concave[i] = glm::normalize(vertices[i] - Vec3{1 / 3.f, 1 / 3.f, 0.5f}) * -1.f;
  }
  EXPECT_GT(terminator_offset(vertices, convex, b).z, 0.05f);
  EXPECT_EQ(terminator_offset(vertices, concave, b), Vec3(0));

  Mesh mesh = make_mesh({vertices.begin(), vertices.end()}, {{0, 1, 2}});
  mesh.normals = std::vector<Vec3>(convex.begin(), convex.end());
  RayBatch rays;
  rays.resize(2);
  rays.set(0, {.origin = {0.3f, 0.3f, 1}, .direction = {0, 0, -1}});
  rays.set(1, {.origin = {0.3f, 0.3f, -1}, .direction = {0, 0, 1}});
  EXPECT_TRUE(trace(*build(scene_of(mesh)), rays).surfaces.shadow_offset.x.empty());
  WorldOptions options;
  options.shadow_terminator = true;
  const Traced traced = trace(*build(scene_of(mesh), options), rays);
  EXPECT_GT(at(traced.surfaces.shadow_offset, 0).z, 0.05f);
  EXPECT_EQ(at(traced.surfaces.shadow_offset, 1), Vec3(0));  // seen from within the patch is hollow
}

TEST(World, InstancesWithoutAMeshAreRefused) {
  Scene scene;
  scene.instances.emplace_back();
  EXPECT_ANY_THROW(build(scene));
}

}  // namespace
}  // namespace sightline
