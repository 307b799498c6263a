// Options that users write as text: vectors, sizes, lights.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/math/vec.h"
#include "film/frame.h"
#include "scene/light.h"

namespace sightline {

/// "X,Y,Z"; throws Error{usage} naming `option`.
Vec3 parse_vec3(std::string_view option, std::string_view text);
/// "WxH", whole numbers from 1 to 65536.
IVec2 parse_size(std::string_view option, std::string_view text);
/// "A:B", half-open.
SampleRange parse_sample_range(std::string_view option, std::string_view text);

struct FrameRange {
  int first = 0, last = 0, step = 1;
};
/// "A-B" or "A-BxS", inclusive.
FrameRange parse_frame_range(std::string_view option, std::string_view text);

/// "X,Y,Z NX,NY,NZ WxH R,G,B": a one-sided rectangle; width axis = normalize(cross(+Y, N)), or +X where |N.y| > 0.99.
Light parse_light_area(std::string_view text);
/// "X,Y,Z R,G,B", intensity in W/sr.
Light parse_light_point(std::string_view text);
/// "DX,DY,DZ R,G,B", irradiance in W/m².
Light parse_light_directional(std::string_view text);

}  // namespace sightline
