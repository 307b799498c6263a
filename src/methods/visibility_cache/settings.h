// Settings of the visibility-cache method. Those of the cache itself belong to the visibility (src/visibility/cached/settings.h).
#pragma once

#include "base/settings/settings.h"

namespace sightline {

struct VisibilityCacheSettings {
  enum class Order { halton, scanline };

  int light_samples = 16;
  float bsdf_share = 0.25f;
  int vpls = 256;
  int vpl_candidates = 8;
  float vpl_backward = 0.5f;
  float vpl_clamp = 0.02f;
  float vpl_spread = 1;
  int specular_depth = 8;
  float least_weight = 0.01f;
  int pass_spp = 0;
  Order order = Order::halton;
  float order_growth = 3.7f;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    using S = VisibilityCacheSettings;
    visit("light_samples", &S::light_samples,
          {.help = "samples of all area lights together, and of the environment, an eye point (--light-samples sets it)",
           .minimum = 1,
           .maximum = 65536,
           .symbol = "n"});
    visit("bsdf_share", &S::bsdf_share,
          {.help = "share of the environment's samples that the BSDF draws (multiple importance sampling)", .minimum = 0, .maximum = 0.9});
    visit("vpls", &S::vpls,
          {.help = "virtual point lights for indirect light; 0, or --max-bounces 0: direct light only",
           .minimum = 0,
           .maximum = 1e6,
           .symbol = "M"});
    visit("vpl_candidates", &S::vpl_candidates,
          {.help = "candidates from which each virtual point light is chosen", .minimum = 1, .maximum = 64, .symbol = "M_c / M"});
    visit("vpl_backward", &S::vpl_backward, {.help = "share of the candidates that start at the eye", .minimum = 0, .maximum = 1});
    visit("vpl_clamp", &S::vpl_clamp,
          {.help = "distance at which the geometry term of virtual point lights is clamped; 0 = not at all",
           .minimum = 0,
           .maximum = 1,
           .unit = "radii of the scene"});
    visit("vpl_spread", &S::vpl_spread,
          {.help = "cells around virtual point lights, as a share of the surface that one stands for: smaller ones share fewer answers",
           .minimum = 1e-6,
           .maximum = 16});
    visit("specular_depth", &S::specular_depth, {.help = "mirrors and panes an eye path passes", .minimum = 0, .maximum = 64});
    visit("least_weight", &S::least_weight, {.help = "eye paths that carry less are dropped", .minimum = 0, .maximum = 1});
    visit("pass_spp", &S::pass_spp,
          {.help = "samples a pixel that share answers and virtual lights; 0 = all up to 16", .minimum = 0, .maximum = 4096});
    visit("order", &S::order,
          {.help = "order in which a tile's pixels ask: spread out first, or row by row (ablation)", .choices = {"halton", "scanline"}});
    visit("order_growth", &S::order_growth,
          {.help = "growth of the segments of that order", .minimum = 1.1, .maximum = 100, .symbol = "C_PG"});
  }
};

}  // namespace sightline
