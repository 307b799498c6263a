// The exact visibility against every triangle in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/core/error.h"
#include "unit/trace/trace_scenes.h"
#include "visibility/query_ray_lanes.h"
#include "visibility/query_rays.h"
#include "visibility/visibility.h"

namespace sightline::test {
namespace {

/// How a segment (t in (0, far)) passes a set of triangles; `grazing` where it comes so near to an edge or an end that rounding may decide.
struct Passage {
  bool blocked = false, grazing = false;
};

Passage brute_force(const Mesh& mesh, const Vec3d& from, const Vec3d& direction, double far) {
  constexpr double kMargin = 1e-4;
  Passage passage;
  for (const UVec3& t : mesh.triangles) {
    const Vec3d a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    const Vec3d normal = glm::cross(b - a, c - a);
    const double along = glm::dot(normal, direction);
    const double at = glm::dot(a - from, normal) / along;
    if (!std::isfinite(at)) continue;
    const Vec3d p = from + at * direction;
    const double area = glm::dot(normal, normal);
    const double u = glm::dot(glm::cross(b - a, p - a), normal) / area, v = glm::dot(glm::cross(c - b, p - b), normal) / area;
    const double inside = std::fmin(std::fmin(u, v), 1 - u - v), within = std::fmin(at, far - at);
    const double least = std::fmin(inside, within);
    passage.blocked |= least > kMargin;
    passage.grazing |= std::fabs(least) <= kMargin;
  }
  return passage;
}

/// One query by itself.
struct Query {
  Vec3 x{0}, x_normal{0};
  float x_error = 0;
  Vec3 y{0}, y_normal{0};
  float y_error = 0;
  QuerySemantic semantic = QuerySemantic::surface;
};

QueryBatch batch_of(const std::vector<Query>& queries) {
  QueryBatch batch;
  batch.eye.resize(queries.size());
  batch.resize_lights(queries.size());
  batch.resize_queries(queries.size());
  for (std::uint32_t i = 0; i < queries.size(); ++i) {
    const Query& q = queries[i];
    batch.eye.set(i, q.x, q.x_normal, q.x_error, 0, i);
    batch.light.set(i, q.y, q.y_normal, q.y_error, 0, i);
    batch.semantic[i] = static_cast<std::uint8_t>(q.semantic);
    batch.eye_of[i] = batch.light_of[i] = i;
  }
  return batch;
}

struct Setting {
  Mesh mesh;
  std::shared_ptr<const World> world;
  std::unique_ptr<Visibility> visibility;

  Setting() {
    std::mt19937 random(1);
    mesh = triangle_soup(random, 150, 1, 0.3f);
    world = World::build(scene_of(mesh), {}, Context());
    const VisibilityInfo& info = find_visibility("exact");
    visibility = info.make(world, info.settings, Context());
  }
  std::vector<float> ask(const std::vector<Query>& queries) const {
    std::vector<float> weights(padded(queries.size()), -1);
    RayCounts rays;
    VisibilityCounts counts;
    visibility->worker()->visible(batch_of(queries), weights, rays, counts);
    weights.resize(queries.size());
    EXPECT_EQ(counts.queries, queries.size());
    EXPECT_EQ(counts.traced, queries.size());
    EXPECT_EQ(rays.occlusion, queries.size());
    return weights;
  }
};

TEST(ExactVisibility, AgreesWithBruteForceOnPointsInSpace) {
  const Setting s;
  EXPECT_TRUE(s.visibility->binary());
  std::mt19937 random(2);
  std::vector<Query> queries(5000);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    Query& q = queries[i];
    q.x = random_point(random, 1.2f);
    q.semantic = std::array{QuerySemantic::surface, QuerySemantic::point, QuerySemantic::direction, QuerySemantic::solid_angle}[i % 4];
    q.y = i % 4 < 2 ? random_point(random, 1.2f) : random_direction(random);
  }
  const std::vector<float> weights = s.ask(queries);
  int visible = 0, decided = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Query& q = queries[i];
    const bool to_infinity = i % 4 >= 2;
    const Passage truth = to_infinity ? brute_force(s.mesh, Vec3d(q.x), Vec3d(q.y), std::numeric_limits<double>::infinity())
                                      : brute_force(s.mesh, Vec3d(q.x), Vec3d(q.y) - Vec3d(q.x), 1);
    if (truth.grazing) continue;
    ++decided;
    visible += !truth.blocked;
    EXPECT_EQ(weights[i], truth.blocked ? 0 : 1) << "query " << i;
  }
  EXPECT_GT(decided, 4500);
  EXPECT_GT(visible, decided / 10);
  EXPECT_LT(visible, decided * 9 / 10);
}

TEST(ExactVisibility, SurfacesNeitherHideThemselvesNorTheirTargets) {
  const Setting s;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto on_surface = [&](Vec3& point, Vec3& normal, float& error) {
    const UVec3 t = s.mesh.triangles[random() % s.mesh.triangles.size()];
    float u = unit(random), v = unit(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 a = s.mesh.positions[t.x], b = s.mesh.positions[t.y], c = s.mesh.positions[t.z];
    point = a + u * (b - a) + v * (c - a);
    normal = glm::normalize(glm::cross(b - a, c - a));
    error = 1e-6f;
  };
  std::vector<Query> queries(4000);
  for (Query& q : queries) {
    on_surface(q.x, q.x_normal, q.x_error);
    on_surface(q.y, q.y_normal, q.y_error);
  }
  const std::vector<float> weights = s.ask(queries);
  int visible = 0, decided = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Query& q = queries[i];
    // Both ends lie on triangles, which do not count: look only at what is well between.
    const Vec3d from(q.x), whole = Vec3d(q.y) - Vec3d(q.x);
    const Passage truth = brute_force(s.mesh, from + 2e-4 * whole, whole, 1 - 4e-4);
    if (truth.grazing) continue;
    const double steepness = std::fmin(std::fabs(glm::dot(whole, Vec3d(q.x_normal))), std::fabs(glm::dot(whole, Vec3d(q.y_normal))));
    if (steepness < 1e-2) continue;
    ++decided;
    visible += !truth.blocked;
    EXPECT_EQ(weights[i], truth.blocked ? 0 : 1) << "query " << i;
  }
  EXPECT_GT(decided, 2500);
  EXPECT_GT(visible, decided / 20);
}

TEST(ExactVisibility, IsSymmetric) {
  const Setting s;
  std::mt19937 random(4);
  std::vector<Query> there(2000), back(2000);
  for (std::size_t i = 0; i < there.size(); ++i) {
    there[i].x = back[i].y = random_point(random, 1.2f);
    there[i].y = back[i].x = random_point(random, 1.2f);
  }
  const std::vector<float> a = s.ask(there), b = s.ask(back);
  int different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) different += a[i] != b[i];
  EXPECT_LE(different, 2);
}

TEST(ExactVisibility, AWaveAnswersAsAWorkerDoes) {
  const Setting s;
  std::mt19937 random(5);
  std::vector<Query> queries(100);
  for (Query& q : queries) q.x = random_point(random, 1.2f), q.y = random_point(random, 1.2f);
  const std::vector<float> expected = s.ask(queries);
  const QueryBatch batch = batch_of(queries);
  const std::unique_ptr<VisibilityWave> wave = s.visibility->wave(2);
  RayCounts rays;
  VisibilityCounts counts;
  wave->look_up(0, batch, rays, counts);
  wave->look_up(1, batch, rays, counts);
  wave->trace(Context(), rays, counts);
  std::vector<float> weights(padded(queries.size()));
  wave->resolve(1, weights);
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), weights.begin()));
}

TEST(QueryRays, LanesGiveTheBitsOfTheSingleCall) {
  std::mt19937 random(6);
  std::vector<Query> queries(333);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    Query& q = queries[i];
    q.x = random_point(random, 5), q.y = random_point(random, 5);
    q.x_normal = random_direction(random), q.x_error = 1e-4f, q.y_error = 1e-5f;
    q.semantic = std::array{QuerySemantic::surface, QuerySemantic::point, QuerySemantic::direction, QuerySemantic::solid_angle}[i % 4];
    if (i % 4 == 0) q.y_normal = random_direction(random);
  }
  QueryBatch batch = batch_of(queries);
  batch.light_of[7] = kNoQuery;
  const std::vector<std::uint32_t> some{5, 3, 200, 7, 7, 332, 0};
  const auto expect_ray = [&](const RayBatch& rays, std::size_t lane, std::size_t query) {
    const Ray a = rays.get(lane), b = query_ray(batch, query);
    EXPECT_TRUE(a.origin == b.origin && a.direction == b.direction && a.t_near == b.t_near && a.t_far == b.t_far) << query;
  };
  RayBatch rays;
  rays.resize(queries.size());
  query_rays(batch, nullptr, 0, queries.size(), rays);
  for (std::size_t i = 0; i < queries.size(); ++i) expect_ray(rays, i, i);
  query_rays(batch, nullptr, 100, 50, rays);
  for (std::size_t i = 0; i < 50; ++i) expect_ray(rays, i, 100 + i);
  query_rays(batch, some.data(), 0, some.size(), rays);
  for (std::size_t i = 0; i < some.size(); ++i) expect_ray(rays, i, some[i]);
}

// As where queries to one light go through eye points some of which it does not light: up to the very last.
TEST(QueryRays, LanesGiveTheBitsOfTheSingleCallWhereEndsAreSkipped) {
  std::mt19937 random(7);
  for (const std::size_t count : {9u, 33u, 70u}) {
    std::vector<Query> queries(count);
    for (Query& q : queries) {
      q.x = random_point(random, 5), q.y = random_point(random, 5);
      q.x_normal = random_direction(random), q.x_error = 1e-4f, q.semantic = QuerySemantic::point;
    }
    const QueryBatch batch = batch_of(queries);
    for (const std::uint32_t step : {2u, 3u, 5u}) {
      std::vector<std::uint32_t> which;
      for (auto i = static_cast<std::uint32_t>(random() % 3); i < count; i += 1 + static_cast<std::uint32_t>(random() % step))
        which.push_back(i);
      RayBatch rays;
      rays.resize(which.size());
      query_rays(batch, which.data(), 0, which.size(), rays);
      for (std::size_t i = 0; i < which.size(); ++i) {
        const Ray a = rays.get(i), b = query_ray(batch, which[i]);
        EXPECT_TRUE(a.origin == b.origin && a.direction == b.direction && a.t_far == b.t_far) << count << ' ' << which[i];
      }
    }
  }
}

TEST(ExactVisibility, GapsAreNeitherAskedNorCounted) {
  const Setting s;
  std::vector<Query> queries(3);
  for (Query& q : queries) q.x = Vec3(5, 5, 5), q.y = Vec3(6, 6, 6);
  QueryBatch batch = batch_of(queries);
  batch.light_of[1] = kNoQuery;
  std::vector<float> weights(padded(queries.size()), -1);
  RayCounts rays;
  VisibilityCounts counts;
  s.visibility->worker()->visible(batch, weights, rays, counts);
  EXPECT_EQ(weights[0], 1);
  EXPECT_EQ(weights[1], 0);
  EXPECT_EQ(weights[2], 1);
  EXPECT_EQ(counts.queries, 2u);
}

TEST(VisibilityTable, AnUnknownNameIsAUsageError) {
  EXPECT_THROW(find_visibility("exakt"), Error);
  EXPECT_EQ(find_visibility("exact").name, "exact");
}

}  // namespace
}  // namespace sightline::test
