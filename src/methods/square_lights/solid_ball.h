// A ball within a solid object: rays into it need not be traced.
#pragma once

#include <span>

#include "base/math/vec.h"
#include "methods/square_lights/shading_scene.h"

namespace sightline::square_lights {

/// Radius of a ball about `center` (in the object's own space) that lies inside the closed, opaque surface of one of the object's meshes,
/// a little less than touching it; 0 where no mesh proves one. From inside a closed surface every ray meets it, so that a ray which passes
/// through the ball is hidden wherever it starts.
float solid_ball(const Scene& scene, const ShadingObject& object, const Vec3& center);

/// The same of one mesh: triangles whose corners are equal are neighbours, whatever their indices.
float solid_ball(std::span<const Vec3> positions, std::span<const UVec3> triangles, const Vec3& center);

}  // namespace sightline::square_lights
