// What Embree alone can do: the same rays as a picture by the reference method, with the least possible shading and no film.
//
// The loops generate their rays inside the timed part (hashed numbers, rectangle samples, cosine-weighted directions), sum what arrives,
// and hand blocks of 16 rays to Embree one by one, as 8-wide or as 16-wide packets, with or without the coherent flag. The product is
// compared with the fastest of these.
#pragma once

#include <cstdint>

#include "base/core/context.h"
#include "film/frame.h"
#include "film/view.h"
#include "scene/light.h"
#include "trace/embree/packets.h"

namespace sightline {

/// One picture to be made by a bare loop: geometry, a pinhole view, one rectangle light.
struct BareJob {
  RTCScene scene = nullptr;
  const View* view = nullptr;
  RectangleLight light;
  bool light_is_geometry = false;  ///< then BSDF rays may find it (MIS), recognised by `light_geometry`
  std::uint32_t light_geometry = 0;
  float albedo = 0.7f;
  float epsilon = 1e-4f;  ///< offset of secondary rays, world units
  int tile_step = 1;      ///< only every so many tiles of 32x32 pixels
};

struct BareStyle {
  CallStyle primary{16, true}, shadow{16, true}, bounce{1, false};
};

struct BareResult {
  double seconds = 0;
  std::uint64_t rays = 0;
  double sum = 0;  ///< of what arrived, so that nothing can be optimised away; also a sanity check against the picture's mean
};

/// One primary ray through each pixel centre, `samples` light samples at the hit.
BareResult bare_one_hit(const BareJob& job, int samples, const BareStyle& style, const Context& context);
/// `samples` of `spp` camera samples a pixel; at each of `bounces` + 1 hits one light sample and one cosine-weighted ray, whose next hit
/// may be the light.
BareResult bare_paths(const BareJob& job, SampleRange samples, int spp, int bounces, const BareStyle& style, const Context& context);
/// Tiles of the whole picture.
int bare_tile_count(const BareJob& job);

/// The same rays as a Tracer gets them, to the same hits: loads, calls, stores, nothing else. One scene, no instances.
void bare_intersect(RTCScene scene, const RayBatch& rays, HitBatch& hits, CallStyle style);
void bare_occluded(RTCScene scene, const RayBatch& rays, std::uint8_t* occluded, CallStyle style);

}  // namespace sightline
