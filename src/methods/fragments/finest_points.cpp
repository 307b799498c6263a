#include "methods/fragments/finest_points.h"

#include <algorithm>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"

namespace sightline {
namespace {

// Enough sets that neighbours hardly ever share one, and few enough to stay in the L2 cache.
constexpr std::uint32_t kPoints = 1u << 13, kLeastSets = 4, kMostSets = 128;
constexpr std::size_t kChunk = 1024;

}  // namespace

std::uint32_t FinestPoints::hash_of(std::uint32_t pixel) const { return pixel_key(seed_, pixel); }

void FinestPoints::make(const LightTable& lights, const AreaLight& light, std::uint32_t sample, std::uint32_t count, QueryBatch& queries) {
  if (light_ == &light && sample_ == sample && count_ == count) return;
  light_ = &light, sample_ = sample, count_ = count;
  sets_ = std::clamp(kPoints / count, kLeastSets, kMostSets);
  uniform_ = light.members.size() == 1 && light.analytic;
  const std::size_t total = std::size_t{sets_} * count;
  queries.resize_lights(total + kLanes), radiance.resize(total + kLanes);
  for (auto* numbers : {&area, &power, &two_sided}) numbers->resize(padded(total) + kLanes);
  front_.resize(kChunk), samples_.resize(kChunk + kLanes);
  for (auto* numbers : {&key_, &index_, &entry_}) numbers->resize(kChunk);
  for (auto* numbers : {&u0_, &u1_, &selection_}) numbers->resize(kChunk + kLanes);
  std::fill_n(queries.semantic.data(), queries.semantic.size(), static_cast<std::uint8_t>(QuerySemantic::surface));

  for (std::size_t begin = 0; begin < total; begin += kChunk) {
    const std::size_t n = std::min(kChunk, total - begin);
    for (std::size_t i = 0; i < n; ++i) {
      const auto set = static_cast<std::uint32_t>((begin + i) / count), k = static_cast<std::uint32_t>((begin + i) % count);
      key_[i] = pixel_key(seed_, set), index_[i] = sample * count + k;
    }
    sobol_2d(key_.data(), index_.data(), dimension::pair_of(0, dimension::kLightPoint), n, u0_.data(), u1_.data());
    for (std::size_t i = 0; i < n; ++i) {
      const AreaLight::Member& member = light.members[light.pick(u0_[i])];
      entry_[i] = member.entry, selection_[i] = member.probability * static_cast<float>(count);
      two_sided[begin + i] = member.sides == EmitterSides::two ? 1.f : 0.f;
      // Seen from in front of it, wherever that is.
      store(front_, i, member.polygon[0] + member.normal * glm::length(member.polygon[1] - member.polygon[0]));
    }
    lights.sample_entries(entry_, selection_, front_, u0_, u1_, n, samples_);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t at = begin + i;
      const Color emitted = load(samples_.radiance, i);
      area[at] = lights.area(entry_[i]) / selection_[i], power[at] = area[at] * luminance(emitted);
      store(radiance, at, emitted), store(queries.light.position, at, load(samples_.point, i));
      store(queries.light.normal, at, load(samples_.normal, i));
      queries.light.error[at] = samples_.point_error[i], queries.light.cell_area[at] = area[at];
      queries.light.id[at] = hash_combine(static_cast<std::uint32_t>(at), entry_[i]);
    }
  }
}

}  // namespace sightline
