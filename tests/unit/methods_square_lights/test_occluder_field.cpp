#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "base/core/error.h"
#include "methods/square_lights/hemisphere_disk.h"
#include "methods/square_lights/occluder_field.h"
#include "methods/square_lights/solid_ball.h"
#include "scene/scene.h"
#include "shade/cube_map.h"
#include "support/every_target.h"
#include "texture/texture_set.h"

namespace sightline::square_lights {
namespace {

/// Whether a ray from a point along a unit direction hits the occluder.
using Hits = std::function<bool(const Vec3& origin, const Vec3& direction)>;

Hits ellipsoid(const Vec3& center, const Vec3& axes) {
  return [=](const Vec3& origin, const Vec3& direction) {
    const Vec3 o = (origin - center) / axes, d = direction / axes;
    const float a = glm::dot(d, d), b = glm::dot(o, d), c = glm::dot(o, o) - 1;
    return c <= 0 || (b < 0 && b * b >= a * c);
  };
}

/// A field of an occluder given by a formula. Tables are made when a point near them is asked about.
class LazyField {
 public:
  LazyField(const Vec3& center, float radius, const OccluderFieldOptions& options, Hits hits)
      : options_(options),
        hits_(std::move(hits)),
        grid_(options.resolution),
        tables_(kFieldTables * kTableCells + kTableSlack),
        made_(kFieldTables) {
    field_ = OccluderField(center, radius, shell_zoom(options), std::span<const std::int8_t>(tables_).first(kFieldTables * kTableCells));
  }
  OccluderSamples samples(const Vec3& position) {
    const OccluderSamples samples = field_.samples(position);
    for (const std::size_t i : samples.table) make(i);
    return samples;
  }
  const OccluderField& field() const { return field_; }

 private:
  void make(std::size_t i) {
    if (made_[i]) return;
    made_[i] = 1;
    const int n = options_.resolution, shell = static_cast<int>(i / kShellPoints);
    const Vec3 out = shell_direction(i), origin = field_.center() + shell_radius(shell) * field_.radius() * out;
    const Frame3 frame = frame_from_normal(-out);
    std::vector<std::uint8_t> map(grid_.count());
    for (std::size_t k = 0; k < map.size(); ++k)
      map[k] = !hits_(origin, frame.to_world(direction_from_disk(field_.zoom()[static_cast<std::size_t>(shell)] * grid_.point(k))));
    make_distance_table(map, n, std::span<std::int8_t, kTableCells>(tables_.data() + i * kTableCells, kTableCells));
  }

  OccluderFieldOptions options_;
  Hits hits_;
  DiskGrid grid_;
  std::vector<std::int8_t> tables_;
  std::vector<std::uint8_t> made_;
  OccluderField field_;
};

/// Visible part of a square light over all its turns, by points.
float true_visibility(const Hits& hits, const Vec3& position, const Vec3& c, float r) {
  const Frame3 frame = frame_from_normal(c);
  const float half = r * 0.70710678f;
  int visible = 0, all = 0;
  for (int turn = 0; turn < 4; ++turn) {
    const float angle = static_cast<float>(turn) * kPi / 8;
    for (int j = 0; j < 16; ++j) {
      for (int i = 0; i < 16; ++i) {
        const Vec2 q = ((Vec2(static_cast<float>(i), static_cast<float>(j)) + 0.5f) / 8.f - 1.f) * half;
        const Vec2 turned(std::cos(angle) * q.x - std::sin(angle) * q.y, std::sin(angle) * q.x + std::cos(angle) * q.y);
        // Lambert's coordinates have rho = 2 sin(angle / 2), the disk half of its square.
        const Vec3 d = frame.to_world(direction_from_disk(turned * 0.70710678f));
        visible += !hits(position, d), ++all;
      }
    }
  }
  return static_cast<float>(visible) / static_cast<float>(all);
}

class Directions {
 public:
  explicit Directions(unsigned seed) : random_(seed) {}
  Vec3 unit() { return glm::normalize(Vec3(gauss_(random_), gauss_(random_), gauss_(random_))); }
  float between(float a, float b) { return a + (b - a) * uniform_(random_); }

 private:
  std::mt19937 random_;
  std::normal_distribution<float> gauss_;
  std::uniform_real_distribution<float> uniform_{0, 1};
};

/// A light and who looks at it.
struct Query {
  Vec3 position, c;
  float r;
};
/// |visibility - truth| of each.
std::vector<float> errors_of(LazyField& lazy, const Hits& hits, const std::vector<Query>& queries) {
  for (const Query& q : queries) lazy.samples(q.position);
  OccluderField field = lazy.field();
  field.measure(Context());
  std::vector<float> errors;
  for (const Query& q : queries) {
    const float truth = true_visibility(hits, q.position, q.c, q.r);
    errors.push_back(std::fabs(field.visibility(q.position, q.c, q.r, Coverage::average) - truth));
  }
  return errors;
}
float mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += v;
  return static_cast<float>(sum / static_cast<double>(values.size()));
}

TEST(OccluderField, OfASphereIsTheAnalyticDisk) {
  const Vec3 center(3, -2, 1);
  const float radius = 2;
  const Hits hits = ellipsoid(center, Vec3(radius));
  LazyField lazy(center, radius, {}, hits);
  Directions random(1);
  std::vector<Query> near, outside;
  for (int i = 0; i < 200; ++i) {
    const float rho = 0.6f * std::pow(10.f, random.between(0, 1));
    const Vec3 out = random.unit(), position = center + rho * radius * out;
    // A light near the sphere's outline, or anywhere.
    const float angle = std::asin(std::min(1.f, 1 / rho)) + random.between(-0.4f, 0.4f);
    Vec3 c = std::cos(angle) * -out + std::sin(angle) * glm::normalize(glm::cross(out, random.unit()));
    if (i % 4 == 0) c = random.unit();
    // Between the shells next to the surface one sees nothing and the other half of the world.
    (rho > 1.2f ? outside : near).push_back({position, c, random.between(0.03f, 0.5f)});
  }
  const std::vector<float> errors = errors_of(lazy, hits, outside), near_errors = errors_of(lazy, hits, near);
  EXPECT_LT(mean(errors), 0.025f);
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.2f);
  const auto count = static_cast<float>(errors.size()), near_count = static_cast<float>(near_errors.size());
  EXPECT_LT((mean(errors) * count + mean(near_errors) * near_count) / (count + near_count), 0.03f);
}

TEST(OccluderField, FollowsAnOutlineThatIsNoDisk) {
  const Hits hits = ellipsoid(Vec3(0), {1, 0.4f, 0.7f});
  for (const bool zoom : {true, false}) {
    LazyField lazy(Vec3(0), 1, {32, zoom}, hits);
    Directions random(2);
    std::vector<Query> queries;
    for (int i = 0; i < 200; ++i) {
      const Vec3 position = random.between(1.2f, 5.9f) * random.unit();
      const Vec3 c = glm::normalize(random.between(0, 1.1f) * random.unit() - position);
      queries.push_back({position, c, random.between(0.03f, 0.3f)});
    }
    EXPECT_LT(mean(errors_of(lazy, hits, queries)), zoom ? 0.05f : 0.07f) << zoom;
  }
}

TEST(OccluderField, IsContinuousAcrossCubeEdgesCornersAndShells) {
  const Hits hits = ellipsoid(Vec3(0), {1, 0.3f, 0.6f});
  LazyField lazy(Vec3(0), 1, {32, true}, hits);
  const auto jump = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const float before = lazy.field().distance(lazy.samples(a), c, 0.2f), after = lazy.field().distance(lazy.samples(b), c, 0.2f);
    return std::fabs(after - before);
  };
  Directions random(3);
  constexpr float step = 1e-4f;
  for (int i = 0; i < 400; ++i) {
    // A point on a border, the same pushed a little to either side.
    Vec3 on, side = random.unit();
    float rho = random.between(0.7f, 7);
    switch (i % 4) {
      case 0: {  // an edge between faces
        on = cube_direction(i % 6, 1, random.between(-1, 1));
        break;
      }
      case 1: {  // near a corner
        on = cube_direction(i % 6, 1 - random.between(0, 0.02f), 1 - random.between(0, 0.02f));
        break;
      }
      case 2: {  // where frames about directions change their tangents
        on = random.unit(), on.z = 0, side = Vec3(0, 0, 1);
        break;
      }
      default: {
        on = random.unit(), side = on;
        rho = shell_radius(4 + i % 12);
      }
    }
    const Vec3 position = rho * glm::normalize(on);
    const Vec3 c = glm::normalize(0.8f * random.unit() - position);
    EXPECT_LT(jump(position - step * side, position + step * side, c), 3e-3f) << i;
  }
}

TEST(OccluderField, IsContinuousBeyondTheLastShell) {
  LazyField lazy(Vec3(0), 1, {32, true}, ellipsoid(Vec3(0), {1, 0.5f, 0.7f}));
  Directions random(4);
  for (int i = 0; i < 60; ++i) {
    const Vec3 out = random.unit(), c = glm::normalize(random.between(0, 1) * random.unit() - 6.f * out);
    lazy.samples(6.f * out);
    EXPECT_NEAR(lazy.field().visibility(6.f * out, c, 0.2f), lazy.field().visibility(6.001f * out, c, 0.2f), 1e-3f);
  }
}

TEST(OccluderField, FarAwayFollowsTheLastShell) {
  const Hits hits = ellipsoid(Vec3(0), {1, 0.5f, 0.7f});
  LazyField lazy(Vec3(0), 1, {}, hits);
  Directions random(5);
  std::vector<Query> small, large;
  for (int i = 0; i < 40; ++i) {
    const Vec3 out = random.unit();
    const Vec3 c = glm::normalize(random.between(0, 1) * random.unit() - 50.f * out);
    // A light half as large as the occluder looks, and one much larger.
    small.push_back({50.f * out, c, 0.01f}), large.push_back({50.f * out, c, 0.2f});
  }
  EXPECT_LT(mean(errors_of(lazy, hits, small)), 0.04f);
  const std::vector<float> errors = errors_of(lazy, hits, large);
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.02f);
}

TEST(OccluderField, HidesNoMoreThanItsOwnArea) {
  // Behind a light larger than the occluder, Eq. 9 alone would hide half and more.
  const Hits hits = ellipsoid(Vec3(0), Vec3(1));
  LazyField lazy(Vec3(0), 1, {}, hits);
  std::vector<Query> queries;
  for (const float rho : {3.f, 6.f, 12.f}) queries.push_back({{0, 0, rho}, {0, 0, -1}, 0.8f});
  for (const float error : errors_of(lazy, hits, queries)) EXPECT_LT(error, 0.045f);
  for (const Query& q : queries)
    EXPECT_NEAR(lazy.field().visibility(q.position, q.c, q.r), true_visibility(hits, q.position, q.c, q.r), 0.06f)
        << "without measured areas";
}

TEST(OccluderField, MeasuredAreasAreThoseOfTheOutline) {
  const Hits hits = ellipsoid(Vec3(0), Vec3(0.5f));
  LazyField lazy(Vec3(0), 1, {}, hits);
  Directions random(6);
  std::vector<Vec3> positions;
  for (int i = 0; i < 20; ++i) positions.push_back(random.between(1, 12) * random.unit()), lazy.samples(positions.back());
  OccluderField measured = lazy.field();
  measured.measure(Context());
  for (const Vec3& position : positions) {
    const float rho = glm::length(position), outline = kPi * (1 - std::cos(std::asin(0.5f / rho)));
    EXPECT_NEAR(measured.samples(position).hidden_area, outline, 0.03f * outline + 0.002f) << rho;
    EXPECT_GT(lazy.field().samples(position).hidden_area, 2 * outline) << "the bounding sphere's outline";
  }
}

TEST(OccluderField, LightsThatCannotReachTheConeAreOpen) {
  LazyField lazy(Vec3(0), 1, {32, true}, ellipsoid(Vec3(0), Vec3(1)));
  const Vec3 position(0, 0, 2);  // half angle of 30 degrees
  const OccluderSamples samples = lazy.samples(position);
  const auto at = [&](float degrees, float r) {
    const float angle = degrees * kPi / 180;
    return lazy.field().distance(samples, {std::sin(angle), 0, -std::cos(angle)}, r);
  };
  EXPECT_EQ(at(45, 0.2f), kBeyondOccluder);
  EXPECT_LT(at(40, 0.2f), 1);
  EXPECT_LT(at(45, 0.3f), 1);
  EXPECT_EQ(at(180, 0.3f), kBeyondOccluder);
  EXPECT_EQ(at(110, 1.f), kBeyondOccluder);
  // Inside the bounding sphere no direction is beyond it.
  EXPECT_LT(lazy.field().distance(lazy.samples({0, 0, 0.9f}), {0, 0, 1}, 0.1f), kBeyondOccluder);
}

TEST(OccluderField, LooksUpWhereverThePointIs) {
  LazyField lazy(Vec3(0), 1, {32, true}, ellipsoid(Vec3(0), Vec3(1, 0.2f, 0.2f)));
  for (const Vec3 position :
       {Vec3(0), Vec3(1e-30f, 0, 0), Vec3(0.1f, 0, 0), Vec3(1, 1, 1), Vec3(-3, 3, 2.99f), Vec3(1e8f, 0, 0), Vec3(0, 0, -2)}) {
    const OccluderSamples samples = lazy.samples(position);
    float weight = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_LT(static_cast<std::size_t>(samples.table[i]), kFieldTables);
      weight += samples.cell_unit[i] * std::hypot(samples.turn_x[i], samples.turn_y[i]);
    }
    EXPECT_NEAR(weight, 1, 1e-4f) << "weights of tables, whatever their scales";
    EXPECT_EQ(samples.inside, glm::length(position) < kInnerShell);
    for (const Vec3 c : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1)}) {
      EXPECT_FALSE(std::isnan(lazy.field().distance(samples, c, 0.1f)));
      EXPECT_GE(lazy.field().visibility(position, c, 0), 0);
    }
  }
}

TEST(OccluderDistances, EqualTheScalarDefinitionOnEveryTarget) {
  std::mt19937 bits(7);
  std::vector<std::int8_t> tables(kFieldTables * kTableCells + kTableSlack);
  const OccluderField field({0.1f, 0.2f, 0.3f}, 1.5f, shell_zoom({}),
                            std::span<const std::int8_t>(tables).first(kFieldTables * kTableCells));
  Directions random(8);
  AlignedVector<float> x(48), y(48), z(48), r(48), distances(48);
  for (int i = 0; i < 100; ++i) {
    const Vec3 position = field.center() + random.between(0.2f, 12) * random.unit();
    const OccluderSamples samples = field.samples(position);
    for (const std::int32_t index : samples.table) {
      const auto t = static_cast<std::size_t>(index);
      for (std::size_t k = 0; k < kTableCells; ++k) tables[t * kTableCells + k] = static_cast<std::int8_t>(bits() % 255 - 127);
    }
    for (std::size_t k = 0; k < x.size(); ++k) {
      Vec3 c = random.unit();
      if (k % 2) c = glm::normalize(samples.frame.normal + 0.4f * c);
      if (k == 0) c = samples.frame.normal;
      if (k == 1) c = -samples.frame.normal;
      x[k] = c.x, y[k] = c.y, z[k] = c.z, r[k] = k >= 40 ? 0 : random.between(0, 1);
    }
    for (const std::int64_t target : test::simd_targets()) {
      const test::PinnedTarget pinned(target);
      occluder_distances(field, samples, {x, y, z, r, x.size()}, distances);
      for (std::size_t k = 0; k < x.size(); ++k)
        ASSERT_EQ(distances[k], field.distance(samples, {x[k], y[k], z[k]}, r[k])) << hwy::TargetName(target) << " " << k;
    }
  }
}

/// Traced tables against those of the formula.
struct BakeFixture {
  Context context;
  Vec3 center{1, 2, 3};
  float radius = 2;
  std::unique_ptr<Tracer> tracer;
  BakeFixture() {
    Scene scene;
    Sphere sphere;
    sphere.center = center, sphere.radius = radius;
    scene.spheres.push_back(sphere);
    tracer = make_brute_tracer(scene, TextureSet(), {}, context);
  }
  AlignedVector<std::int8_t> bake(std::size_t first, std::size_t count, RayCounts& rays, const OccluderFieldOptions& options = {32, true}) {
    AlignedVector<std::int8_t> tables(count * kTableCells);
    bake_occluder_tables(*tracer, center, radius, options, first, tables, rays, context);
    return tables;
  }
};

TEST(OccluderBake, TracesWhatTheFormulaSays) {
  BakeFixture fixture;
  for (const bool zoom : {true, false}) {
    for (const int shell : {0, 3, 6, 7, 11, 15}) {
      RayCounts rays;
      const auto tables = fixture.bake(static_cast<std::size_t>(shell) * kShellPoints + 1234, 2, rays, {64, zoom});
      const float rho = shell_radius(shell), scale = shell_zoom({64, zoom})[static_cast<std::size_t>(shell)];
      for (float x = 0.1f; x < 1; x += 0.09f) {  // at 0 a cusp is rounded off
        const float found = distance_at(TableView(tables.data(), kTableCells), {0.8f * x, 0.6f * x}) * scale;
        // Within the sphere everything is hidden: rays start inside and hit it from there.
        if (rho < 1)
          EXPECT_LT(found, -0.9f);
        else
          EXPECT_NEAR(found, x * scale - apparent_radius(rho), 0.03f * scale) << shell << " " << x;
      }
      // No ray leaves for where the sphere is not.
      const float cells = rho < 1 ? kPi * 1024 : kPi * 1024 * apparent_radius(rho) * apparent_radius(rho) / (scale * scale);
      EXPECT_NEAR(static_cast<float>(rays.occlusion), 2 * cells, 0.03f * 2 * cells + 8) << shell;
    }
  }
}

TEST(OccluderBake, RaysIntoASolidBallNeedNotBeTraced) {
  BakeFixture fixture;
  OccluderFieldOptions known{64, true};
  known.solid = 0.9f * fixture.radius;
  for (const int shell : {0, 4, 5, 6, 11, 15}) {
    RayCounts all, rest;
    const std::size_t first = static_cast<std::size_t>(shell) * kShellPoints + 321;
    EXPECT_EQ(fixture.bake(first, 3, rest, known), fixture.bake(first, 3, all, {64, true})) << shell;
    EXPECT_LT(rest.occlusion, shell_radius(shell) < 0.9f ? 1 : 0.45f * static_cast<float>(all.occlusion)) << shell;
  }
}

/// A cube of edge 2 about `center`, each face of four corners of its own.
struct SixFaces {
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  explicit SixFaces(const Vec3& center) {
    for (int face = 0; face < kCubeFaces; ++face) {
      const auto base = static_cast<std::uint32_t>(positions.size());
      for (int k = 0; k < 4; ++k) positions.push_back(center + cube_direction(face, k % 2 ? 1.f : -1.f, k / 2 ? 1.f : -1.f));
      triangles.emplace_back(base, base + 1, base + 3);
      triangles.emplace_back(base, base + 3, base + 2);
    }
  }
  float ball(const Vec3& center) const { return solid_ball(positions, triangles, center); }
};

TEST(SolidBall, TouchesTheNearestFaceOfAClosedSurface) {
  const Vec3 center(4, -2, 1);
  const SixFaces cube(center);
  EXPECT_NEAR(cube.ball(center), 1, 2e-3f);
  EXPECT_LE(cube.ball(center), 1);
  EXPECT_NEAR(cube.ball(center + Vec3(0.3f, 0, -0.6f)), 0.4f, 1e-3f);
  EXPECT_EQ(cube.ball(center + Vec3(1.5f, 0, 0)), 0);  // outside
  EXPECT_EQ(cube.ball(center + Vec3(3, 3, 3)), 0);
}

TEST(SolidBall, IsNoneWhereTheSurfaceIsOpenOrTurnsOver) {
  SixFaces open(Vec3(0)), turned(Vec3(0));
  open.triangles.pop_back();
  EXPECT_EQ(open.ball(Vec3(0)), 0);
  std::swap(turned.triangles[3].x, turned.triangles[3].y);
  EXPECT_EQ(turned.ball(Vec3(0)), 0);
  SixFaces moved(Vec3(0));
  moved.positions[5].x += 1e-4f;
  EXPECT_EQ(moved.ball(Vec3(0)), 0);
  moved.positions[5].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(moved.ball(Vec3(0)), 0);
}

TEST(OccluderBake, IsTheSameForAnyNumberOfThreads) {
  BakeFixture fixture;
  RayCounts one, three;
  fixture.context.threads = 1;
  const auto first = fixture.bake(7 * kShellPoints - 100, 300, one);
  fixture.context.threads = 3;
  EXPECT_EQ(fixture.bake(7 * kShellPoints - 100, 300, three), first);
  EXPECT_EQ(one.occlusion, three.occlusion);
}

TEST(OccluderBake, ReportsProgressAndStops) {
  BakeFixture fixture;
  double done = 0;
  fixture.context.threads = 1;
  fixture.context.progress = [&](const Progress& progress) { done = std::max(done, progress.done); };
  RayCounts rays;
  fixture.bake(0, 100, rays);
  EXPECT_EQ(done, 100);
  fixture.context.progress = [&](const Progress&) { fixture.context.cancelled = true; };
  EXPECT_THROW(fixture.bake(0, 100, rays), Error);
  EXPECT_EQ(occluder_field_bytes(), kFieldTables * kTableCells + kTableSlack);
}

TEST(ShellPoints, LieOnLogarithmicShellsAroundTheCentre) {
  EXPECT_FLOAT_EQ(shell_radius(0), 0.4f);
  EXPECT_FLOAT_EQ(shell_radius(15), 6);
  EXPECT_NEAR(shell_radius(8) / shell_radius(7), 1.1979f, 1e-3f);
  for (const std::size_t i : {std::size_t{0}, kShellPoints - 1, kShellPoints, std::size_t{50000}}) {
    EXPECT_NEAR(glm::length(shell_direction(i)), 1, 1e-6f);
    EXPECT_EQ(shell_direction(i), shell_direction(i % kShellPoints));
  }
  // A sample at a table's own point is that table alone.
  LazyField lazy(Vec3(0), 1, {32, true}, ellipsoid(Vec3(0), Vec3(1)));
  const std::size_t i = 9 * kShellPoints + 3000;
  const OccluderSamples samples = lazy.samples(shell_radius(9) * shell_direction(i));
  float own = 0, all = 0;
  for (int k = 0; k < 8; ++k) {
    all += samples.code_unit[k];
    if (samples.table[k] == i) own += samples.code_unit[k];
  }
  EXPECT_GT(own, 0.999f * all);
}

}  // namespace
}  // namespace sightline::square_lights
