// Pictures for tests: a scene, a view, and what a method makes of them, without session or files.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "film/frame.h"
#include "film/pixel_filter.h"
#include "methods/method.h"
#include "scene/scene.h"
#include "world/world.h"

namespace sightline::test {

/// What a picture is taken of, and from where.
struct Shot {
  std::shared_ptr<const World> world;
  Camera camera;
  IVec2 size_px{16, 16};
};

Scene builtin_scene(std::string_view spec);
/// The scene through its first camera.
Shot shot_of(Scene scene, IVec2 size_px, WorldOptions::Backend backend = WorldOptions::Backend::embree);

/// How a picture is taken. Rays go through pixel centres unless another filter is asked for: then a pixel is one point of the scene, whose
/// radiance may be known.
struct Exposure {
  std::string method = "reference";
  std::vector<std::string> settings{};  ///< "key=value"
  int spp = 16, light_samples = 0, max_bounces = 8;
  bool bsdf_only = false;  ///< the reference without light samples: what BSDF sampling alone finds
  std::uint64_t seed = 0;
  int threads = 2;
  PixelFilter::Kind filter = PixelFilter::Kind::centre;
  AovSet aovs{};
};

struct Picture {
  Frame frame;
  PassStatistics statistics;
};

/// One pass that takes all samples.
Picture expose(const Shot& shot, const Exposure& exposure);
/// Samples `range` of exposure.spp, added to `picture`.
void expose_range(const Shot& shot, const Exposure& exposure, SampleRange range, Picture& picture, const Context& context);
Frame empty_frame(const Shot& shot, const Exposure& exposure, std::uint32_t first_sample = 0);

bool same_sums(const Frame& a, const Frame& b);

/// The ray through a pixel's centre.
void centre_ray(const Shot& shot, std::uint32_t pixel, Vec3& origin, Vec3& direction);

/// The scene grown by `factor` about the origin, cameras and lights with it, such that the picture stays the same.
Scene scaled(Scene scene, float factor);
Scene moved(Scene scene, const Vec3& by);

}  // namespace sightline::test
