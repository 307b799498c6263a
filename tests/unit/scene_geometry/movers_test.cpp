// Scenes in which things move: as many vertices as asked for, closed bodies, closed paths, and nothing touches anything.
#include <gtest/gtest.h>

#include <map>

#include "scene/builtin/builtin.h"
#include "scene/builtin/solids.h"

namespace sightline {
namespace {

/// Vertices of everything that moves.
std::size_t moving_vertices(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances) {
    if (instance.node.valid()) count += scene.meshes[instance.mesh.index].positions.size();
  }
  return count;
}

/// Every edge has one triangle on either side, and all face outward, so that the volume is positive.
void expect_closed(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double volume = 0;
  for (const UVec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    volume += static_cast<double>(glm::dot(mesh.positions[t.x], glm::cross(mesh.positions[t.y], mesh.positions[t.z]))) / 6;
  }
  std::size_t bad = 0;
  for (const auto& [edge, count] : edges) bad += count != 1 || edges.count({edge.second, edge.first}) == 0;
  EXPECT_EQ(bad, 0u) << mesh.name;
  EXPECT_GT(volume, 0.1) << mesh.name;
}

TEST(Solids, AreClosedOfUnitRadiusAndHaveTheVerticesAskedFor) {
  for (const auto make : {builtin::torus_knot, builtin::bumpy_ball, builtin::gear}) {
    for (const std::uint64_t count : {400u, 5000u, 40000u}) {
      for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        const Mesh mesh = make(count, seed);
        expect_closed(mesh);
        EXPECT_NEAR(static_cast<double>(mesh.positions.size()) / static_cast<double>(count), 1, count < 1000 ? 0.1 : 0.04) << mesh.name;
        float radius = 0;
        for (const Vec3& p : mesh.positions) radius = std::max(radius, glm::length(p));
        EXPECT_NEAR(radius, 1, 1e-5f) << mesh.name;
        ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
        // Normals are those of the surface: every triangle faces as its corners do.
        if (count < 40000) continue;
        std::size_t turned = 0;
        for (const UVec3& t : mesh.triangles) {
          const Vec3 face = glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
          for (int k = 0; k < 3; ++k) turned += glm::dot(face, mesh.normals[t[k]]) <= 0;
        }
        EXPECT_EQ(turned, 0u) << mesh.name;
      }
    }
  }
}

TEST(Movers, HaveThePartsAndVerticesAskedFor) {
  for (const auto& [spec, parts, vertices] : {std::tuple{"movers", 5u, 80000.},
                                              {"movers,parts=12,vertices=80000", 12u, 80000.},
                                              {"movers,parts=1,vertices=1000", 1u, 1000.},
                                              {"movers,parts=20,vertices=5000", 20u, 5000.},
                                              {"pair", 2u, 40000.},
                                              {"pair,vertices=90000", 2u, 90000.}}) {
    const Scene scene = build_builtin(spec, {}, Context{});
    EXPECT_EQ(scene.instances.size(), parts + 1) << spec;
    EXPECT_NEAR(static_cast<double>(moving_vertices(scene)) / vertices, 1, 0.05) << spec;
    EXPECT_EQ(scene.meshes.back().positions.size(), 100u * 100u) << spec;
    EXPECT_EQ(scene.animation_duration_s, 4) << spec;
    EXPECT_EQ(build_builtin(std::string(spec) + ",ground=no", {}, Context{}).instances.size(), parts) << spec;
  }
}

TEST(Movers, NeverTouchEachOtherOrTheGround) {
  for (const char* spec :
       {"movers,vertices=5000", "movers,parts=12,vertices=6000", "movers,parts=20,vertices=5000", "pair,vertices=2000"}) {
    const Scene scene = build_builtin(spec, {}, Context{});
    for (int frame = 0; frame < 120; ++frame) {
      const Scene posed = pose(scene, static_cast<float>(frame) / 30);
      std::vector<Vec3> centers;
      for (const Instance& instance : posed.instances) {
        if (instance.node.valid()) centers.emplace_back(instance.world_from_object[3]);
      }
      // All bodies have bounding radius 1.
      for (std::size_t i = 0; i < centers.size(); ++i) {
        ASSERT_GT(centers[i].y, 1.02f) << spec << " frame " << frame;
        for (std::size_t j = 0; j < i; ++j) ASSERT_GT(glm::length(centers[i] - centers[j]), 2.04f) << spec << " frame " << frame;
      }
    }
  }
}

TEST(Movers, PassAboveAndBesideEachOther) {
  for (const char* spec : {"movers,vertices=5000", "movers,parts=12,vertices=6000", "pair,vertices=2000"}) {
    const Scene scene = build_builtin(spec, {}, Context{});
    int above = 0, beside = 0;
    for (int frame = 0; frame < 120; ++frame) {
      const Scene posed = pose(scene, static_cast<float>(frame) / 30);
      for (std::size_t i = 0; i + 1 < posed.instances.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
          const Vec3 d(posed.instances[i].world_from_object[3] - posed.instances[j].world_from_object[3]);
          const float along = std::sqrt(d.x * d.x + d.z * d.z);
          above += along < 1.2f;
          beside += std::fabs(d.y) < 1 && along < 3;
        }
      }
    }
    EXPECT_GT(above, 10) << spec;
    EXPECT_GT(beside, 10) << spec;
  }
}

TEST(Movers, PathsCloseAndRunEvenly) {
  const Scene scene = build_builtin("movers,vertices=5000", {}, Context{});
  const Scene start = pose(scene, 0), end = pose(scene, 4);
  for (std::size_t i = 0; i < start.instances.size(); ++i) {
    for (int column = 0; column < 4; ++column) {
      const Vec4 gap = start.instances[i].world_from_object[column] - end.instances[i].world_from_object[column];
      EXPECT_LT(glm::length(gap), 1e-4f) << i;
    }
    if (!start.instances[i].node.valid()) continue;
    // No step of a 120th differs from its neighbours by much, also not from the last to the first.
    float slowest = 1e9f, fastest = 0;
    for (int frame = 0; frame < 120; ++frame) {
      const Vec3 a(pose(scene, static_cast<float>(frame) / 30).instances[i].world_from_object[3]);
      const Vec3 b(pose(scene, static_cast<float>(frame + 1) / 30).instances[i].world_from_object[3]);
      slowest = std::min(slowest, glm::length(b - a));
      fastest = std::max(fastest, glm::length(b - a));
    }
    EXPECT_GT(slowest, 0);
    EXPECT_LT(fastest, 1.3f * slowest) << i;
  }
}

}  // namespace
}  // namespace sightline
