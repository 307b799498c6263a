#include "methods/fragments/refiner.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/math/vec3_batch.h"

namespace sightline {
namespace {

constexpr int kConfirmLevel = 3;
// Pixels that geometry made so small are lines here and there, or most of a picture: from this share of a root tile on they are the
// picture.
constexpr std::size_t kManyPixels = static_cast<std::size_t>(kRootSize) * kRootSize / 8;
// From this share on hardly anything else is in it (hair, leaves), and noise is what one sees.
constexpr std::size_t kCrowdedPixels = kManyPixels * 3;
// By how much an additional sample may differ from its quadrant's: sampling noise where the light is partly seen, little where it is all
// or nothing.
constexpr float kPenumbraNoise = 0.25f, kPlainNoise = 0.06f;

// Solid angles in steradians from which on a light is large, and below which it is small; the least share of the rays that a small one
// takes, and in what steps. With fewer than that dots appear in the rims of penumbrae.
constexpr float kLargeLight = 0.3f, kUsualLight = 0.06f, kLeastShare = 0.625f;
constexpr std::uint32_t kRayStep = 4;
// How far apart pixels lie that are asked for it.
constexpr int kSparsePixels = 8;

}  // namespace

Refiner::Refiner(const World& world, const View& view, Visibility& visibility, const FragmentOptions& options, std::uint64_t seed)
    : options_(options), probes_(world, view, visibility, seed), finest_test_(world, view, visibility, options.finest, seed) {
  if (options.sparse_tests) probes_.ask_sparsely();
}

void Refiner::set_light(const AreaLight& light, const LightPoints& points, const PriorShares* prior) {
  light_ = &light, points_ = &points, prior_ = prior;
  finest_test_.set_prior(prior);
  probes_.set_light(light, points);
}

void Refiner::watch(StageMap& map) {
  map_ = &map;
  probes_.count_questions();
}

void Refiner::refine(const GBuffer& g, std::size_t index, std::span<const Fragment> fragments, std::uint32_t sample, LightSignal& signal,
                     TileProgress& progress, PassStatistics& statistics) {
  progress.done.clear();
  progress.children.assign(fragments.begin(), fragments.end());
  begin(index, sample);
  reach_.build(g, g.root(index), *light_);
  light_angle_ = progress.light_angle = options_.rays_by_size ? light_angle(g, g.root(index)) : 0;
  reached_ = false;
  clear(g, g.root(index), signal);
  // What geometry left of level 0 has no neighbours to be smoothed with.
  std::erase_if(progress.children, [&](const Fragment& f) {
    const bool pixel = f.level == 0 && reach_.of(f) == ReachPyramid::Reach::all;
    if (pixel) geometry_pixels_.push_back(static_cast<std::uint32_t>(g.at(f.x, f.y)));
    return pixel;
  });
  refine_children(g, sample, signal, progress, statistics);
}

void Refiner::refine_borders(const GBuffer& g, std::size_t index, std::uint32_t sample, int round, LightSignal& signal,
                             TileProgress& progress, PassStatistics& statistics) {
  if (progress.children.empty()) return;
  for (const Fragment& f : progress.children) {
    const int x1 = std::min(f.x + f.width(), signal.stride), y1 = std::min(f.y + f.width(), signal.rows);
    for (int y = f.y; y < y1; y += LightSignal::kBlock)
      for (int x = f.x; x < x1; x += LightSignal::kBlock) signal.round_at(x, y) = static_cast<std::uint8_t>(round);
  }
  begin(index, sample);
  light_angle_ = progress.light_angle;
  reached_ = true;  // stable fragments were tested, and so are their children
  refine_children(g, sample, signal, progress, statistics);
}

float Refiner::light_angle(const GBuffer& g, const RootTile& tile) const {
  float largest = 0;
  for (int y = tile.y0; y < tile.y1; y += kSparsePixels) {
    for (int x = tile.x0; x < tile.x1; x += kSparsePixels) {
      const std::size_t at = g.at(x, y);
      if (g.kind[at] != PixelKind::diffuse && g.kind[at] != PixelKind::analytic) continue;
      largest = std::max(largest, light_->solid_angle(load(g.position, at), load(g.geometric_normal, at)));
      if (largest > kLargeLight) return largest;
    }
  }
  return largest;
}

// Noise sums up over penumbrae, which are as wide as the light looks: rays in proportion to that leave the same error in a picture under
// small lights and large ones. Near a large light errors also grow with what it adds to a pixel, and with the number of edges before it.
std::uint32_t Refiner::pixel_rays() const {
  const std::uint32_t rays = options_.finest.smooth_rays;
  if (!options_.rays_by_size) return rays;
  if (light_angle_ > kLargeLight) return 2 * rays;
  const float share = std::clamp(std::sqrt(light_angle_ / kUsualLight), kLeastShare, 1.f);
  return std::max(static_cast<std::uint32_t>(std::lround(share * static_cast<float>(rays) / kRayStep)) * kRayStep, 16u);
}

int Refiner::penumbra_level() const { return light_angle_ > kLargeLight ? std::min(options_.penumbra_level, 1) : options_.penumbra_level; }

void Refiner::begin(std::size_t index, std::uint32_t sample) {
  probes_.begin(static_cast<std::uint32_t>(index), sample);
  finest_test_.begin(static_cast<std::uint32_t>(index));
  finest_.clear(), geometry_pixels_.clear();
}

void Refiner::refine_children(const GBuffer& g, std::uint32_t sample, LightSignal& signal, TileProgress& progress,
                              PassStatistics& statistics) {
  std::swap(children_, progress.children), std::swap(done_, progress.done);
  run_waves(g, sample, signal, statistics);
  write_pixels(g, sample, signal, statistics);
  std::swap(done_, progress.done);
  progress.children.clear();
}

void Refiner::run_waves(const GBuffer& g, std::uint32_t sample, LightSignal& signal, PassStatistics& statistics) {
  while (!children_.empty()) {
    // What the light cannot reach is done; pixels wait for the end.
    current_.clear();
    for (std::size_t i = 0; i < children_.size(); ++i) {
      const Fragment f = children_[i];
      if (f.x >= g.width || f.y >= g.height) continue;
      const ReachPyramid::Reach reach = reached_ ? ReachPyramid::Reach::all : reach_.of(f);
      if (reach == ReachPyramid::Reach::mixed) {
        subdivide(f, 0, children_);
      } else if (reach == ReachPyramid::Reach::none) {
        write_level(g, f, LightSignal::kUnlit, signal), write_constant(g, f, 0, signal);
        ++counts_.fragments;
      } else if (f.level == 0) {
        finest_.push_back(static_cast<std::uint32_t>(g.at(f.x, f.y)));
      } else if (!prior_ || !decide_by_prior(g, f, signal)) {
        current_.push_back(f);
      }
    }
    children_.clear();
    const std::uint64_t before = statistics.rays.occlusion;
    probes_.test(g, current_, masks_, statistics);
    counts_.test_rays += statistics.rays.occlusion - before;
    if (map_) map_tests(g);
    stable_.clear(), stable_masks_.clear();
    classify(g, signal);
    confirm(g, statistics);
    write_stable(g, signal);
    resolve_penumbrae(g, sample, signal, statistics);
    add_extras(g, sample, signal, statistics);
    counts_.fragments += stable_.size();
    done_.insert(done_.end(), stable_.begin(), stable_.end());
  }
}

// Whether what the last picture knows decides about a fragment, which is then done or split.
bool Refiner::decide_by_prior(const GBuffer& g, const Fragment& f, LightSignal& signal) {
  using Verdict = PriorShares::Verdict;
  ProbeMasks masks;
  const Verdict verdict = prior_->of(g, f, static_cast<int>(points_->count), masks);
  if (verdict == Verdict::open) return false;
  ++counts_.kept_fragments;
  if (verdict == Verdict::split) {
    split(f, masks);
    return true;
  }
  write_level(g, f, 0, signal), write_constant(g, f, verdict == Verdict::lit ? 1.f : 0.f, signal);
  ++counts_.fragments;
  done_.push_back(f);
  return true;
}

void Refiner::split(const Fragment& f, const ProbeMasks& masks) { subdivide(f, fine_quadrants(masks, options_.split), children_); }

void Refiner::classify(const GBuffer& g, LightSignal& signal) {
  for (std::size_t i = 0; i < current_.size(); ++i) {
    const bool dark = options_.dark_culling && most_visible(masks_[i]) == 0;
    if (dark || is_stable(current_[i].level, masks_[i], options_.split))
      stable_.push_back(current_[i]), stable_masks_.push_back(masks_[i]);
    else if (current_[i].level == 1 && options_.finest.early_out && signal.channels == 1)
      split_to_pixels(g, current_[i], masks_[i], signal);
    else
      split(current_[i], masks_[i]);
  }
}

// The probes of a 2 x 2 fragment are its pixels: their rays are the first ones of the finest level, and those pixels whose rays agree are
// done.
void Refiner::split_to_pixels(const GBuffer& g, const Fragment& f, const ProbeMasks& masks, LightSignal& signal) {
  for (int q = 0; q < 4; ++q) {
    const int x = f.x + (q & 1), y = f.y + (q >> 1);
    if (!g.inside(x, y)) continue;
    const std::uint64_t mask = masks[static_cast<std::size_t>(q)];
    const auto at = static_cast<std::uint32_t>(g.at(x, y));
    if (mask != 0 && mask != all_points()) {
      finest_.push_back(at);
      continue;
    }
    signal.level[at] = 0, signal.flags[at] = 0;
    signal.value[0][at] = mask != 0 ? 1.f : 0.f;
    if (!signal.rays.empty()) signal.rays[at] = static_cast<std::uint8_t>(points_->count);
    ++counts_.finest, ++counts_.fragments;
  }
}

// Stable fragments are written, large ones once more probes at random places agree: what lies between the four would be missed.
void Refiner::confirm(const GBuffer& g, PassStatistics& statistics) {
  for (int round = 0; round < options_.confirm; ++round) {
    unconfirmed_.clear();
    for (const Fragment& f : stable_) {
      if (f.level >= kConfirmLevel) unconfirmed_.push_back(f);
    }
    const std::uint64_t before = statistics.rays.occlusion;
    probes_.confirm(g, unconfirmed_, static_cast<std::uint32_t>(round), confirmed_, statistics);
    counts_.confirm_rays += statistics.rays.occlusion - before;
    if (map_) map_questions(g, unconfirmed_);
    std::size_t kept = 0, next = 0;
    for (std::size_t i = 0; i < stable_.size(); ++i) {
      const ProbeMasks& m = stable_masks_[i];
      if (stable_[i].level >= kConfirmLevel) {
        const std::uint64_t mask = confirmed_[next++];
        const std::uint64_t missed = (mask & ~(m[0] | m[1] | m[2] | m[3])) | (~mask & (m[0] & m[1] & m[2] & m[3]));
        if (std::popcount(missed) >= threshold(stable_[i].level, options_.split)) {
          split(stable_[i], m);
          continue;
        }
      }
      stable_[kept] = stable_[i], stable_masks_[kept] = m, ++kept;
    }
    stable_.resize(kept), stable_masks_.resize(kept);
  }
}

void Refiner::write_stable(const GBuffer& g, LightSignal& signal) {
  extras_.clear(), extra_owner_.clear(), penumbra_.clear(), penumbra_at_.clear();
  for (std::size_t i = 0; i < stable_.size(); ++i) {
    const Fragment& f = stable_[i];
    write_level(g, f, 0, signal);
    if (most_visible(stable_masks_[i]) == 0)
      write_constant(g, f, 0, signal);
    else
      write_stable(g, f, stable_masks_[i], signal);
    // Where the light is partly seen, points shared by four probes make steps between fragments: the probes trace rays of their own.
    for (int q = 0; q < 4 && f.level >= penumbra_level() && signal.channels == 1; ++q) {
      const std::uint64_t mask = stable_masks_[i][static_cast<std::size_t>(q)];
      if (mask == 0 || mask == all_points()) continue;
      const IVec2 pixel = probe_pixel(g, f, q);
      const int half = f.width() / 2;
      penumbra_.push_back(static_cast<std::uint32_t>(g.at(pixel.x, pixel.y)));
      penumbra_at_.push_back(static_cast<std::uint32_t>(g.at(f.x + (q & 1 ? half : 0), f.y + (q & 2 ? half : 0))));
    }
    if (!options_.extra_samples || f.level < options_.extra_level) continue;
    const int half = f.width() / 2;
    for (const IVec2 p : {IVec2(f.x, f.y), IVec2(f.x + half, f.y), IVec2(f.x, f.y + half)}) {
      if (!g.inside(p.x, p.y)) continue;
      extras_.push_back(static_cast<std::uint32_t>(g.at(p.x, p.y))), extra_owner_.push_back(static_cast<std::uint32_t>(i));
    }
  }
}

// Pixels without light, until something else is written there.
void Refiner::clear(const GBuffer& g, const RootTile& tile, LightSignal& signal) const {
  for (int y = tile.y0; y < tile.y0 + kRootSize; y += LightSignal::kBlock)
    std::fill_n(&signal.round_at(tile.x0, y), kRootSize / LightSignal::kBlock, std::uint8_t{0});
  for (int y = tile.y0; y < tile.y0 + kRootSize; ++y) {
    std::fill_n(signal.level.data() + g.at(tile.x0, y), kRootSize, std::uint8_t{0});
    std::fill_n(signal.flags.data() + g.at(tile.x0, y), kRootSize, std::uint8_t{LightSignal::kUnlit});
    for (int c = 0; c < signal.channels; ++c)
      std::fill_n(signal.value[static_cast<std::size_t>(c)].data() + g.at(tile.x0, y), kRootSize, 0.f);
  }
}

void Refiner::write_pixels(const GBuffer& g, std::uint32_t sample, LightSignal& signal, PassStatistics& statistics) {
  const std::size_t pixels = geometry_pixels_.size();
  const std::uint32_t rays = pixels > kCrowdedPixels ? options_.finest.crowded_rays
                             : pixels > kManyPixels  ? options_.finest.rays
                                                     : pixel_rays();
  write_pixels(g, geometry_pixels_, rays, sample, signal, statistics);
  write_pixels(g, finest_, pixel_rays(), sample, signal, statistics);
}

void Refiner::write_pixels(const GBuffer& g, std::span<const std::uint32_t> pixels, std::uint32_t rays, std::uint32_t sample,
                           LightSignal& signal, PassStatistics& statistics) {
  const std::uint64_t before = statistics.rays.occlusion;
  finest_test_.test(g, *light_, pixels, sample, rays, signal.channels, values_, statistics);
  counts_.finest_rays += statistics.rays.occlusion - before;
  counts_.finest += pixels.size(), counts_.fragments += pixels.size(), counts_.kept_pixels += finest_test_.kept();
  if (map_) map_pixels(pixels);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    signal.level[pixels[i]] = 0, signal.flags[pixels[i]] = 0;
    if (!signal.rays.empty()) signal.rays[pixels[i]] = finest_test_.known(i);
    for (int c = 0; c < signal.channels; ++c)
      signal.value[static_cast<std::size_t>(c)][pixels[i]] = values_[static_cast<std::size_t>(c)][i];
  }
}

void Refiner::resolve_penumbrae(const GBuffer& g, std::uint32_t sample, LightSignal& signal, PassStatistics& statistics) {
  if (penumbra_.empty()) return;
  const std::uint64_t before = statistics.rays.occlusion;
  finest_test_.test(g, *light_, penumbra_, sample, pixel_rays(), 1, values_, statistics);
  counts_.penumbra_rays += statistics.rays.occlusion - before;
  for (std::size_t i = 0; map_ && map_->wants_rays() && i < penumbra_.size(); ++i) {
    const auto stride = static_cast<std::uint32_t>(g.stride);
    const std::uint8_t level = signal.level[penumbra_at_[i]];
    const auto corner = [&](std::uint32_t place) { return static_cast<std::uint16_t>(place >> level << level); };
    map_->add_rays(g, {corner(penumbra_at_[i] % stride), corner(penumbra_at_[i] / stride), level}, finest_test_.asked(i));
  }
  for (std::size_t i = 0; i < penumbra_.size(); ++i) signal.value[0][penumbra_at_[i]] = values_[0][i];
}

// Additional samples of the wave's stable fragments. Where one of them contradicts its quadrant, something small lies between the probes.
void Refiner::add_extras(const GBuffer& g, std::uint32_t sample, LightSignal& signal, PassStatistics& statistics) {
  if (extras_.empty()) return;
  const std::uint64_t before = statistics.rays.occlusion;
  finest_test_.test(g, *light_, extras_, sample, pixel_rays(), signal.channels, values_, statistics);
  counts_.extra_rays += statistics.rays.occlusion - before, counts_.extra_samples += extras_.size();
  if (map_) map_pixels(extras_);
  contradicted_.assign(stable_.size(), 0);
  for (std::size_t i = 0; i < extras_.size(); ++i) {
    signal.flags[extras_[i]] = static_cast<std::uint8_t>(signal.flags[extras_[i]] | LightSignal::kExtra);
    for (int c = 0; c < signal.channels; ++c)
      signal.extra[static_cast<std::size_t>(c)][extras_[i]] = values_[static_cast<std::size_t>(c)][i];
    // The corners stand at the place of their quadrants' own values.
    if (options_.confirm == 0 || signal.channels != 1) continue;
    const float own = signal.value[0][extras_[i]];
    const float noise = own > 0 && own < 1 ? kPenumbraNoise : kPlainNoise;
    if (std::fabs(values_[0][i] - own) > noise) contradicted_[extra_owner_[i]] = 1;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < stable_.size(); ++i) {
    if (contradicted_[i])
      split(stable_[i], stable_masks_[i]);
    else
      stable_[kept++] = stable_[i];
  }
  stable_.resize(kept);
}

void Refiner::map_tests(const GBuffer& g) {
  map_questions(g, current_);
  for (std::size_t i = 0; map_->wants_gradients() && i < current_.size(); ++i)
    map_->set_gradient(g, current_[i], steepest_gradient(masks_[i], points_->count));
}

void Refiner::map_questions(const GBuffer& g, std::span<const Fragment> fragments) {
  for (std::size_t i = 0; map_->wants_rays() && i < fragments.size(); ++i) map_->add_rays(g, fragments[i], probes_.asked()[i]);
}

void Refiner::map_pixels(std::span<const std::uint32_t> pixels) {
  for (std::size_t i = 0; map_->wants_rays() && i < pixels.size(); ++i) map_->add_rays(pixels[i], finest_test_.asked(i));
}

}  // namespace sightline
