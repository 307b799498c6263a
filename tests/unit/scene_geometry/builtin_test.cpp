// Builtin scenes: all build, streams keep their promises, surfaces are closed.
#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "base/core/error.h"
#include "scene/builtin/builtin.h"
#include "scene/materialize.h"

namespace sightline {
namespace {

TEST(Builtin, EveryOneHasFiniteBoundsACameraAndASize) {
  const Context context;
  for (const BuiltinScene& entry : builtin_scenes()) {
    std::string spec = entry.name;
    if (spec == "room" || spec == "open-room" || spec == "ground") spec += ",content=cornell";
    if (spec == "hairball" || spec == "isosurface" || spec == "plant") spec += ",triangles=20000";
    const Scene scene = build_builtin(spec, {}, context);
    const Bounds bounds = scene_bounds(scene);
    EXPECT_FALSE(bounds.is_empty()) << spec;
    EXPECT_TRUE(is_finite(bounds.lower) && is_finite(bounds.upper)) << spec;
    EXPECT_FALSE(scene.cameras.empty()) << spec;
    EXPECT_TRUE(scene.hints.size_px.has_value()) << spec;
  }
}

TEST(Builtin, UnknownNamesAndParametersAreUsageErrors) {
  const Context context;
  for (const char* spec : {"cornel", "cornell,block=false", "furnace?albedo=2"}) {
    try {
      build_builtin(spec, {}, context);
      ADD_FAILURE() << spec;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage) << spec;
    }
  }
}

TEST(Builtin, HairballHasAboutTheTrianglesAskedFor) {
  const Scene scene = build_builtin("hairball,triangles=100000", {}, Context{});
  EXPECT_NEAR(static_cast<double>(scene.meshes[0].triangle_count()), 100000, 600);
}

TEST(Ground, SpinTurnsTheContentAboutItsOwnAxisAndNotTheGround) {
  const Context context;
  const Scene scene = build_builtin("ground,content=furnace?shape=mesh,spin=8", {}, context);
  EXPECT_EQ(scene.animation_duration_s, 8);
  const Scene still = pose(scene, 0), quarter = pose(scene, 2), later = pose(scene, 5);
  EXPECT_EQ(still.instances[0].world_from_object,
            build_builtin("ground,content=furnace?shape=mesh", {}, context).instances[0].world_from_object);
  EXPECT_EQ(still.instances[1].world_from_object, quarter.instances[1].world_from_object);
  // The ball stands around the origin: +Z goes to +X after a quarter, counter-clockwise seen from above.
  EXPECT_LT(glm::length(transform_point(quarter.instances[0].world_from_object, {0, 0, 1}) - Vec3(1, 0, 0)), 1e-5f);
  const float angle_rad = 2 * kPi * 5 / 8;
  EXPECT_LT(
      glm::length(transform_point(later.instances[0].world_from_object, {0, 0, 1}) - Vec3(std::sin(angle_rad), 0, std::cos(angle_rad))),
      1e-5f);
}

TEST(Isosurface, IsAClosedManifoldAcrossChunks) {
  const Context context;
  const Scene scene = build_builtin("isosurface,resolution=50,frequency=6", {.data_directory = {}, .keep_sources = true}, context);
  const Mesh mesh = materialize(scene.meshes.at(0), context);
  EXPECT_EQ(mesh.triangles.size(), scene.meshes[0].source->triangle_count());
  // Vertices on chunk borders are stored twice, bit for bit equal.
  std::map<std::tuple<float, float, float>, std::uint32_t> welded;
  std::vector<std::uint32_t> id;
  for (const Vec3& p : mesh.positions)
    id.push_back(welded.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(welded.size())).first->second);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const UVec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{id[t[k]], id[t[(k + 1) % 3]]}];
  }
  std::size_t bad = 0;
  for (const auto& [edge, count] : edges) bad += count != 1 || edges.count({edge.second, edge.first}) == 0;
  EXPECT_EQ(bad, 0u);
  // Closed orientable surfaces have an even Euler characteristic.
  EXPECT_EQ((welded.size() + edges.size() / 2 + mesh.triangles.size()) % 2, 0u);
}

TEST(Materialize, RestartGivesTheSameMeshAndABudgetIsKept) {
  Context context;
  const Scene scene = build_builtin("isosurface,resolution=40", {.data_directory = {}, .keep_sources = true}, context);
  const Mesh a = materialize(scene.meshes[0], context), b = materialize(scene.meshes[0], context);
  EXPECT_TRUE(std::equal(a.positions.begin(), a.positions.end(), b.positions.begin(), b.positions.end()));
  context.memory_budget_bytes = 1000;
  try {
    materialize(scene.meshes[0], context);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::resource);
  }
}

}  // namespace
}  // namespace sightline
