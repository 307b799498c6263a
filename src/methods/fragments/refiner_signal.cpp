// What refinement writes: the signal of fragments from what their probes saw.
#include <algorithm>
#include <array>

#include "methods/fragments/refiner.h"
#include "methods/fragments/unshadowed.h"

namespace sightline {
namespace {

struct Pixels {
  int x0, y0, x1, y1;
};
Pixels clipped(const GBuffer& g, const Fragment& f) {
  return {f.x, f.y, std::min(f.x + f.width(), g.width), std::min(f.y + f.width(), g.height)};
}

}  // namespace

void Refiner::write_level(const GBuffer& g, const Fragment& f, std::uint8_t flags, LightSignal& signal) const {
  const Pixels p = clipped(g, f);
  // Probes in penumbra trace rays of their own.
  const auto rays = static_cast<std::uint8_t>(f.level >= penumbra_level() ? std::min(pixel_rays(), 255u) : points_->count);
  for (int y = p.y0; y < p.y1; ++y) {
    std::fill_n(signal.level.data() + g.at(p.x0, y), p.x1 - p.x0, f.level);
    std::fill_n(signal.flags.data() + g.at(p.x0, y), p.x1 - p.x0, flags);
    if (!signal.rays.empty()) std::fill_n(signal.rays.data() + g.at(p.x0, y), p.x1 - p.x0, rays);
  }
}

void Refiner::write_constant(const GBuffer& g, const Fragment& f, float value, LightSignal& signal) const {
  const int half = f.width() / 2;
  for (int q = 0; q < (f.level == 0 ? 1 : 4); ++q) {
    const std::size_t at = g.at(f.x + (q & 1 ? half : 0), f.y + (q & 2 ? half : 0));
    for (int c = 0; c < signal.channels; ++c) signal.value[static_cast<std::size_t>(c)][at] = value;
  }
}

// The visible share of the light at a receiver, by the points of a set; 1 where no point sends anything.
float Refiner::share(const Receiver& receiver, std::uint32_t set, std::uint64_t mask) const {
  float all = 0, visible = 0;
  for (std::uint32_t k = 0; k < points_->count; ++k) {
    const std::size_t i = static_cast<std::size_t>(set) * points_->count + k;
    const float term = reflected_term(receiver, load(points_->point, i), load(points_->normal, i), points_->two_sided[i] > 0) *
                       points_->area[i] * luminance(load(points_->radiance, i));
    all += term;
    if (mask >> k & 1) visible += term;
  }
  return all > 0 ? visible / all : mask != 0 ? 1.f : 0.f;
}

// Irradiance / pi, each point weighted by the share of the quadrants that see it [Koa2017, Eq. 3, with the visibility and 1 / K that print
// lost].
Color Refiner::irradiance(const Receiver& receiver, std::uint32_t set, const ProbeMasks& masks, int quadrants) const {
  Color sum(0);
  for (std::uint32_t k = 0; k < points_->count; ++k) {
    int seen = 0;
    for (int q = 0; q < quadrants; ++q) seen += static_cast<int>(masks[static_cast<std::size_t>(q)] >> k & 1);
    if (seen == 0) continue;
    const std::size_t i = static_cast<std::size_t>(set) * points_->count + k;
    const float term = geometry_term(receiver, load(points_->point, i), load(points_->normal, i), points_->two_sided[i] > 0);
    sum += load(points_->radiance, i) * (term * points_->area[i] * static_cast<float>(seen) / static_cast<float>(quadrants));
  }
  return sum;
}

void Refiner::write_stable(const GBuffer& g, const Fragment& f, const ProbeMasks& masks, LightSignal& signal) const {
  const int half = f.width() / 2;
  const std::uint32_t set = probes_.set_of(f);
  const std::uint64_t full = all_points();
  // Averaged probes: one value at the centre. (Pixels of the smallest fragments have their own.)
  const bool average = !options_.interpolate_probes && f.level > 2;
  std::array<float, 3> mean{};
  if (average) {
    const Receiver centre = receiver_at(g, std::min(f.x + half, g.width - 1), std::min(f.y + half, g.height - 1));
    if (signal.channels == 1) {
      for (int q = 0; q < 4; ++q) mean[0] += share(centre, set, masks[static_cast<std::size_t>(q)]) / 4;
    } else {
      const Color sum = irradiance(centre, set, masks, 4);
      mean = {sum.x, sum.y, sum.z};
    }
  }
  for (int q = 0; q < 4; ++q) {
    const std::uint64_t mask = masks[static_cast<std::size_t>(q)];
    const std::size_t at = g.at(f.x + (q & 1 ? half : 0), f.y + (q & 2 ? half : 0));
    const auto receiver = [&] {
      const IVec2 pixel = probe_pixel(g, f, q);
      return receiver_at(g, pixel.x, pixel.y);
    };
    if (average) {
      for (int c = 0; c < signal.channels; ++c) signal.value[static_cast<std::size_t>(c)][at] = mean[static_cast<std::size_t>(c)];
    } else if (signal.channels == 1) {
      signal.value[0][at] = mask == 0 ? 0.f : mask == full ? 1.f : share(receiver(), set, mask);
    } else {
      const Color sum = mask == 0 ? Color(0) : irradiance(receiver(), set, {mask, 0, 0, 0}, 1);
      for (int c = 0; c < 3; ++c) signal.value[static_cast<std::size_t>(c)][at] = sum[c];
    }
  }
}

void Refiner::write_centre(const GBuffer& g, const Fragment& f, std::uint64_t mask, LightSignal& signal) const {
  const int half = f.width() / 2;
  const Receiver centre = receiver_at(g, std::min(f.x + half, g.width - 1), std::min(f.y + half, g.height - 1));
  const Color value = signal.channels == 1 ? Color(share(centre, 0, mask)) : irradiance(centre, 0, {mask, 0, 0, 0}, 1);
  for (int q = 0; q < (f.level == 0 ? 1 : 4); ++q) {
    const std::size_t at = g.at(f.x + (q & 1 ? half : 0), f.y + (q & 2 ? half : 0));
    for (int c = 0; c < signal.channels; ++c) signal.value[static_cast<std::size_t>(c)][at] = value[c];
  }
}

}  // namespace sightline
