// Whole pictures against the reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numeric>

#include "base/core/error.h"
#include "image/image.h"
#include "image/metrics/metrics.h"
#include "test_fragments_support.h"

namespace sightline::test {
namespace {

/// The reference's one-hit mode: what every method here estimates.
Picture one_hit(const Shot& shot, int light_samples) {
  return expose(shot, {.method = "reference", .spp = 1, .light_samples = light_samples, .max_bounces = 0});
}
Picture fragments(const Shot& shot, std::vector<std::string> settings, int threads = 2, int spp = 1) {
  return expose(shot, {.method = "fragments", .settings = std::move(settings), .spp = spp, .max_bounces = 0, .threads = threads});
}

std::vector<Vec3d> colors(const Frame& frame) {
  std::vector<Vec3d> result;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(frame.width() * frame.height()); ++i) result.emplace_back(frame.color(i));
  return result;
}
double sum(const std::vector<Vec3d>& picture) {
  return std::accumulate(picture.begin(), picture.end(), 0.0, [](double s, const Vec3d& c) { return s + c.x + c.y + c.z; });
}
/// Sum of squared errors over that of the reference, the paper's measure.
double nmse(const std::vector<Vec3d>& picture, const std::vector<Vec3d>& truth) {
  double squared = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) squared += glm::dot(picture[i] - truth[i], picture[i] - truth[i]);
  return squared / sum(truth);
}

/// A picture whose truth is made once.
struct Study {
  Shot shot;
  std::vector<Vec3d> truth;
  static const Study& of_box() {
    static const Study study = [] {
      const Shot shot = shot_of(lamp_over_floor(Occluder::box), {200, 134});
      return Study{shot, colors(one_hit(shot, 1024).frame)};
    }();
    return study;
  }
};

// Where irradiance is interpolated, pictures of a few hundred pixels have a bias: the largest fragments are a good part of them, and carry
// one value each. Shares of the light have none.
TEST(FragmentPictures, AreCloseToConvergedOnes) {
  struct Case {
    std::vector<std::string> settings;
    double error, energy;
  };
  const Study& study = Study::of_box();
  for (const Case& c : {Case{{}, 1e-4, 0.005}, Case{{"variant=koa"}, 1e-3, 0.02}, Case{{"variant=nichols"}, 5e-3, 0.03},
                        Case{{"upsample=quad4"}, 1e-4, 0.005}, Case{{"upsample=rbf-fixed"}, 1e-4, 0.005},
                        Case{{"upsample=multipass"}, 1e-4, 0.005}, Case{{"signal=irradiance"}, 1e-3, 0.02}, Case{{"rays=32"}, 1e-4, 0.005},
                        Case{{"rays=64"}, 1e-4, 0.007}, Case{{"refine=nichols"}, 1e-3, 0.01}, Case{{"early_out=off"}, 1e-4, 0.005},
                        Case{{"edge_samples=4"}, 1e-4, 0.005}, Case{{"jitter=hash"}, 1e-4, 0.005}, Case{{"coarsest=4"}, 1e-4, 0.005}}) {
    const Picture picture = fragments(study.shot, c.settings);
    const std::vector<Vec3d> found = colors(picture.frame);
    const std::string name = c.settings.empty() ? "default" : c.settings[0];
    EXPECT_LE(nmse(found, study.truth), c.error) << name;
    EXPECT_NEAR(sum(found) / sum(study.truth), 1, c.energy) << name;
    EXPECT_LT(picture.statistics.method_statistics.at("level0_fragments"), 0.5 * 200 * 134) << name;
  }
}

// The looser the threshold, the fewer fragments and the more error. Under a small lamp: where penumbrae are wide the noise of small
// fragments' few rays outweighs what they gain. Errors are noisy: the mean of four seeds.
TEST(FragmentPictures, GetNoWorseByStricterThresholds) {
  Scene scene = bare_floor(Occluder::box);
  scene.lights.push_back({.name = "lamp", .shape = lamp({0.2f, 4, -0.1f}, 0.1f), .node = {}});
  const Shot shot = shot_of(std::move(scene), {200, 134});
  const std::vector<Vec3d> truth = colors(one_hit(shot, 512).frame);
  const auto check = [&](const std::vector<std::vector<std::string>>& from_strict_to_loose) {
    double fragments_before = 1e30, error_before = 0;
    for (const auto& settings : from_strict_to_loose) {
      double count = 0, error = 0;
      for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const Picture picture = expose(shot, {.method = "fragments", .settings = settings, .spp = 1, .max_bounces = 0, .seed = seed});
        count += picture.statistics.method_statistics.at("fragments"), error += nmse(colors(picture.frame), truth);
      }
      EXPECT_LT(count, fragments_before) << settings[0] << ", " << settings[1];
      EXPECT_GE(error, 0.95 * error_before) << settings[0] << ", " << settings[1];
      fragments_before = count, error_before = error;
    }
  };
  // Without an early out: what a few rays take for all or nothing is split again beside others, as often as chance will have it.
  for (const char* variant : {"variant=sightline", "variant=koa"}) {
    check({{variant, "gradient=0", "early_out=off"},
           {variant, "gradient=7", "early_out=off"},
           {variant, "strict_threshold=on", "early_out=off"}});
  }
  check({{"variant=nichols", "nichols_threshold=1"},
         {"variant=nichols", "nichols_threshold=6"},
         {"variant=nichols", "nichols_threshold=16"}});
}

TEST(FragmentPictures, OfSurfacesSplitByGeometryHaveMoreFragmentsTheStricterItsThresholds) {
  Scene scene = builtin_scene("spheres");
  scene.environment.reset();
  const Shot shot = shot_of(std::move(scene), {200, 150});
  std::vector<double> counts;
  for (const char* tau : {"0.01", "0.05", "0.2", "1"})
    counts.push_back(fragments(shot, {"variant=koa", std::string("tau_n=") + tau}).statistics.method_statistics.at("fragments"));
  EXPECT_TRUE(std::ranges::is_sorted(counts, std::greater<>()));
  EXPECT_GT(counts.front(), 1.1 * counts.back());
}

/// Lights of every flat kind over surfaces of several, with textures and gloss.
Scene many_lights() {
  Scene scene = box_on_floor();
  Texture even, odd, board;
  even.node = ConstantTexture{Vec4(0.8f, 0.7f, 0.2f, 1)}, odd.node = ConstantTexture{Vec4(0.1f, 0.2f, 0.3f, 1)};
  scene.textures = {even, odd};
  CheckerboardTexture checkers{TextureId(0), TextureId(1), {}};
  checkers.uv.matrix = glm::mat2(12.f);
  board.node = checkers;
  scene.textures.push_back(board);
  DiffuseMaterial textured;
  textured.reflectance.texture = TextureId(2);
  scene.materials[0].model = textured;
  scene.meshes[0].uvs = std::vector<Vec2>{{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  scene.materials[1].model = MetallicRoughnessMaterial{.base_color = Color(0.7f, 0.4f, 0.3f), .metallic = 0.3f, .roughness = 0.5f};
  scene.lights.push_back(
      {.name = "disk",
       .shape = DiskLight{.center = {-1.5f, 2.5f, 1}, .half_u = {0.4f, 0, 0}, .half_v = {0, 0, 0.4f}, .radiance = {4, 5, 9}},
       .node = {}});
  const MaterialId glowing = add_material(scene, DiffuseMaterial{.reflectance = Color(0)}, Color(6, 2, 2));
  place(scene, make_mesh({{1.6f, 2, 1.4f}, {2, 2.4f, 1}, {1.5f, 2.2f, 0.8f}}, {{0, 1, 2}}), glowing);
  return scene;
}

TEST(FragmentPictures, OfAllRefinedAreTheReferencesBitForBit) {
  Scene plain = box_on_floor(), glossy = many_lights();
  Scene spheres = builtin_scene("spheres");
  for (auto& [scene, size] : std::initializer_list<std::pair<const Scene&, IVec2>>{
           {plain, {131, 67}}, {glossy, {131, 67}}, {spheres, {131, 67}}, {glossy, {1, 1}}, {glossy, {129, 3}}}) {
    const Shot shot = shot_of(scene, size);
    for (const int samples : {16, 64}) {
      const Picture picture = expose(
          shot, {.method = "fragments", .settings = {"refine=all"}, .spp = 1, .light_samples = samples, .max_bounces = 0, .threads = 3});
      EXPECT_TRUE(same_sums(picture.frame, one_hit(shot, samples).frame)) << size.x << " x " << size.y << ", " << samples;
    }
  }
}

// Fragments under lights of every kind, one after the other; the truth is theirs together.
TEST(FragmentPictures, OfManyLightsAreCloseToConvergedOnes) {
  const Shot shot = shot_of(many_lights(), {120, 80});
  const std::vector<Vec3d> truth = colors(one_hit(shot, 512).frame);
  for (const char* variant : {"variant=sightline", "variant=koa"}) {
    const std::vector<Vec3d> c = colors(fragments(shot, {variant}).frame);
    EXPECT_LE(nmse(c, truth), 1e-3) << variant;
    EXPECT_NEAR(sum(c) / sum(truth), 1, variant[8] == 's' ? 0.005 : 0.02) << variant;
  }
}

Light disk_light() {
  return {.name = "disk",
          .shape = DiskLight{.center = {0.2f, 4, -0.1f}, .half_u = {0.6f, 0, 0}, .half_v = {0, 0, 0.4f}, .radiance = Color(8)},
          .node = {}};
}
/// A ball of 2 x 8 x 16 triangles around (0.2, 4, 0), 224 of which have an area.
Mesh ball() {
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  constexpr std::uint32_t kRings = 8, kColumns = 16;
  for (std::uint32_t r = 0; r <= kRings; ++r) {
    for (std::uint32_t c = 0; c < kColumns; ++c) {
      const float theta = kPi * static_cast<float>(r) / kRings, phi = 2 * kPi * static_cast<float>(c) / kColumns;
      positions.push_back(Vec3(0.2f, 4, 0) +
                          0.4f * Vec3(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi)));
      if (r == kRings) continue;
      const std::uint32_t i = r * kColumns + c, j = r * kColumns + (c + 1) % kColumns;
      if (r > 0) triangles.push_back({i, i + kColumns, j});
      if (r + 1 < kRings) triangles.push_back({j, i + kColumns, j + kColumns});
    }
  }
  return make_mesh(positions, triangles);
}

TEST(FragmentPictures, OfEveryKindOfFlatLightAreCloseToConvergedOnes) {
  struct Case {
    const char* name;
    std::function<void(Scene&)> light;
    int samples = 512;
    double energy = 0.006;  // of the default; what is not analytic interpolates irradiance, as the paper does
  };
  const auto triangle = [](Scene& scene, bool two_sided, bool upside_down) {
    const MaterialId glowing = add_material(scene, DiffuseMaterial{.reflectance = Color(0)}, Color(9, 8, 6));
    scene.materials[glowing.index].emission_two_sided = two_sided;
    place(scene, make_mesh({{-0.4f, 4, -0.4f}, {0.8f, 4, -0.4f}, {0, 4.2f, 0.7f}}, {upside_down ? UVec3(0, 2, 1) : UVec3(0, 1, 2)}),
          glowing);
  };
  const std::vector<Case> cases = {
      {"disk", [](Scene& scene) { scene.lights.push_back(disk_light()); }},
      {"triangle", [&](Scene& scene) { triangle(scene, false, false); }},
      {"triangle with two sides", [&](Scene& scene) { triangle(scene, true, true); }},
      {"triangle with two sides, the other way", [&](Scene& scene) { triangle(scene, true, false); }},
      {"textured square",
       [](Scene& scene) {
         // Eight fields, so that its parts cast shadows of their own.
         Texture even, odd, board;
         even.node = ConstantTexture{Vec4(1, 0.9f, 0.2f, 1)}, odd.node = ConstantTexture{Vec4(0.1f, 0.2f, 0.6f, 1)};
         CheckerboardTexture checkers{TextureId(0), TextureId(1), {}};
         checkers.uv.matrix = glm::mat2(4, 0, 0, 2);
         board.node = checkers;
         scene.textures = {even, odd, board};
         const MaterialId glowing = add_material(scene, DiffuseMaterial{.reflectance = Color(0)}, Color(9));
         scene.materials[glowing.index].emission.texture = TextureId(2);
         Mesh mesh = make_mesh({{-0.3f, 4, -0.6f}, {0.7f, 4, -0.6f}, {0.7f, 4, 0.4f}, {-0.3f, 4, 0.4f}}, {{0, 1, 2}, {0, 2, 3}});
         mesh.uvs = std::vector<Vec2>{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
         place(scene, std::move(mesh), glowing);
       },
       512, 0.02},
      {"ball", [](Scene& scene) { place(scene, ball(), add_material(scene, DiffuseMaterial{.reflectance = Color(0)}, Color(5, 4, 3))); },
       1024},
  };
  for (const Case& c : cases) {
    Scene scene = bare_floor(Occluder::box);
    c.light(scene);
    const Shot shot = shot_of(std::move(scene), {96, 64});
    const std::vector<Vec3d> truth = colors(one_hit(shot, c.samples).frame);
    ASSERT_GT(sum(truth), 100) << c.name;
    for (const char* variant : {"variant=sightline", "variant=koa"}) {
      const std::vector<Vec3d> picture = colors(fragments(shot, {variant}).frame);
      EXPECT_LE(nmse(picture, truth), 1e-3) << c.name << ", " << variant;
      EXPECT_NEAR(sum(picture) / sum(truth), 1, variant[8] == 's' ? c.energy : 0.02) << c.name << ", " << variant;
    }
  }
}

// The tails of lobes at grazing angles, beside shadows: what linearly transformed cosines get wrong by up to 0.17.
TEST(FragmentPictures, OfGlossyFloorsLookLikeConvergedOnes) {
  const auto image = [](const Frame& frame) {
    ColorImage result(frame.width(), frame.height());
    for (std::uint32_t i = 0; i < result.pixels.size(); ++i) result.pixels[i] = frame.color(i);
    return result;
  };
  for (const float metallic : {0.f, 1.f}) {
    for (const float roughness : {0.2f, 0.4f, 0.6f}) {
      Scene scene;
      const MetallicRoughnessMaterial gloss{.base_color = Color(metallic > 0 ? 0.8f : 0.05f), .metallic = metallic, .roughness = roughness};
      place(scene, floor_mesh(10), add_material(scene, gloss));
      place(scene, box_mesh({-0.5f, 0, -1.5f}, {0.5f, 1.5f, -0.5f}), add_material(scene, DiffuseMaterial{.reflectance = Color(0.6f)}));
      scene.cameras.push_back(camera_at({0.5f, 2.2f, 7}, {0, 0.8f, 0}, 0.85f));
      scene.lights.push_back({.name = "lamp", .shape = lamp({0, 5, 0}, 1.5f), .node = {}});
      const Shot shot = shot_of(std::move(scene), {120, 90});
      const ColorImage truth = image(one_hit(shot, 512).frame);
      const auto flip = [&](std::vector<std::string> settings) {
        return find_metric("flip").compute(truth, image(fragments(shot, std::move(settings)).frame), {});
      };
      EXPECT_LT(flip({}), 0.02) << metallic << " " << roughness;
      if (metallic > 0) {
        EXPECT_GT(flip({"glossy=ltc"}), flip({})) << roughness;
      }
    }
  }
}

// Lamps of the same power, seen under 0.007, 0.1 and 1.3 steradians at the most: 20, 32 and 64 rays a pixel in penumbrae.
TEST(FragmentPictures, TraceMoreRaysAPixelTheLargerTheLightLooks) {
  const auto rays_a_pixel = [](float half_width, const char* by_size) {
    Scene scene = bare_floor(Occluder::box);
    scene.lights.push_back({.name = "lamp", .shape = lamp({0.2f, 4, -0.1f}, half_width, Color(2 / (half_width * half_width))), .node = {}});
    const Picture picture = fragments(shot_of(scene, {200, 134}), {by_size});
    return picture.statistics.method_statistics.at("level0_rays") / picture.statistics.method_statistics.at("level0_fragments");
  };
  const auto change = [&](float half_width) {
    return rays_a_pixel(half_width, "rays_by_size=on") / rays_a_pixel(half_width, "rays_by_size=off");
  };
  EXPECT_LT(change(0.17f), 0.85);
  EXPECT_NEAR(change(0.65f), 1, 0.05);
  EXPECT_GT(change(3), 1.3);
  // Its rival by neighbours does not look at the size.
  const Study& study = Study::of_box();
  const auto by_neighbours = [&](const char* by_size) {
    return fragments(study.shot, {"refine=nichols", by_size}).statistics.method_statistics.at("level0_rays");
  };
  EXPECT_EQ(by_neighbours("rays_by_size=on"), by_neighbours("rays_by_size=off"));
}

TEST(FragmentPictures, AreBlackWhereAllLightIsBlocked) {
  const Shot shot = shot_of(lamp_over_floor(Occluder::everything), {140, 60});
  for (const char* variant : {"variant=sightline", "variant=koa", "variant=nichols"})
    EXPECT_EQ(sum(colors(fragments(shot, {variant}).frame)), 0) << variant;
}

TEST(FragmentPictures, WithoutShadowsAreTheAnalyticTerm) {
  const Shot shot = shot_of(lamp_over_floor(Occluder::none), {140, 60});
  const std::vector<Vec3d> c = colors(fragments(shot, {}).frame), truth = colors(one_hit(shot, 1024).frame);
  for (std::size_t i = 0; i < c.size(); ++i) ASSERT_NEAR(c[i].x, truth[i].x, 1e-3 * truth[i].x) << i;
}

TEST(FragmentPictures, AreTheSameForAnyNumberOfThreads) {
  const Shot shot = shot_of(many_lights(), {300, 140});
  for (const char* variant : {"variant=sightline", "variant=koa", "variant=nichols"}) {
    const Picture one = fragments(shot, {variant}, 1);
    for (const int threads : {2, 4})
      EXPECT_TRUE(same_sums(one.frame, fragments(shot, {variant}, threads).frame)) << variant << ", " << threads;
  }
}

// A picture's arrays are kept for the next one of the same size.
TEST(FragmentPictures, OweNothingToThePictureBefore) {
  const Shot lights = shot_of(many_lights(), {300, 140}), other = shot_of(bare_floor(Occluder::box), {300, 140});
  const Shot small = shot_of(many_lights(), {64, 64});
  for (const char* variant : {"variant=sightline", "variant=koa", "variant=nichols"}) {
    fragments(small, {variant});  // of another size: the next one starts with new arrays
    const Picture first = fragments(lights, {variant});
    fragments(other, {variant});
    EXPECT_TRUE(same_sums(first.frame, fragments(lights, {variant}).frame)) << variant;
  }
}

TEST(FragmentPictures, MayHaveAnySize) {
  Scene scene = many_lights();
  for (const IVec2 size : {IVec2(1, 1), IVec2(129, 3), IVec2(2, 131), IVec2(128, 128)}) {
    const Shot shot = shot_of(scene, size);
    const std::vector<Vec3d> truth = colors(one_hit(shot, 256).frame);
    for (const char* variant : {"variant=sightline", "variant=koa", "variant=nichols", "upsample=multipass", "upsample=quad4"}) {
      const Picture picture = fragments(shot, {variant});
      EXPECT_EQ(picture.frame.samples_done(), 1u);
      EXPECT_EQ(picture.frame.nonfinite_samples(), 0u);
      EXPECT_NEAR(sum(colors(picture.frame)) / sum(truth), 1, size.x * size.y < 10 ? 0.2 : 0.03)
          << variant << ", " << size.x << " x " << size.y;
    }
  }
}

// Cut short in the first of two samples, in the second, and when only some tiles have got their second.
TEST(FragmentPictures, ResumedHalfwayAreThoseOfOneGo) {
  const Shot shot = shot_of(many_lights(), {200, 140});
  const Exposure exposure{.method = "fragments", .spp = 2, .max_bounces = 0};
  const Picture whole = expose(shot, exposure);
  struct Case {
    double fraction;  // of the work
    std::uint32_t least, most;
  };
  for (const Case& c : {Case{0.3, 0, 0}, Case{0.75, 1, 1}, Case{0.985, 1, 2}}) {
    Picture resumed{empty_frame(shot, exposure), {}};
    Context first;
    first.threads = 1;
    first.progress = [&](const Progress& p) {
      if (p.done >= c.fraction * p.total) first.cancelled = true;
    };
    EXPECT_THROW(expose_range(shot, exposure, {0, 2}, resumed, first), Error) << c.fraction;
    EXPECT_EQ(std::ranges::min(resumed.frame.samples_per_tile()), c.least) << c.fraction;
    EXPECT_EQ(std::ranges::max(resumed.frame.samples_per_tile()), c.most) << c.fraction;
    Context second;
    second.threads = 3;
    expose_range(shot, exposure, {0, 2}, resumed, second);
    EXPECT_TRUE(same_sums(whole.frame, resumed.frame)) << c.fraction;
  }
}

/// Exact rays, until it cancels after so many batches.
class Interrupting final : public Visibility {
 public:
  Interrupting(std::unique_ptr<Visibility> visibility, Context& context, int batches)
      : visibility_(std::move(visibility)), context_(context), left_(batches) {}
  bool exact() const override { return true; }
  void begin_pass(const VisibilityPass& pass, const Context& context) override { visibility_->begin_pass(pass, context); }
  std::unique_ptr<VisibilityWorker> worker() override { return std::make_unique<Worker>(visibility_->worker(), *this); }

 private:
  struct Worker final : VisibilityWorker {
    Worker(std::unique_ptr<VisibilityWorker> w, Interrupting& o) : worker(std::move(w)), owner(o) {}
    void begin(std::uint32_t scope) override { worker->begin(scope); }
    bool exact() const override { return true; }
    void visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) override {
      if (--owner.left_ == 0) owner.context_.cancelled = true;
      worker->visible(queries, weights, rays, counts);
    }
    std::unique_ptr<VisibilityWorker> worker;
    Interrupting& owner;
  };
  std::unique_ptr<Visibility> visibility_;
  Context& context_;
  std::atomic<int> left_;
};

/// One pass with any visibility and nothing else around it.
void render(const Shot& shot, Visibility& visibility, const std::vector<std::string>& settings, Context& context, Picture& picture) {
  const Method& method = find_method("fragments");
  const View view(shot.camera, shot.size_px, PixelFilter(PixelFilter::Kind::centre));
  RenderJob job;
  job.world = shot.world, job.view = &view, job.visibility = &visibility;
  job.settings = method.default_settings();
  for (const std::string& setting : settings) job.settings.apply(setting);
  method.check(shot.world->scene(), job);
  method.render_pass(job, {0, 1}, picture.frame, picture.statistics, context);
}
std::unique_ptr<Visibility> make_visibility(const Shot& shot, const char* name) {
  const VisibilityInfo& info = find_visibility(name);
  return info.make(shot.world, info.settings, Context());
}

TEST(FragmentPictures, InterruptedAmongTheirRaysAndResumedAreThoseOfOneGo) {
  const Shot shot = shot_of(box_on_floor(), {300, 140});
  for (const char* variant : {"variant=sightline", "variant=nichols"}) {
    const Picture whole = fragments(shot, {variant});
    for (const int batches : {1, 7, 30}) {
      Context context;
      context.threads = 2;
      Picture picture{empty_frame(shot, {}), {}};
      Interrupting interrupting(make_visibility(shot, "exact"), context, batches);
      EXPECT_THROW(render(shot, interrupting, {variant}, context, picture), Error) << batches;
      EXPECT_EQ(picture.frame.samples_done(), 0u);
      context.cancelled = false;
      render(shot, *make_visibility(shot, "exact"), {variant}, context, picture);
      EXPECT_TRUE(same_sums(whole.frame, picture.frame)) << variant << ", " << batches;
    }
  }
}

TEST(FragmentPictures, MayAskACache) {
  const Study& study = Study::of_box();
  for (const char* variant : {"variant=sightline", "variant=koa", "variant=nichols"}) {
    std::vector<Picture> pictures;
    for (const int threads : {1, 3}) {
      Context context;
      context.threads = threads;
      pictures.push_back({empty_frame(study.shot, {}), {}});
      render(study.shot, *make_visibility(study.shot, "cached"), {variant}, context, pictures.back());
    }
    EXPECT_TRUE(same_sums(pictures[0].frame, pictures[1].frame)) << variant;
    const VisibilityCounts& counts = pictures[0].statistics.visibility;
    EXPECT_GT(counts.cached, 0u) << variant;
    EXPECT_LE(counts.traced, counts.queries) << variant;
    EXPECT_LE(nmse(colors(pictures[0].frame), study.truth), 2e-2) << variant;
    EXPECT_NEAR(sum(colors(pictures[0].frame)) / sum(study.truth), 1, 0.03) << variant;
  }
}

TEST(FragmentPictures, NeedAnswersOfYesOrNo) {
  const Shot shot = shot_of(lamp_over_floor(Occluder::box), {8, 8});
  Context context;
  Picture picture{empty_frame(shot, {}), {}};
  try {
    render(shot, *make_visibility(shot, "nee++"), {}, context, picture);
    FAIL() << "a visibility of probabilities was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("yes or no"), std::string::npos);
  }
}

}  // namespace
}  // namespace sightline::test
