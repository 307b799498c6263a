// The path "court walk" of camera and light: a pure function of the frame.
#pragma once

#include "bench/bench_shot.h"
#include "scene/camera.h"
#include "scene/scene.h"

namespace sightline {

/// How far camera and light have moved in a frame, in metres of the court.
struct CourtWalk {
  float forward = 0, side = 0, up = 0;  ///< of the camera, along its own horizontal axes and +Y
  float turn_rad = 0;                   ///< of the camera about +Y, counter-clockwise from above
  float light_x = 0;                    ///< of the light, along +X
};

/// Frame `frame` of `frames`: the camera walks 8 m along the court, swaying by half a metre and looking from side to side; the light goes
/// from end to end, 6 m to either side of its place, and back.
CourtWalk court_walk(int frame, int frames);

/// Scene units a metre: 1 in the court, and elsewhere as many as its size is of the court's.
float path_scale(const BuiltView& view);

/// The camera moved; `scale` is scene units a metre.
Camera walked(const Camera& camera, const CourtWalk& walk, float scale);
/// The scene with its rectangles moved. True if it has any.
bool move_lights(Scene& scene, const CourtWalk& walk, float scale);

}  // namespace sightline
