// One function a builtin scene; builtin.cpp lists them.
#pragma once

#include "scene/builtin/builtin.h"

namespace sightline::builtin {

BuiltinScene cornell_scene();
BuiltinScene glass_scene();
BuiltinScene furnace_scene();
BuiltinScene lit_sphere_inside_scene();
BuiltinScene two_quads_scene();
BuiltinScene half_plane_scene();
BuiltinScene quad_scene();
BuiltinScene spheres_scene();
BuiltinScene veach_like_scene();
BuiltinScene textured_scene();
BuiltinScene hairball_scene();
BuiltinScene isosurface_scene();
BuiltinScene plant_scene();
BuiltinScene room_scene();
BuiltinScene open_room_scene();
BuiltinScene ground_scene();
BuiltinScene movers_scene();
BuiltinScene pair_scene();

}  // namespace sightline::builtin
