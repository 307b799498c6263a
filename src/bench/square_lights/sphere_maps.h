// An environment as the method sees it, as latitude-longitude pictures.
#pragma once

#include <cstdint>
#include <span>

#include "image/image.h"
#include "methods/square_lights/light_cube.h"
#include "methods/square_lights/merge_tree.h"
#include "world/world.h"

namespace sightline {

/// The world's environment as a cube map, in its own frame.
square_lights::LightCube bench_light_cube(const World& world, int size, const Context& context);
/// Its texels.
ColorImage cube_picture(const square_lights::LightCube& cube);
/// The regions that `count` lights stand for, each in a colour of its own.
ColorImage region_picture(const square_lights::LightCube& cube, const square_lights::MergeTree& tree, std::size_t count);
/// The same from the region of each texel.
ColorImage region_picture(const square_lights::LightCube& cube, std::span<const std::uint32_t> region);
/// The squares, one over the other, each turned to north.
ColorImage square_picture(const square_lights::MergeTree& tree, std::size_t count);
ColorImage square_picture(std::span<const square_lights::SquareLight> lights);

}  // namespace sightline
