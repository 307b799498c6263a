// A point that the eye sees, directly or by way of mirrors and glass: the entries of the deep deferred buffer.
#pragma once

#include <cstdint>

#include "base/math/frame.h"
#include "base/math/vec.h"
#include "scene/ids.h"
#include "shade/bsdf.h"

namespace sightline {

/// One non-delta surface at the end of an eye path. All vectors in world space.
struct EyeSample {
  Vec3 position{0};
  Vec3 geometric_normal{0, 0, 1};  ///< unit, on the side that the path arrived from
  Vec3 wo{0, 0, 1};                ///< unit, back along the path
  Frame3 frame;                    ///< shading frame; its normal sees wo on the side of the winding: from behind wo.z < 0 in it
  Bsdf bsdf;
  Color weight{1};           ///< throughput of the path
  float error = 0;           ///< bound on the rounding error of position, per component
  float area = 0;            ///< a_e = 1 / (N_S P(p_e)): surface that one sample stands for, world units²
  std::uint32_t slot = 0;    ///< which path of TilePaths it belongs to
  std::uint32_t branch = 0;  ///< hash of the turns taken at mirrors and panes; 0 for what the camera sees directly
  std::uint32_t id = 0;      ///< hash of pixel, sample and branch, for random numbers and QueryEnds::id
  MediumId medium, beyond;   ///< that the path arrived through, and on the other side of the surface
};

}  // namespace sightline
