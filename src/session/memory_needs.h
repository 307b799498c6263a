// What a picture and all that it is made with will hold, weighed against --memory-limit before it is allocated.
#pragma once

#include <cstdint>

#include "base/core/context.h"
#include "session/render.h"

namespace sightline {

/// Bytes, by what holds them. What is not known yet is 0.
struct MemoryNeeds {
  std::uint64_t scene = 0;         ///< arrays, images and textures
  std::uint64_t acceleration = 0;  ///< what the tracer built
  std::uint64_t picture = 0;       ///< exact sums of all layers and of the light image, and the copies made while a file is written
  std::uint64_t visibility = 0;    ///< tables
  std::uint64_t total() const { return scene + acceleration + picture + visibility; }
};

/// The picture and its visibility's tables, without a World. Throws Error{usage} where the request names what does not exist.
MemoryNeeds picture_needs(IVec2 size_px, const RenderRequest& request, bool light_image, const Context& context);
/// The World's share, added to those.
MemoryNeeds with_world(MemoryNeeds needs, const World& world);
/// Throws Error{resource} that names each part if all of it together exceeds the memory budget, or, without a budget, the machine.
void check_memory(const MemoryNeeds& needs, const Context& context);

}  // namespace sightline
