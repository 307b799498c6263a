// What every method in the table promises, on the builtin scenes: a new method is tested by being registered.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "base/core/error.h"
#include "session/render.h"
#include "support/picture_statistics.h"

namespace sightline::test {
namespace {

const char* const kScenes[] = {"cornell",
                               "glass",
                               "veach-like",
                               "textured",
                               "spheres",
                               "furnace",
                               "furnace,shape=box",
                               "hairball,triangles=2000",
                               "quad",
                               "two-quads",
                               "lit-sphere-inside",
                               "half-plane",
                               "half-plane,light=directional",
                               "isosurface,triangles=3000",
                               "plant,triangles=20000",
                               "open-room,content=cornell",
                               "ground,content=spheres"};
constexpr IVec2 kSize{70, 40};

bool handles(const Method& method, const Scene& scene) {
  try {
    check_supported(method, scene);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Every method with every scene that it handles.
template <class Body>
void for_all(const Body& body) {
  for (const char* name : kScenes) {
    Scene scene = builtin_scene(name);
    // A tracer sees geometry only; light from everywhere where the scene has none.
    if (scene.lights.empty() && !scene.environment &&
        std::ranges::all_of(scene.materials, [](const Material& m) { return is_black(m.emission.value); }))
      scene.environment = Environment{};
    if (scene.cameras.empty()) scene.cameras.push_back(framing_camera(scene.framing.value_or(scene_bounds(scene))));
    std::optional<Shot> shot;
    for (const Method* method : methods()) {
      if (!handles(*method, scene)) continue;
      if (!shot) shot = shot_of(scene, kSize);
      SCOPED_TRACE(method->info().name + " on " + name);
      body(*method, *shot);
    }
  }
}

Exposure exposure_for(const Method& method) {
  return {.method = method.info().name,
          .spp = 3,
          .max_bounces = 3,
          .seed = 3,
          .filter = PixelFilter::Kind::gaussian,
          .aovs = parse_aovs("all")};
}

TEST(Conformance, SamplesAreFinite) {
  for_all([](const Method& method, const Shot& shot) {
    const Picture picture = expose(shot, exposure_for(method));
    EXPECT_EQ(picture.frame.nonfinite_samples(), 0u);
    EXPECT_EQ(picture.frame.saturated_samples(), 0u);
    EXPECT_EQ(picture.frame.samples_done(), 3u);
    EXPECT_GT(picture.frame.mean_luminance(), 0);
    EXPECT_GT(picture.statistics.rays.closest + picture.statistics.rays.occlusion, 0u);
    for (std::uint32_t pixel = 0; pixel < kSize.x * kSize.y; ++pixel) {
      const Color c = picture.frame.color(pixel);
      ASSERT_TRUE(std::min(c.x, std::min(c.y, c.z)) >= 0) << "pixel " << pixel;
    }
  });
}

TEST(Conformance, AlphaIsTheShareOfSamplesThatHitSomething) {
  for_all([](const Method& method, const Shot& shot) {
    Exposure exposure = exposure_for(method);
    exposure.spp = 2, exposure.max_bounces = 0;
    const Picture picture = expose(shot, exposure);
    for (std::uint32_t pixel = 0; pixel < kSize.x * kSize.y; ++pixel) {
      const Vec3 surface = picture.frame.value(Aov::surface, pixel);
      ASSERT_EQ(picture.frame.value(Aov::alpha, pixel).x, surface.x + surface.y) << "pixel " << pixel;
    }
  });
}

TEST(Conformance, ThreadsDoNotChangeTheBitsOfDeterministicMethods) {
  for_all([](const Method& method, const Shot& shot) {
    if (!method.info().deterministic) return;
    Exposure exposure = exposure_for(method);
    exposure.threads = 1;
    const Picture one = expose(shot, exposure);
    exposure.threads = 5;
    EXPECT_TRUE(same_sums(one.frame, expose(shot, exposure).frame));
  });
}

TEST(Conformance, PassesOfProgressiveMethodsAddUp) {
  for_all([](const Method& method, const Shot& shot) {
    if (!method.info().progressive) return;
    const Exposure exposure = exposure_for(method);
    Context context;
    context.seed = exposure.seed;
    Picture passes{empty_frame(shot, exposure), {}};
    RenderJob job;
    job.world = shot.world;
    job.settings = method.default_settings();
    job.total_spp = static_cast<std::uint32_t>(exposure.spp);
    const std::uint32_t multiple = method.pass_multiple(job);
    for (std::uint32_t begin = 0; begin < job.total_spp; begin += multiple)
      expose_range(shot, exposure, {begin, std::min(begin + multiple, job.total_spp)}, passes, context);
    EXPECT_TRUE(same_sums(expose(shot, exposure).frame, passes.frame));
  });
}

TEST(Conformance, SeedsMatter) {
  const Shot shot = shot_of(builtin_scene("cornell"), kSize);
  for (const Method* method : methods()) {
    if (!handles(*method, shot.world->scene())) continue;
    Exposure exposure = exposure_for(*method);
    const Picture one = expose(shot, exposure);
    exposure.seed = 4;
    EXPECT_FALSE(same_sums(one.frame, expose(shot, exposure).frame)) << method->info().name;
  }
}

TEST(Conformance, UnbiasedMethodsAgreeWithTheReference) {
  for (const char* name : {"cornell", "spheres", "two-quads"}) {
    const Shot shot = shot_of(builtin_scene(name), {16, 12});
    const Exposure exposure{.spp = 32, .max_bounces = 3, .seed = 1};
    const Replicates reference = replicate(shot, exposure, 24);
    for (const Method* method : methods()) {
      if (!method->info().unbiased || !handles(*method, shot.world->scene())) continue;
      Exposure other = exposure;
      other.method = method->info().name;
      other.seed = 2;
      const PictureTest test = compare(reference, replicate(shot, other, 24));
      EXPECT_GT(test.pixel_p, 1e-3) << other.method << " on " << name << ": " << test.worst;
      EXPECT_GT(test.mean_p, 1e-3) << other.method << " on " << name << ": " << test.worst;
    }
  }
}

Light light_of_kind(LightKind kind) {
  Light light{.name = "lamp", .shape = PointLight{}, .node = {}};
  if (kind == LightKind::spot) light.shape = SpotLight{};
  if (kind == LightKind::directional) light.shape = DirectionalLight{};
  if (kind == LightKind::rectangle) light.shape = RectangleLight{};
  if (kind == LightKind::disk) light.shape = DiskLight{};
  if (kind == LightKind::sphere) light.shape = SphereLight{};
  return light;
}

TEST(Conformance, LightsAreHandledOrRefusedAsTheInfoSays) {
  for (const Method* method : methods()) {
    const std::vector<LightKind>& known = method->info().lights;
    EXPECT_FALSE(known.empty()) << method->info().name;
    for (int k = 0; k <= static_cast<int>(LightKind::environment); ++k) {
      const LightKind kind = static_cast<LightKind>(k);
      Scene scene = builtin_scene("quad");
      scene.lights.clear();
      if (kind == LightKind::environment) {
        scene.environment = Environment{};
      } else if (kind == LightKind::mesh) {
        scene.materials[0].emission = Color(1);
      } else {
        scene.lights.push_back(light_of_kind(kind));
      }
      const Shot shot = shot_of(std::move(scene), {8, 8});
      RenderRequest request;
      request.method = method->info().name;
      request.spp = 1;
      const auto take = [&] { render(shot.world, shot.camera, shot.size_px, PixelFilter(), request, Context(), Stopwatch()); };
      if (std::ranges::find(known, kind) != known.end()) {
        EXPECT_NO_THROW(take()) << method->info().name << ", " << name_of(kind);
        continue;
      }
      try {
        take();
        ADD_FAILURE() << method->info().name << " takes the light it does not know: " << name_of(kind);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::usage) << error.what();
      }
    }
  }
}

TEST(Conformance, CancellingLeavesWholeTiles) {
  const Shot shot = shot_of(builtin_scene("cornell"), {160, 160});
  for (const Method* method : methods()) {
    if (!handles(*method, shot.world->scene())) continue;
    const Exposure exposure = exposure_for(*method);
    Context context;
    context.threads = 2;
    std::atomic<int> reports{0};
    context.progress = [&](const Progress&) {
      if (++reports == 6) context.cancelled = true;
    };
    Picture picture{empty_frame(shot, exposure), {}};
    try {
      expose_range(shot, exposure, {0, 3}, picture, context);
      ADD_FAILURE() << method->info().name << " ignores cancellation";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::interrupted);
    }
    // What is there is right: going on from it gives what one run gives.
    context.cancelled = false;
    context.progress = {};
    context.seed = exposure.seed;
    Exposure same = exposure;
    same.seed = 0;
    Context plain;
    Picture whole{empty_frame(shot, same), {}};
    expose_range(shot, same, {0, 3}, whole, plain);
    context.seed = 0;
    expose_range(shot, same, {0, 3}, picture, context);
    EXPECT_TRUE(same_sums(whole.frame, picture.frame)) << method->info().name;
  }
}

}  // namespace
}  // namespace sightline::test
