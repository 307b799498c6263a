// The settings resolved: what a variant stands for, in the terms of the stages.
#pragma once

#include "methods/fragments/compose.h"
#include "methods/fragments/finest_test.h"
#include "methods/fragments/fragment.h"
#include "methods/fragments/pyramid.h"
#include "methods/fragments/settings.h"
#include "methods/fragments/upsample.h"

namespace sightline {

struct FragmentOptions {
  enum class Refine { probes, neighbours, all } refine = Refine::probes;
  GeometryOptions geometry;
  SplitOptions split;
  FinestOptions finest;
  UpsampleOptions upsample;
  bool ratio = true;  ///< interpolate the visible share; else irradiance
  bool interpolate_probes = true;
  bool smooth = true;
  bool dark_culling = true;
  PointJitter jitter = PointJitter::blue;
  bool sparse_tests = true;  ///< small fragments trace a quarter of their rays first
  bool extra_samples = true;
  int extra_level = 3;                  ///< of the smallest fragments that take them
  int confirm = 1;                      ///< probes that confirm a stable fragment of level 3 or more
  bool rays_by_size = true;             ///< of pixels: twice as many where a light looks large, fewer where it looks small
  int penumbra_level = 2;               ///< stable fragments from this level on that partly see the light trace more rays
  int border_rounds = 3;                ///< how often fragments beside jumps of the signal are refined again
  float border_jump = 0.25f;            ///< in shares of the light
  float border_jump_saturated = 0.05f;  ///< the same beside fragments that see all or nothing of it
  int nichols_threshold = 6;
  GlossyTerm glossy = GlossyTerm::quadrature;
  int edge_samples = 1;   ///< camera rays a pixel on geometric edges
  bool temporal = false;  ///< take over what the last picture knows
};

FragmentOptions resolve(const FragmentsSettings& settings);

}  // namespace sightline
