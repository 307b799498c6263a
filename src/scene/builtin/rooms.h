// The stages on which content is shown: room, open-room, ground.
#pragma once

#include "scene/scene.h"

namespace sightline::builtin {

/// Content in the closed room of the standard views: scaled to bounding radius 1 (the ball around the centre of its box), standing on the
/// floor, diffuse 0.7, below a 1x1 light. `open` leaves out ceiling, front wall and light.
Scene place_in_room(Scene content, bool open);

}  // namespace sightline::builtin
