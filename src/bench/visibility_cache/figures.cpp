#include "bench/visibility_cache/figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sightline {
namespace {

double sum(const Vec3& v) { return static_cast<double>(v.x) + static_cast<double>(v.y) + static_cast<double>(v.z); }
double ratio(std::uint64_t a, std::uint64_t b) { return b > 0 ? static_cast<double>(a) / static_cast<double>(b) : 0.0; }

}  // namespace

QueryFigures query_figures(const VisibilityCounts& counts) {
  QueryFigures figures;
  if (counts.queries == 0) return figures;
  figures.share_traced = ratio(counts.traced, counts.queries);
  const std::uint64_t hits = counts.queries - std::min(counts.queries, counts.traced);
  figures.ray_reduction = counts.traced > 0 ? ratio(hits, counts.traced) : std::numeric_limits<double>::infinity();
  figures.lookups_per_query = ratio(counts.lookups, counts.queries);
  figures.rejected_share = ratio(counts.rejected, counts.lookups);
  return figures;
}

double signed_error(const ColorImage& reference, const ColorImage& image, std::span<const std::uint8_t> mask) {
  double difference = 0, total = 0;
  for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    difference += sum(image.pixels[i]) - sum(reference.pixels[i]);
    total += sum(reference.pixels[i]);
  }
  return total > 0 ? difference / total : 0;
}

int samples_in_time(int samples, double seconds, double budget) {
  if (!(seconds > 0) || !(budget > 0)) return 1;
  return static_cast<int>(std::clamp(std::round(samples * budget / seconds), 1.0, 65536.0));
}

void Flicker::add(const ColorImage& exact, const ColorImage& image) {
  ColorImage difference(exact.width, exact.height);
  for (std::size_t i = 0; i < exact.pixels.size(); ++i) difference.pixels[i] = image.pixels[i] - exact.pixels[i];
  if (difference_.pixels.size() == difference.pixels.size()) {
    for (std::size_t i = 0; i < exact.pixels.size(); ++i) {
      change_ += sum(glm::abs(difference.pixels[i] - difference_.pixels[i]));
      light_ += sum(exact.pixels[i]);
    }
  }
  difference_ = std::move(difference);
}

}  // namespace sightline
