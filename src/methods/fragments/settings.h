// Settings of the fragments method.
#pragma once

#include "base/settings/settings.h"

namespace sightline {

struct FragmentsSettings {
  enum class Variant { sightline, koa, nichols, fast };
  /// `variant` stands for what the variant says.
  enum class Refine { variant, koa, nichols, all };
  enum class Upsample { variant, rbf, rbf_fixed, multipass, quad4 };
  enum class Signal { variant, ratio, irradiance };
  enum class Switch { variant, off, on };
  enum class Depth { plane, relative };
  enum class Jitter { variant, hash, blue };
  enum class Glossy { quadrature, ltc };
  enum class Show { picture, levels, gradients, rays, signal, curvature };

  Variant variant = Variant::sightline;
  Refine refine = Refine::variant;
  Upsample upsample = Upsample::variant;
  Signal signal = Signal::variant;
  Switch early_out = Switch::variant;
  Switch probes = Switch::variant;
  Switch smooth = Switch::variant;
  int confirm = -1;
  int borders = -1;
  int penumbra_level = -1;
  int rays = 16;
  int level0_rays = 0;
  Switch rays_by_size = Switch::variant;
  int coarsest = 7;
  int copy_levels = -1;
  float tau_n = 0;
  float tau_d = 0;
  Depth depth = Depth::plane;
  int gradient = 7;
  bool subdivide_twice = true;
  bool dark_culling = true;
  Switch strict_threshold = Switch::variant;
  int pixel_threshold = 2;
  Switch extra_samples = Switch::variant;
  int nichols_threshold = 6;
  Jitter jitter = Jitter::variant;
  Glossy glossy = Glossy::quadrature;
  int edge_samples = 1;
  bool temporal = false;
  Show show = Show::picture;
  friend bool operator==(const FragmentsSettings&, const FragmentsSettings&) = default;

  template <class Visitor>
  static void describe(Visitor&& visit) {
    using S = FragmentsSettings;
    visit("variant", &S::variant,
          {.help = "preset of what follows: ours, the paper's, that of its predecessor [Nichols2010], or ours with fewer rays",
           .choices = {"sightline", "koa", "nichols", "fast"}});
    visit("refine", &S::refine,
          {.help = "where fragments are split: by probes inside them, by comparing neighbours, or everywhere (Monte Carlo)",
           .choices = {"variant", "koa", "nichols", "all"}});
    visit("upsample", &S::upsample,
          {.help = "how fragments become pixels: radial basis functions (adaptive or fixed variance), level by level, or quadrant corners",
           .choices = {"variant", "rbf", "rbf-fixed", "multipass", "quad4"}});
    visit("signal", &S::signal,
          {.help = "what is interpolated: the visible share of an analytic term, or irradiance as in the paper",
           .choices = {"variant", "ratio", "irradiance"}});
    visit("early_out", &S::early_out,
          {.help = "pixels at the finest level trace a quarter of their rays first and stop if all agree",
           .choices = {"variant", "off", "on"}});
    visit("probes", &S::probes,
          {.help = "interpolate the four probes of a fragment instead of averaging them", .choices = {"variant", "off", "on"}});
    visit("smooth", &S::smooth, {.help = "edge-avoiding filter over the visible share in penumbrae", .choices = {"variant", "off", "on"}});
    visit("confirm", &S::confirm,
          {.help = "probes at random places that confirm a stable fragment of 8 pixels or more; -1 = as the variant says",
           .minimum = -1,
           .maximum = 4});
    visit("borders", &S::borders,
          {.help = "how often stable fragments beside a jump of the signal are refined again; -1 = as the variant says",
           .minimum = -1,
           .maximum = 8});
    visit("penumbra_level", &S::penumbra_level,
          {.help =
               "stable fragments from this level on that see a part of the light trace more rays, against steps; -1 = as the variant says",
           .minimum = -1,
           .maximum = 8});
    visit("rays", &S::rays, {.help = "rays a probe: 16, or 32 or 64 for large lights", .minimum = 16, .maximum = 64, .symbol = "K"});
    visit("level0_rays", &S::level0_rays,
          {.help = "rays a pixel at the finest level; 0 = as the variant says", .minimum = 0, .maximum = 4096});
    visit("rays_by_size", &S::rays_by_size,
          {.help = "more rays a pixel where a light looks large, fewer where it looks small", .choices = {"variant", "off", "on"}});
    visit("coarsest", &S::coarsest,
          {.help = "level of the coarsest fragments, of 2^n pixels", .minimum = 1, .maximum = 7, .symbol = "M_max"});
    visit("copy_levels", &S::copy_levels,
          {.help = "levels up to this one are copied instead of interpolated; -1 = as the variant says", .minimum = -1, .maximum = 7});
    visit("tau_n", &S::tau_n,
          {.help = "change of the normal that splits a fragment; 0 = as the variant says", .minimum = 0, .maximum = 3, .symbol = "τ_n"});
    visit(
        "tau_d", &S::tau_d,
        {.help = "relative change of depth that splits a fragment; 0 = as the variant says", .minimum = 0, .maximum = 10, .symbol = "τ_d"});
    visit("depth", &S::depth,
          {.help = "change of depth: distance from the tangent plane, or plain difference as in the paper",
           .choices = {"plane", "relative"}});
    visit(
        "gradient", &S::gradient,
        {.help = "differing rays of 16 between neighbouring probes above which both quadrants skip a level", .minimum = 0, .maximum = 16});
    visit("subdivide_twice", &S::subdivide_twice, {.help = "gradient-aware subdivision (off: always four children)"});
    visit("dark_culling", &S::dark_culling, {.help = "fragments that see nothing of the light are done"});
    visit("strict_threshold", &S::strict_threshold,
          {.help = "the paper's threshold read as 'more than' instead of 'at least'", .choices = {"variant", "off", "on"}});
    visit("pixel_threshold", &S::pixel_threshold,
          {.help = "differing rays of 16 that split fragments of 2 pixels into pixels; more is faster, and noisier",
           .minimum = 1,
           .maximum = 16});
    visit("extra_samples", &S::extra_samples,
          {.help = "three finest samples on the upper and left edge of stable fragments", .choices = {"variant", "off", "on"}});
    visit("nichols_threshold", &S::nichols_threshold,
          {.help = "rays of 64 by which neighbours may differ (refine=nichols)", .minimum = 0, .maximum = 64});
    visit("jitter", &S::jitter,
          {.help = "how light points are moved from fragment to fragment: by chance, or so that neighbours differ as much as they can",
           .choices = {"variant", "hash", "blue"}});
    visit("glossy", &S::glossy,
          {.help = "light of lobes without shadows: the lobe itself by quadrature, or linearly transformed cosines fitted to it",
           .choices = {"quadrature", "ltc"}});
    visit("edge_samples", &S::edge_samples,
          {.help = "camera rays a pixel on geometric edges (anti-aliasing); 1 = none", .minimum = 1, .maximum = 16});
    visit("temporal", &S::temporal,
          {.help = "take over what the last picture knows, while nothing but the camera moves (pictures of one sample a pixel)"});
    visit("show", &S::show,
          {.help = "the picture, or a map of one of the stages",
           .choices = {"picture", "levels", "gradients", "rays", "signal", "curvature"}});
  }
};

}  // namespace sightline
