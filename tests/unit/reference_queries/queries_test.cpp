// The reference's shadow rays as queries: what it says of them is true, and its pictures stay what they were.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <mutex>
#include <set>

#include "support/studio.h"
#include "visibility/query_rays.h"

namespace sightline::test {
namespace {

/// Answers with exact rays, and keeps all that was asked.
class Recorder final : public Visibility {
 public:
  struct Asked {
    Vec3 x, x_normal, y, y_normal;
    float x_area, y_area;
    std::uint32_t x_id, y_id, light_end;
    QuerySemantic semantic;
  };
  explicit Recorder(std::shared_ptr<const World> world) : world_(std::move(world)) {}
  void begin_pass(const VisibilityPass& pass, const Context&) override { passes.push_back(pass.first_sample); }
  std::unique_ptr<VisibilityWorker> worker() override { return std::make_unique<Worker>(*this); }

  std::vector<Asked> asked;
  std::vector<std::uint32_t> passes;
  std::set<std::uint32_t> scopes;
  std::size_t gaps = 0;

 private:
  class Worker final : public VisibilityWorker {
   public:
    explicit Worker(Recorder& owner) : owner_(owner), tracer_(*owner.world_) {}
    void begin(std::uint32_t scope) override {
      const std::lock_guard lock(owner_.mutex_);
      owner_.scopes.insert(scope);
    }
    void visible(const QueryBatch& q, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) override {
      tracer_.trace_all(q, weights, rays, counts);
      const auto load = [](const Vec3Batch& b, std::size_t i) { return Vec3(b.x[i], b.y[i], b.z[i]); };
      const std::lock_guard lock(owner_.mutex_);
      for (std::size_t i = 0; i < q.size; ++i) {
        const std::uint32_t e = q.eye_of[i], l = q.light_of[i];
        owner_.gaps += l == kNoQuery;
        if (l == kNoQuery) continue;
        owner_.asked.push_back({load(q.eye.position, e), load(q.eye.normal, e), load(q.light.position, l), load(q.light.normal, l),
                                q.eye.cell_area[e], q.light.cell_area[l], q.eye.id[e], q.light.id[l], l,
                                static_cast<QuerySemantic>(q.semantic[l])});
      }
    }

   private:
    Recorder& owner_;
    QueryTracer tracer_;
  };

  std::shared_ptr<const World> world_;
  std::mutex mutex_;
};

struct Take {
  int spp = 2, light_samples = 1, max_bounces = 2, threads = 2;
  std::vector<std::string> settings{};
  std::vector<SampleRange> parts{};  ///< none: all at once
  std::uint64_t seed = 0;
};

Picture take(const Shot& shot, const Take& how, Visibility* visibility) {
  Context context;
  context.threads = how.threads;
  context.seed = how.seed;
  const View view(shot.camera, shot.size_px, PixelFilter());
  const Method& method = find_method("reference");
  RenderJob job;
  job.world = shot.world;
  job.view = &view;
  job.settings = method.default_settings();
  for (const std::string& setting : how.settings) job.settings.apply(setting);
  job.visibility = visibility;
  job.max_bounces = how.max_bounces;
  job.light_samples = how.light_samples;
  job.total_spp = static_cast<std::uint32_t>(how.spp);
  Picture picture{Frame(shot.size_px.x, shot.size_px.y, AovSet()), {}};
  std::vector<SampleRange> parts = how.parts;
  if (parts.empty()) parts.push_back({0, job.total_spp});
  for (const SampleRange& part : parts) method.render_pass(job, part, picture.frame, picture.statistics, context);
  return picture;
}

std::unique_ptr<Visibility> make(std::string_view name, const Shot& shot, const std::vector<std::string>& settings = {}) {
  const VisibilityInfo& info = find_visibility(name);
  SettingsValue value = info.settings;
  for (const std::string& setting : settings) value.apply(setting);
  return info.make(shot.world, value, Context());
}

Scene with_many_lights() {
  Scene scene = builtin_scene("cornell");
  const auto add = [&](const decltype(Light::shape)& shape) {
    Light light;
    light.shape = shape;
    scene.lights.push_back(light);
  };
  const Bounds bounds = [&] {
    Bounds b;
    for (const Mesh& mesh : scene.meshes) b.add(mesh.bounds);
    return b;
  }();
  const Vec3 center = bounds.center();
  add(PointLight{center, Color(bounds.half_diagonal() * bounds.half_diagonal())});
  add(DirectionalLight{glm::normalize(Vec3(0.2f, -1, -0.3f)), Color(1)});
  scene.environment.emplace();
  return scene;
}

class ReferenceQueries : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(LightSamples, ReferenceQueries, testing::Values(1, 3, 8, 40));

TEST_P(ReferenceQueries, PicturesAreThoseOfExactRays) {
  const Shot shot = shot_of(with_many_lights(), {40, 36});
  const Take how{.light_samples = GetParam()};
  Recorder recorder(shot.world);
  const auto exact = make("exact", shot);
  const Picture truth = take(shot, how, exact.get()), asked = take(shot, how, &recorder);
  EXPECT_EQ(asked.statistics.visibility.queries, truth.statistics.visibility.queries);
  EXPECT_EQ(asked.statistics.rays.occlusion, truth.statistics.rays.occlusion);
  EXPECT_GT(truth.statistics.visibility.queries, 1000u);
  EXPECT_TRUE(same_sums(truth.frame, asked.frame));
  EXPECT_EQ(recorder.passes, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(recorder.scopes.size(), truth.frame.tile_count());
}

TEST_P(ReferenceQueries, TellHowMuchOfALightASampleStandsFor) {
  const int samples = GetParam();
  const Shot shot = shot_of(with_many_lights(), {24, 24});
  Recorder recorder(shot.world);
  take(shot, {.spp = 1, .light_samples = samples}, &recorder);
  std::array<int, 4> count{};
  double area = 0;
  for (const Recorder::Asked& q : recorder.asked) {
    ++count[static_cast<std::size_t>(q.semantic)];
    EXPECT_GT(q.y_area, 0);
    if (is_infinite(q.semantic)) {
      EXPECT_NEAR(glm::length(q.y), 1, 1e-5);
    }
    if (q.semantic == QuerySemantic::surface) {
      // The one area light is sampled by area: all its samples stand for the same part of it.
      if (area == 0) area = q.y_area;
      EXPECT_NEAR(q.y_area, area, 1e-3 * area);
      EXPECT_GT(glm::dot(q.y_normal, q.x - q.y), 0);
    } else {
      EXPECT_EQ(q.y_normal, Vec3(0));
    }
  }
  for (const int n : count) EXPECT_GT(n, 20);
  EXPECT_GT(area, 0);
}

TEST(ReferenceQueries, EyeEndsLieOnTheSideOfTheirRayAndKnowTheirAreaWhereTheCameraSeesThem) {
  const Shot shot = shot_of(with_many_lights(), {24, 24});
  Recorder direct(shot.world), more(shot.world);
  take(shot, {.spp = 1, .light_samples = 4, .max_bounces = 0, .settings = {"mode=path"}}, &direct);
  const Vec3 eye(shot.camera.world_from_camera[3]);
  std::set<std::pair<std::uint32_t, std::uint32_t>> ids;
  for (const Recorder::Asked& q : direct.asked) {
    EXPECT_GT(glm::dot(q.x_normal, eye - q.x), 0);
    EXPECT_NEAR(glm::length(q.x_normal), 1, 1e-5);
    EXPECT_GT(q.x_area, 0);
    if (q.semantic == QuerySemantic::surface || q.semantic == QuerySemantic::solid_angle) {
      EXPECT_TRUE(ids.insert({q.x_id, q.y_id}).second) << "random numbers are used twice";
    }
  }
  take(shot, {.spp = 1, .light_samples = 4, .max_bounces = 1}, &more);
  const auto unknown = static_cast<std::size_t>(std::ranges::count(more.asked, 0.f, &Recorder::Asked::x_area));
  EXPECT_GT(unknown, 0u);
  EXPECT_EQ(unknown, more.asked.size() - direct.asked.size());
}

TEST(ReferenceQueries, AreasScaleWithTheSamplesOfAPass) {
  const Shot shot = shot_of(with_many_lights(), {8, 8});
  Recorder one(shot.world), four(shot.world);
  take(shot, {.spp = 4, .max_bounces = 0, .threads = 1}, &one);
  take(shot, {.spp = 4, .max_bounces = 0, .threads = 1, .settings = {"pass_spp=4"}}, &four);
  EXPECT_EQ(one.passes.size(), 4u);
  EXPECT_EQ(four.passes.size(), 1u);
  std::map<std::uint32_t, float> area;
  for (const Recorder::Asked& q : one.asked) area[q.x_id] = q.x_area;
  for (const Recorder::Asked& q : four.asked) EXPECT_FLOAT_EQ(4 * q.x_area, area.at(q.x_id));
}

TEST(ReferenceQueries, ALightWithoutExtentIsOneEndForAllThatAskAboutIt) {
  Scene scene = builtin_scene("cornell");
  for (Material& material : scene.materials) material.emission.value = Color(0);
  Light light;
  Bounds bounds;
  for (const Mesh& mesh : scene.meshes) bounds.add(mesh.bounds);
  light.shape = PointLight{bounds.center(), Color(bounds.half_diagonal())};
  scene.lights = {light};
  const Shot shot = shot_of(std::move(scene), {16, 16});
  Recorder recorder(shot.world);
  take(shot, {.spp = 1, .max_bounces = 1}, &recorder);
  EXPECT_GT(recorder.asked.size(), 200u);
  for (const Recorder::Asked& q : recorder.asked) {
    EXPECT_EQ(q.light_end, 0u);
    EXPECT_EQ(q.semantic, QuerySemantic::point);
    EXPECT_EQ(q.y, bounds.center());
  }
}

TEST(ReferenceQueries, RouletteThatLearnsDependsNeitherOnThreadsNorOnHowSamplesAreSplit) {
  const Shot shot = shot_of(with_many_lights(), {40, 40});
  const std::vector<std::string> quick{"resolution=4", "min_tests=4"};
  const auto first = make("nee++", shot, quick), second = make("nee++", shot, quick), exact = make("exact", shot);
  const Picture whole = take(shot, {.spp = 6, .threads = 1}, first.get());
  const Picture split = take(shot, {.spp = 6, .threads = 3, .parts = {{0, 1}, {1, 4}, {4, 6}}}, second.get());
  EXPECT_TRUE(same_sums(whole.frame, split.frame));
  EXPECT_GT(whole.statistics.visibility.cached, 0u);
  EXPECT_EQ(whole.statistics.visibility.traced + whole.statistics.visibility.cached, whole.statistics.visibility.queries);
  EXPECT_EQ(split.statistics.visibility.traced, whole.statistics.visibility.traced);
  // Before it has learnt anything it is exact.
  const auto third = make("nee++", shot, quick);
  EXPECT_TRUE(same_sums(take(shot, {.spp = 1}, third.get()).frame, take(shot, {.spp = 1}, exact.get()).frame));
}

TEST(ReferenceQueries, RouletteKeepsTheMeanOfThePicture) {
  constexpr int kSeeds = 100;
  const Shot shot = shot_of(with_many_lights(), {12, 12});
  const auto exact = make("exact", shot);
  double sum = 0, squares = 0, truth = 0;
  std::uint64_t saved = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Take how{.spp = 4, .light_samples = 2, .seed = static_cast<std::uint64_t>(seed)};
    const auto roulette = make("nee++", shot, {"resolution=3", "directions=2", "min_tests=8"});
    const Picture played = take(shot, how, roulette.get()), same_seed = take(shot, how, exact.get());
    const double difference = played.frame.mean_luminance() - same_seed.frame.mean_luminance();
    sum += difference, squares += difference * difference, truth += same_seed.frame.mean_luminance();
    saved += played.statistics.visibility.cached;
  }
  EXPECT_GT(saved, 1000u * kSeeds / 10);
  const double mean = sum / kSeeds, error = std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1));
  EXPECT_NEAR(mean, 0, 3 * error);
  EXPECT_LT(error, 0.01 * truth / kSeeds) << "too noisy to tell";
}

TEST(ReferenceQueries, ShadowMapsAnswerPointAndDirectionalLights) {
  const Shot shot = shot_of(with_many_lights(), {40, 40});
  const auto maps = make("shadow-map", shot, {"resolution=1024", "fill=on-demand"}), exact = make("exact", shot);
  const Picture truth = take(shot, {.spp = 4}, exact.get()), picture = take(shot, {.spp = 4}, maps.get());
  EXPECT_GT(picture.statistics.visibility.cached, 0u);
  EXPECT_GT(picture.statistics.visibility.traced, 0u);
  EXPECT_GT(picture.statistics.visibility.filling, 0u);
  EXPECT_NEAR(picture.frame.mean_luminance(), truth.frame.mean_luminance(), 0.02 * truth.frame.mean_luminance());
}

}  // namespace
}  // namespace sightline::test
