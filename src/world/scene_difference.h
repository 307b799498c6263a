// What an edit left alone.
#pragma once

#include "base/math/bounds.h"
#include "scene/scene.h"

namespace sightline {

/// Whether both scenes have equal texture nodes on the same images, so that one TextureSet serves both.
bool same_textures(const Scene& a, const Scene& b);

/// Whether one LightTable serves both scenes (given that their textures are the same). May say no where it could say yes.
bool same_lights(const Scene& a, const Scene& b, const Bounds& bounds_a, const Bounds& bounds_b);

/// Whether rays meet the same surfaces in both scenes (given that their textures and lights are the same). May say no where it could say
/// yes.
bool same_surfaces(const Scene& a, const Scene& b);

}  // namespace sightline
