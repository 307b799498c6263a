#include "trace/tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "base/core/error.h"
#include "texture/texture_set.h"
#include "trace/embree/embree_tracer.h"
#include "trace/embree/packets.h"
#include "trace/sphere.h"
#include "unit/trace/trace_scenes.h"

namespace sightline {
namespace {

using namespace test;

constexpr BatchKind kKinds[] = {BatchKind::primary, BatchKind::shadow, BatchKind::shadow_diffuse, BatchKind::bounce};

// Both tracers on the same rays, for every kind of batch. Where two surfaces are hit at the same t up to rounding, either is right.
// `allowed` rays may differ otherwise: those that pass within rounding of a silhouette.
void expect_equal_to_brute(const Scene& scene, const RayBatch& rays, int allowed, float tolerance = 1e-4f) {
  const Context context;
  const TextureSet textures(scene, context);
  const auto brute = make_brute_tracer(scene, textures, {}, context);
  const auto embree = make_embree_tracer(scene, textures, {}, context);
  RayCounts counts;
  HitBatch truth, hits;
  brute->intersect(rays, truth, BatchKind::primary, counts);
  std::size_t truth_hits = 0;
  for (std::size_t i = 0; i < rays.size; ++i) truth_hits += truth.hit(i);
  for (const BatchKind kind : kKinds) {
    embree->intersect(rays, hits, kind, counts);
    std::vector<std::uint8_t> occluded(padded(rays.size), 7);
    embree->occluded(rays, occluded, kind, counts);
    int different = 0, occlusion_different = 0;
    for (std::size_t i = 0; i < rays.size; ++i) {
      const bool same_t = hits.hit(i) && std::fabs(hits.t[i] - truth.t[i]) <= tolerance * (1 + std::fabs(truth.t[i]));
      different += truth.hit(i) != hits.hit(i) || (hits.hit(i) && !same_t);
      occlusion_different += occluded[i] != (truth.hit(i) ? 1 : 0);
      if (same_t && truth.hit(i) && (hits.instance[i] != truth.instance[i] || hits.primitive[i] != truth.primitive[i])) continue;
      if (same_t && truth.hit(i) && !(hits.instance[i] & kSphereBit)) {
        EXPECT_LT(hits.u[i], 1.001f);
        EXPECT_LT(hits.v[i], 1.001f);
      }
    }
    EXPECT_LE(different, allowed) << "kind " << static_cast<int>(kind) << ", hits " << truth_hits << " of " << rays.size;
    EXPECT_LE(occlusion_different, allowed) << "kind " << static_cast<int>(kind);
  }
}

TEST(Tracer, EmbreeEqualsBruteForceOnRandomTriangles) {
  std::mt19937 random(1);
  const Scene scene = scene_of(triangle_soup(random, 300, 1, 0.4f));
  expect_equal_to_brute(scene, random_rays(random, 4000, 1), 2);
}

// The class of a scene only decides how rays are handed over.
TEST(Tracer, OcclusionIsTheSameHoweverFineTheGeometryIsSaidToBe) {
  std::mt19937 random(8);
  const Scene scene = scene_of(triangle_soup(random, 300, 1, 0.4f));
  const RayBatch rays = random_rays(random, 3001, 1);
  const Context context;
  const TextureSet textures(scene, context);
  const auto tracer = make_embree_tracer(scene, textures, {}, context);
  EmbreeScenes scenes = *embree_scenes(*tracer);
  RayCounts counts;
  HitBatch truth;
  make_brute_tracer(scene, textures, {}, context)->intersect(rays, truth, BatchKind::primary, counts);
  for (const std::uint64_t triangles : {std::uint64_t{1000}, std::uint64_t{500'000}, std::uint64_t{5'000'000}}) {
    scenes.detail = geometry_detail(triangles);
    for (const BatchKind kind : kKinds) {
      std::vector<std::uint8_t> occluded(padded(rays.size), 7);
      occluded_batch(scenes, rays, occluded, occluded_style(kind, scenes, 16));
      int different = 0;
      for (std::size_t i = 0; i < rays.size; ++i) different += occluded[i] != (truth.hit(i) ? 1 : 0);
      EXPECT_LE(different, 2) << triangles << " triangles, kind " << static_cast<int>(kind);
    }
  }
}

TEST(Tracer, HitsNameTheSameTriangleAwayFromTies) {
  std::mt19937 random(2);
  Scene scene = scene_of(triangle_soup(random, 200, 1, 0.4f));
  place(scene, triangle_soup(random, 200, 1, 0.3f), glm::translate(Mat4(1), Vec3{0.2f, 0, 0}));
  const RayBatch rays = random_rays(random, 3000, 1);
  const Context context;
  const TextureSet textures(scene, context);
  RayCounts counts;
  HitBatch truth, hits;
  make_brute_tracer(scene, textures, {}, context)->intersect(rays, truth, BatchKind::bounce, counts);
  const auto embree = make_embree_tracer(scene, textures, {}, context);
  int named = 0, second = 0;
  for (const BatchKind kind : kKinds) {
    embree->intersect(rays, hits, kind, counts);
    int different = 0;
    for (std::size_t i = 0; i < rays.size; ++i) {
      different += hits.instance[i] != truth.instance[i] || (hits.hit(i) && hits.primitive[i] != truth.primitive[i]);
      named += hits.hit(i);
      second += hits.instance[i] == 1;
      if (hits.hit(i) && hits.primitive[i] == truth.primitive[i]) {
        EXPECT_NEAR(hits.u[i], truth.u[i], 1e-2f);
        EXPECT_NEAR(hits.v[i], truth.v[i], 1e-2f);
      }
    }
    EXPECT_LE(different, 2);
  }
  EXPECT_GT(named, 4000);
  EXPECT_GT(second, 500);
  EXPECT_EQ(counts.closest, 5 * rays.active_count());
}

TEST(Tracer, EmbreeEqualsBruteForceOnEvilTriangles) {
  std::mt19937 random(3);
  for (const float scale : {1e-3f, 1.f, 1e7f}) {
    std::vector<Vec3> positions;
    std::vector<UVec3> triangles;
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      positions.insert(positions.end(), {scale * a, scale * b, scale * c});
      triangles.push_back({first, first + 1, first + 2});
    };
    for (int i = 0; i < 60; ++i) {
      const Vec3 a = random_point(random, 1), b = random_point(random, 1), c = random_point(random, 1);
      add(a, b, c);
      if (i % 4 == 0) add(a, b, c);                    // a duplicate
      if (i % 4 == 1) add(a, b, a + 1e-6f * (c - a));  // a sliver
      if (i % 4 == 2) add(a, a + 0.5f * (b - a), c);   // coplanar and overlapping
      if (i % 4 == 3) add(a, b, a), add(b, b, b);      // degenerate
    }
    expect_equal_to_brute(scene_of(make_mesh(positions, triangles)), random_rays(random, 3000, scale), 6);
  }
}

TEST(Tracer, EmbreeEqualsBruteForceFarFromTheOrigin) {
  std::mt19937 random(4);
  const Vec3 center{1e4f, -1e4f, 2e4f};
  expect_equal_to_brute(scene_of(triangle_soup(random, 200, 1, 0.4f, center)), random_rays(random, 3000, 1, center), 40, 1e-2f);
}

TEST(Tracer, InstancesMayMirrorAndStretch) {
  std::mt19937 random(5);
  Scene scene;
  scene.meshes.push_back(triangle_soup(random, 60, 0.5f, 0.3f));
  const Mat4 transforms[] = {glm::translate(Mat4(1), Vec3{0.4f, 0, 0}), glm::scale(Mat4(1), Vec3{-1, 1, 1}),
                             glm::scale(glm::rotate(Mat4(1), 0.7f, Vec3{1, 2, 3}), Vec3{0.2f, 3, 0.7f}), glm::scale(Mat4(1), Vec3{1, 0, 1}),
                             glm::scale(Mat4(1), Vec3{0, 0, 0})};
  for (const Mat4& m : transforms) {
    Instance instance;
    instance.mesh = MeshId(0);
    instance.world_from_object = m;
    scene.instances.push_back(instance);
  }
  place(scene, triangle_soup(random, 60, 1, 0.3f), transforms[2]);
  expect_equal_to_brute(scene, random_rays(random, 4000, 1), 3);

  const Context context;
  const TextureSet textures(scene, context);
  const auto embree = make_embree_tracer(scene, textures, {}, context);
  EXPECT_EQ(embree->statistics().instances, 3u);          // the flattened one is baked, the collapsed one is gone
  EXPECT_EQ(embree->statistics().mesh_scenes_built, 1u);  // shared by its instances
  EXPECT_EQ(embree->statistics().static_triangles, 120u);
}

TEST(Tracer, AnimatedNodesAreInstances) {
  std::mt19937 random(6);
  Scene scene = scene_of(triangle_soup(random, 10, 1, 0.3f));
  scene.nodes.resize(2);
  scene.nodes[0].translation_track.times_s = {0, 1};
  scene.nodes[0].translation_track.values = {Vec4(0), Vec4(1)};
  scene.nodes[1].parent = NodeId(0);
  scene.instances[0].node = NodeId(1);
  const Context context;
  const TextureSet textures(scene, context);
  EXPECT_EQ(make_embree_tracer(scene, textures, {}, context)->statistics().instances, 1u);
}

TEST(Tracer, SpheresAreHitFromOutsideAndWithin) {
  std::mt19937 random(7);
  Scene scene = scene_of(triangle_soup(random, 40, 1, 0.3f));
  for (int i = 0; i < 12; ++i) {
    Sphere sphere;
    sphere.center = random_point(random, 1.5f);
    sphere.radius = i == 5 ? -1.f : i == 6 ? 0.f : i == 7 ? std::nanf("") : 0.1f + 0.1f * static_cast<float>(i);
    scene.spheres.push_back(sphere);
  }
  expect_equal_to_brute(scene, random_rays(random, 4000, 1), 4);

  const Context context;
  const TextureSet textures(scene, context);
  RayBatch rays;
  rays.resize(1);
  rays.set(0, {.origin = scene.spheres[3].center, .direction = {0, 2, 0}});
  scene.spheres = {scene.spheres[3]};
  scene.instances.clear();
  RayCounts counts;
  for (const auto& tracer : {make_brute_tracer(scene, textures, {}, context), make_embree_tracer(scene, textures, {}, context)}) {
    HitBatch hits;
    tracer->intersect(rays, hits, BatchKind::bounce, counts);
    EXPECT_EQ(hits.instance[0], kSphereBit | 0u) << tracer->name();
    EXPECT_NEAR(hits.t[0], 0.2f, 1e-6f);
  }
}

// Half of a square is cut away by a checkerboard in its alpha.
Scene masked_scene(AlphaMode mode) {
  Scene scene;
  scene.textures.push_back({"opaque", ConstantTexture{Vec4(1)}});
  scene.textures.push_back({"clear", ConstantTexture{Vec4(0)}});
  CheckerboardTexture checker{TextureId(0), TextureId(1), {}};
  checker.uv.matrix = glm::mat2(4.f);
  scene.textures.push_back({"checker", checker});
  Material material;
  material.alpha_mode = mode;
  material.alpha.texture = TextureId(2);
  scene.materials = {material, Material{}};
  Mesh square = make_mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  square.uvs = std::vector<Vec2>{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  square.materials = {MaterialId(0)};
  place(scene, square);
  return scene;
}

TEST(Tracer, RaysPassTheHolesOfAlphaMasks) {
  std::mt19937 random(8);
  for (const AlphaMode mode : {AlphaMode::mask, AlphaMode::blend}) {
    Scene scene = masked_scene(mode);
    const RayBatch rays = random_rays(random, 3000, 1);
    const Context context;
    const TextureSet textures(scene, context);
    const auto embree = make_embree_tracer(scene, textures, {}, context);
    TracerOptions solid;
    solid.alpha_masks = false;
    const auto without = make_embree_tracer(scene, textures, solid, context);
    RayCounts counts;
    HitBatch hits, solid_hits;
    embree->intersect(rays, hits, BatchKind::primary, counts);
    without->intersect(rays, solid_hits, BatchKind::primary, counts);
    int masked = 0, whole = 0;
    for (std::size_t i = 0; i < rays.size; ++i) {
      masked += hits.hit(i), whole += solid_hits.hit(i);
      if (!solid_hits.hit(i)) continue;
      const Ray ray = rays.get(i);
      const Vec3 p = ray.origin + solid_hits.t[i] * ray.direction;
      const auto field = [](float x) { return static_cast<int>(std::floor((x + 1) * 2)); };
      const float to_line = std::fmin(std::fabs(p.x * 2 - std::round(p.x * 2)), std::fabs(p.y * 2 - std::round(p.y * 2)));
      if (to_line > 1e-3f) {
        EXPECT_EQ(hits.hit(i), (field(p.x) + field(p.y)) % 2 == 0) << p.x << ' ' << p.y;
      }
    }
    EXPECT_NEAR(masked, whole / 2.0, 0.1 * whole);
    // As an instance, behind another surface, with an override that closes the holes, and on a sphere.
    scene.instances.push_back(scene.instances[0]);
    scene.instances.back().world_from_object = glm::translate(Mat4(1), Vec3{0.1f, 0.1f, 0.3f});
    scene.instances.push_back(scene.instances[0]);
    scene.instances.back().world_from_object = glm::translate(Mat4(1), Vec3{0, 0, 0.8f});
    scene.instances.back().material_override = MaterialId(1);
    Sphere sphere;
    sphere.material = MaterialId(0);
    sphere.radius = 0.7f;
    scene.spheres.push_back(sphere);
    expect_equal_to_brute(scene, rays, 6);
  }
}

/// Triangles, instances and spheres, some of which only bound a medium; without those, what stops shadow rays.
Scene scene_with_interfaces(bool complete) {
  std::mt19937 random(21);
  Scene scene;
  Material boundary;
  boundary.model = InterfaceMaterial{};
  boundary.interior = MediumId(0);
  scene.media.push_back({.name = "ink", .sigma_a = Color(1)});
  scene.materials = {Material{}, boundary};
  Mesh soup = triangle_soup(random, 300, 1, 0.4f);
  const Mesh instanced = triangle_soup(random, 60, 1, 0.4f);
  std::vector<UVec3> triangles;
  std::vector<std::uint16_t> entries;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const bool is_boundary = i % 3 != 0;
    if (is_boundary && !complete) continue;
    triangles.push_back(soup.triangles[i]);
    entries.push_back(is_boundary ? 1 : 0);
  }
  soup.triangles = std::move(triangles);
  soup.triangle_materials = std::move(entries);
  soup.materials = {MaterialId(0), MaterialId(1)};
  place(scene, soup);
  for (const float x : {-0.5f, 0.5f}) {
    place(scene, instanced, glm::translate(Mat4(1), Vec3{x, 0, 0}));
    if (x < 0) continue;
    scene.instances.back().material_override = MaterialId(1);
    if (!complete) scene.instances.pop_back();
  }
  for (const float z : {-0.5f, 0.5f}) {
    Sphere sphere;
    sphere.center = {0, 0, z}, sphere.radius = 0.4f;
    sphere.material = MaterialId(z < 0 ? 0 : 1);
    if (z < 0 || complete) scene.spheres.push_back(sphere);
  }
  return scene;
}

TEST(Tracer, InterfacesAreHitButDoNotOcclude) {
  std::mt19937 random(22);
  const RayBatch rays = random_rays(random, 3000, 1);
  const Context context;
  const Scene scene = scene_with_interfaces(true), bare = scene_with_interfaces(false);
  const TextureSet textures(scene, context);
  const auto truth = make_brute_tracer(bare, textures, {}, context), brute = make_brute_tracer(scene, textures, {}, context);
  TracerOptions no_masks;
  no_masks.alpha_masks = false;
  RayCounts counts;
  HitBatch expected, expected_bare, hits;
  brute->intersect(rays, expected, BatchKind::primary, counts);
  truth->intersect(rays, expected_bare, BatchKind::primary, counts);
  int passed = 0;
  for (std::size_t i = 0; i < rays.size; ++i) passed += expected.hit(i) && !expected_bare.hit(i);
  EXPECT_GT(passed, 300);
  for (const TracerOptions& options : {TracerOptions(), no_masks}) {
    const auto embree = make_embree_tracer(scene, textures, options, context);
    for (const Tracer* tracer : {brute.get(), embree.get()}) {
      for (const BatchKind kind : kKinds) {
        std::vector<std::uint8_t> occluded(padded(rays.size), 7);
        tracer->occluded(rays, occluded, kind, counts);
        tracer->intersect(rays, hits, kind, counts);
        int wrong = 0, different = 0;
        for (std::size_t i = 0; i < rays.size; ++i) {
          wrong += occluded[i] != (expected_bare.hit(i) ? 1 : 0);
          different += hits.hit(i) != expected.hit(i) || (hits.hit(i) && std::fabs(hits.t[i] - expected.t[i]) > 1e-4f * (1 + hits.t[i]));
        }
        EXPECT_LE(wrong, 6) << tracer->name();
        EXPECT_LE(different, 6) << tracer->name();
      }
    }
  }
}

TEST(Tracer, AMeshThatBecomesAnInterfaceIsBuiltAnew) {
  std::mt19937 random(23);
  const RayBatch rays = random_rays(random, 500, 1);
  const Context context;
  const TextureSet textures;
  Scene scene = scene_with_interfaces(true);
  const MaterialId boundary(1);
  scene.instances[2].material_override = {};
  scene.instances[0].material_override = MaterialId(0);
  const auto before = make_embree_tracer(scene, textures, {}, context);
  scene.instances[0].material_override = {};
  scene.instances[2].material_override = boundary;
  const auto edited = make_embree_tracer(scene, textures, {}, context, before.get()),
             fresh = make_embree_tracer(scene, textures, {}, context);
  std::vector<std::uint8_t> a(padded(rays.size)), b(padded(rays.size));
  RayCounts counts;
  before->occluded(rays, a, BatchKind::shadow, counts);
  fresh->occluded(rays, b, BatchKind::shadow, counts);
  EXPECT_NE(a, b);
  edited->occluded(rays, a, BatchKind::shadow, counts);
  EXPECT_EQ(a, b);
}

TEST(Tracer, BatchesOfAnySizeLeaveNothingBehindTheirEnd) {
  std::mt19937 random(9);
  Scene scene = scene_of(triangle_soup(random, 100, 1, 0.5f));
  scene.instances.push_back(scene.instances[0]);
  const Context context;
  const TextureSet textures(scene, context);
  const auto embree = make_embree_tracer(scene, textures, {}, context);
  const RayBatch all = random_rays(random, 1000, 1);
  RayCounts counts;
  HitBatch expected, hits;
  embree->intersect(all, expected, BatchKind::bounce, counts);
  for (const std::size_t size : {0, 1, 15, 16, 17, 1000}) {
    RayBatch rays = all;
    rays.resize(size);
    for (std::size_t i = size; i < padded(size); ++i) rays.t_near[i] = std::nanf("");
    for (const BatchKind kind : kKinds) {
      embree->intersect(rays, hits, kind, counts);
      ASSERT_EQ(hits.size, size);
      std::vector<std::uint8_t> occluded(padded(size));
      embree->occluded(rays, occluded, kind, counts);
      for (std::size_t i = 0; i < size; ++i) {
        EXPECT_EQ(hits.hit(i), expected.hit(i)) << i;
        EXPECT_EQ(occluded[i], expected.hit(i) ? 1 : 0) << i;
      }
    }
  }
}

TEST(Tracer, InactiveRaysHitNothing) {
  Scene scene = scene_of(box_mesh(Vec3(-1), Vec3(1)));
  Sphere sphere;
  scene.spheres.push_back(sphere);
  const Context context;
  const TextureSet textures(scene, context);
  RayBatch rays;
  rays.resize(33);
  for (std::size_t i = 0; i < 33; ++i) {
    const float infinity = std::numeric_limits<float>::infinity();
    rays.set(i, {.t_near = i % 2 ? 1.f : 0.f, .t_far = i % 2 ? 0.f : i % 4 == 0 ? -infinity : std::nanf("")});
  }
  RayCounts counts;
  for (const auto& tracer : {make_brute_tracer(scene, textures, {}, context), make_embree_tracer(scene, textures, {}, context)}) {
    for (const BatchKind kind : kKinds) {
      HitBatch hits;
      tracer->intersect(rays, hits, kind, counts);
      std::vector<std::uint8_t> occluded(padded(rays.size), 1);
      tracer->occluded(rays, occluded, kind, counts);
      for (std::size_t i = 0; i < rays.size; ++i) {
        EXPECT_FALSE(hits.hit(i));
        EXPECT_EQ(occluded[i], 0);
      }
    }
  }
}

TEST(Tracer, EmptyAndBrokenGeometryIsHarmless) {
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  std::mt19937 random(10);
  std::vector<Scene> scenes(5);
  scenes[1] = scene_of(Mesh{});
  scenes[2] = scene_of(make_mesh({{0, 0, 0}, {1, 0, nan}, {0, infinity, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 3, 4}, {0, 3, 77}}));
  scenes[3] = scene_of(box_mesh(Vec3(-1), Vec3(1)), Mat4(nan));
  scenes[4] = scene_of(make_mesh({{nan, nan, nan}}, {{0, 0, 0}}));
  for (const Scene& scene : scenes) expect_equal_to_brute(scene, random_rays(random, 200, 1), 0);
}

TEST(Tracer, WatertightMeshesLetNothingThrough) {
  // A closed, finely divided and crumpled surface: rays from within that aim at its vertices and edges.
  std::mt19937 random(11);
  const int n = 24;
  std::vector<Vec3> positions{{0, 0, 1}, {0, 0, -1}};
  std::vector<UVec3> triangles;
  const auto id = [&](int ring, int k) { return static_cast<std::uint32_t>(2 + ring * n + k % n); };
  for (int ring = 0; ring < n; ++ring) {
    for (int k = 0; k < n; ++k) {
      const float theta = kPi * static_cast<float>(ring + 1) / (n + 1), phi = 2 * kPi * static_cast<float>(k) / n;
      const float r = std::uniform_real_distribution<float>(0.8f, 1.2f)(random);
      positions.push_back(r * Vec3{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
    }
  }
  for (int k = 0; k < n; ++k) {
    triangles.push_back({0, id(0, k), id(0, k + 1)});
    triangles.push_back({1, id(n - 1, k + 1), id(n - 1, k)});
    for (int ring = 0; ring + 1 < n; ++ring) {
      triangles.push_back({id(ring, k), id(ring + 1, k), id(ring, k + 1)});
      triangles.push_back({id(ring, k + 1), id(ring + 1, k), id(ring + 1, k + 1)});
    }
  }
  RayBatch rays;
  rays.resize(4 * triangles.size());
  for (std::size_t i = 0; i < rays.size; ++i) {
    const UVec3& t = triangles[i / 4];
    const Vec3 target = i % 4 == 3 ? positions[t.x] : 0.5f * (positions[t[int(i % 4)]] + positions[t[int(i % 4 + 1) % 3]]);
    const Vec3 origin = random_point(random, 0.2f);
    rays.set(i, {.origin = origin, .direction = target - origin});
  }
  const Scene scene = scene_of(make_mesh(positions, triangles));
  const Context context;
  const TextureSet textures(scene, context);
  RayCounts counts;
  for (const auto& tracer : {make_brute_tracer(scene, textures, {}, context), make_embree_tracer(scene, textures, {}, context)}) {
    for (const BatchKind kind : kKinds) {
      HitBatch hits;
      tracer->intersect(rays, hits, kind, counts);
      for (std::size_t i = 0; i < rays.size; ++i) ASSERT_TRUE(hits.hit(i)) << tracer->name() << ' ' << i;
    }
  }
}

TEST(Tracer, MemoryIsCountedAndBounded) {
  std::mt19937 random(12);
  const int count = 40000;
  const Scene scene = scene_of(triangle_soup(random, count, 1, 0.02f));
  Context context;
  const TextureSet textures(scene, context);
  const auto tracer = make_embree_tracer(scene, textures, {}, context);
  const TracerMemory memory = tracer->memory();
  // The contract for the static scene: bytes a triangle, hierarchy and all, without the shared vertices.
  EXPECT_LE(static_cast<double>(memory.acceleration_bytes) / count, 190.0);
  EXPECT_GE(memory.peak_build_bytes, memory.acceleration_bytes);
  EXPECT_GT(memory.acceleration_bytes, 0u);
  TracerOptions compact;
  compact.compact = true;
  EXPECT_LT(make_embree_tracer(scene, textures, compact, context)->memory().acceleration_bytes, memory.acceleration_bytes);
  context.memory_budget_bytes = 1 << 20;
  try {
    make_embree_tracer(scene, textures, {}, context);
    FAIL() << "the budget was not kept";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::resource);
  }
}

TEST(Tracer, BuildsReportProgressAndCanBeCancelled) {
  std::mt19937 random(13);
  const Scene scene = scene_of(triangle_soup(random, 40000, 1, 0.02f));
  Context context;
  const TextureSet textures(scene, context);
  std::atomic<int> reports{0};
  std::atomic<double> most{0};
  context.progress = [&](const Progress& progress) {
    ++reports;
    if (progress.done > most) most = progress.done;
    EXPECT_LE(progress.done, progress.total);
  };
  make_embree_tracer(scene, textures, {}, context);
  EXPECT_GT(reports, 0);
  EXPECT_EQ(most, 40000.0);
  context.progress = [&](const Progress&) { context.cancelled = true; };
  try {
    make_embree_tracer(scene, textures, {}, context);
    FAIL() << "the build went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
}

TEST(Tracer, MaterialisedMeshesOnly) {
  struct Source final : MeshSource {
    std::uint64_t vertex_count() const override { return 0; }
    std::uint64_t triangle_count() const override { return 0; }
    Bounds bounds() const override { return {}; }
    void restart() override {}
    bool next(MeshChunk&) override { return false; }
  };
  Mesh mesh;
  mesh.source = std::make_shared<Source>();
  const Scene scene = scene_of(mesh);
  const Context context;
  const TextureSet textures(scene, context);
  EXPECT_THROW(make_embree_tracer(scene, textures, {}, context), Error);
  EXPECT_THROW(make_brute_tracer(scene, textures, {}, context), Error);
}

TEST(Tracer, UnknownInstructionSetsAreRefused) {
  const Scene scene;
  const Context context;
  const TextureSet textures(scene, context);
  TracerOptions options;
  options.isa = "mmx";
  EXPECT_THROW(make_embree_tracer(scene, textures, options, context), Error);
}

}  // namespace
}  // namespace sightline
