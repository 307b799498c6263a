// A few points that the camera sees, which judge what lights are worth and from which some lights are made.
#pragma once

#include <cstdint>
#include <vector>

#include "film/view.h"
#include "methods/visibility_cache/surface_point.h"
#include "world/world.h"

namespace sightline::vpl {

/// The first surface that scatters on a camera path.
struct Judge {
  Vec3 position{0};
  Vec3 normal{0, 0, 1};  ///< unit geometric, on the side that the path arrived from
  float error = 0;       ///< of the position
  Color weight{0};       ///< throughput of the path, times albedo / pi
  bool translucent = false;
  MediumId medium;  ///< that the path arrived through
};

/// Of `count` camera rays, spread evenly over the picture, lens and passes, those that meet a surface by way of mirrors and glass.
std::vector<Judge> find_judges(const World& world, const View& view, std::uint32_t key, std::uint32_t first, std::size_t count,
                               RayCounts& rays);

}  // namespace sightline::vpl
