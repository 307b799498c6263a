#include "methods/fragments/options.h"

#include <algorithm>

namespace sightline {
namespace {

using S = FragmentsSettings;

bool chosen(S::Switch setting, bool by_variant) { return setting == S::Switch::variant ? by_variant : setting == S::Switch::on; }

UpsampleOptions::Kind kind_of(S::Upsample setting, S::Variant variant) {
  switch (setting) {
    case S::Upsample::rbf:
      return UpsampleOptions::Kind::rbf;
    case S::Upsample::rbf_fixed:
      return UpsampleOptions::Kind::rbf_fixed;
    case S::Upsample::multipass:
      return UpsampleOptions::Kind::multipass;
    case S::Upsample::quad4:
      return UpsampleOptions::Kind::quad4;
    case S::Upsample::variant:
      break;
  }
  switch (variant) {
    case S::Variant::nichols:
      return UpsampleOptions::Kind::multipass;
    case S::Variant::koa:
      return UpsampleOptions::Kind::rbf;
    case S::Variant::sightline:
    case S::Variant::fast:
      break;
  }
  return UpsampleOptions::Kind::quad4;
}

}  // namespace

FragmentOptions resolve(const FragmentsSettings& s) {
  const bool nichols = s.variant == S::Variant::nichols, fast = s.variant == S::Variant::fast;
  const bool ours = s.variant == S::Variant::sightline || fast;
  const auto number = [](auto setting, auto unset, auto by_variant) { return setting == unset ? by_variant : setting; };
  FragmentOptions o;
  o.refine = s.refine == S::Refine::all                                                      ? FragmentOptions::Refine::all
             : s.refine == S::Refine::nichols || (s.refine == S::Refine::variant && nichols) ? FragmentOptions::Refine::neighbours
                                                                                             : FragmentOptions::Refine::probes;
  const bool probes = o.refine == FragmentOptions::Refine::probes;
  o.geometry.tau_n = number(s.tau_n, 0.f, ours && !fast ? 0.2f : 0.35f);
  o.geometry.tau_d = number(s.tau_d, 0.f, ours ? 0.001f : 0.01f);
  o.geometry.plane_distance = s.depth == S::Depth::plane, o.geometry.coarsest = s.coarsest;
  o.split = {s.rays, s.gradient, s.subdivide_twice, chosen(s.strict_threshold, fast), s.pixel_threshold};
  o.ratio = s.signal == S::Signal::variant ? ours : s.signal == S::Signal::ratio;
  // Penumbrae that are smoothed need half the rays.
  const auto rays = [&](int by_variant) { return static_cast<std::uint32_t>(std::max(number(s.level0_rays, 0, by_variant), 16)); };
  o.finest = {rays(fast ? 16 : 64),
              rays(fast             ? 16
                   : ours && probes ? 32
                                    : 64),
              rays(fast             ? 16
                   : ours && probes ? 104
                                    : 64),
              chosen(s.early_out, ours)};
  const bool blue = s.jitter == S::Jitter::variant ? ours && !fast && probes : s.jitter == S::Jitter::blue;
  o.jitter = blue ? PointJitter::blue : PointJitter::hash;
  o.sparse_tests = chosen(s.early_out, ours) && probes && o.ratio;
  // Fragments that are compared with their neighbours have one value, that of their centre, and no additional samples.
  o.interpolate_probes = chosen(s.probes, ours) && probes;
  o.extra_samples = chosen(s.extra_samples, !fast) && probes;
  o.upsample.kind = kind_of(s.upsample, s.variant);
  // Patches of probes are not made of additional samples; what is left to them is to contradict, where probes are far apart.
  o.extra_level = o.upsample.kind == UpsampleOptions::Kind::quad4 ? 4 : 3;
  o.upsample.copy_levels = number(s.copy_levels, -1, ours ? 1 : 2);
  o.upsample.interpolate_probes = o.interpolate_probes;
  o.smooth = chosen(s.smooth, ours) && o.ratio;
  o.dark_culling = s.dark_culling;
  o.confirm = number(s.confirm, -1, ours && !fast ? 1 : 0);
  o.penumbra_level = number(s.penumbra_level, -1, ours && !fast ? 2 : 8);
  // Nothing else knows how large the light looks.
  o.rays_by_size = probes && chosen(s.rays_by_size, ours && !fast && o.ratio && s.level0_rays == 0);
  o.border_rounds = o.ratio ? number(s.borders, -1, ours && !fast ? 3 : 0) : 0;
  o.nichols_threshold = s.nichols_threshold;
  o.glossy = s.glossy == S::Glossy::ltc ? GlossyTerm::ltc : GlossyTerm::quadrature;
  o.edge_samples = s.edge_samples;
  o.temporal = s.temporal;
  return o;
}

}  // namespace sightline
