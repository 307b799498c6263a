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
      break;
  }
  return UpsampleOptions::Kind::quad4;
}

}  // namespace

FragmentOptions resolve(const FragmentsSettings& s) {
  const bool ours = s.variant == S::Variant::sightline, nichols = s.variant == S::Variant::nichols;
  FragmentOptions o;
  o.refine = s.refine == S::Refine::all                                                      ? FragmentOptions::Refine::all
             : s.refine == S::Refine::nichols || (s.refine == S::Refine::variant && nichols) ? FragmentOptions::Refine::neighbours
                                                                                             : FragmentOptions::Refine::probes;
  o.geometry = {s.tau_n, s.tau_d, s.depth == S::Depth::plane, s.coarsest};
  o.split = {s.rays, s.gradient, s.subdivide_twice, s.strict_threshold};
  o.ratio = s.signal == S::Signal::variant ? ours : s.signal == S::Signal::ratio;
  // Smoothed penumbrae need half the rays. Everywhere refined is Monte Carlo.
  const int rays = s.level0_rays > 0 ? std::max(s.level0_rays, 16) : ours && o.refine == FragmentOptions::Refine::probes ? 32 : 64;
  o.finest = {static_cast<std::uint32_t>(rays), chosen(s.early_out, ours)};
  // Fragments that are compared with their neighbours have one value, that of their centre.
  o.interpolate_probes = chosen(s.probes, ours) && o.refine == FragmentOptions::Refine::probes;
  o.upsample.kind = kind_of(s.upsample, s.variant);
  o.upsample.copy_levels = s.copy_levels >= 0 ? s.copy_levels : ours ? 1 : 2;
  o.upsample.interpolate_probes = o.interpolate_probes;
  o.smooth = chosen(s.smooth, ours) && o.ratio;
  o.dark_culling = s.dark_culling;
  // Neighbours that are compared have no additional samples.
  o.extra_samples = s.extra_samples && o.refine == FragmentOptions::Refine::probes;
  o.confirm = s.confirm >= 0 ? s.confirm : ours ? 1 : 0;
  o.penumbra_level = s.penumbra_level >= 0 ? s.penumbra_level : ours ? 2 : 8;
  o.border_rounds = o.ratio ? (s.borders >= 0 ? s.borders : ours ? 3 : 0) : 0;
  o.nichols_threshold = s.nichols_threshold;
  return o;
}

}  // namespace sightline
