#include "shade/light_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "shade/lights/light_kernels.h"
#include "shade/lights/light_table_impl.h"
#include "trace/ray_batch.h"
#include "trace/sphere.h"

namespace sightline {

LightSample LightTable::Impl::sample_light(std::uint32_t index, float selection, const Vec3& position, const Vec2& u) const {
  if (index < lists.punctual_begin) {
    const FlatLight& light = lists.flats[index];
    const FlatEmitter& emitter = lists.emitters[light.emitter];
    LightSample s = sample_flat(light, emitter, index, selection, position, u);
    if (emitter.is(FlatEmitter::kTextured) && s.pdf > 0) s.radiance *= texture_of(light, u);
    return s;
  }
  if (index < lists.sphere_begin) return sample_punctual(lists.punctuals[index - lists.punctual_begin], index, selection, position);
  if (index == lists.environment_index) {
    LightSample s;
    s.light = index;
    s.wi = lists.environment->sample(u);
    s.distance = std::numeric_limits<float>::infinity();
    if (s.wi == Vec3(0)) return s;
    const EnvironmentLight::Evaluation evaluation = lists.environment->evaluate(s.wi);
    s.pdf = selection * evaluation.pdf;
    if (s.pdf > 0) s.radiance = evaluation.radiance;
    return s;
  }
  const SphereEmitter& sphere = lists.spheres[index - lists.sphere_begin];
  LightSample s = sample_sphere(sphere, index, selection, position, u);
  if (sphere.texture.valid() && s.pdf > 0) {
    const Vec2 uv = sphere_uv(sphere_local_direction(lists.scene_spheres[sphere.source], s.point));
    s.radiance *= glm::max(Color(textures.sample(sphere.texture, {.uv = uv})), Color(0));
  }
  return s;
}

std::size_t LightTable::Impl::sample_lanes(const LightLanes& lanes, std::uint32_t least, std::uint32_t greatest, std::span<const float> u0,
                                           std::span<const float> u1, std::size_t first, LightSampleBatch& samples) const {
  if (greatest < lists.disk_begin && lists.flats.size() <= kMaxVectorFlats) {
    const std::size_t done = sample_flat_lanes(lanes, lists.flats.data(), lists.emitters.data(), samples, first);
    if (!has_textures) return done;
    for (std::size_t i = first; i < first + done; ++i) {
      const FlatLight& light = lists.flats[samples.light[i]];
      if (!(samples.pdf[i] > 0) || !lists.emitters[light.emitter].is(FlatEmitter::kTextured)) continue;
      const Color texture = texture_of(light, {u0[i], u1[i]});
      samples.radiance.x[i] *= texture.x;
      samples.radiance.y[i] *= texture.y;
      samples.radiance.z[i] *= texture.z;
    }
    return done;
  }
  if (least >= lists.punctual_begin && greatest < lists.spot_begin) {
    return sample_punctual_lanes(lanes, lists.punctuals.data(), lists.punctual_begin, samples, first);
  }
  return 0;
}

LightTable::LightTable(const Scene& scene, const TextureSet& textures, const Bounds& bounds, const Context& context,
                       const LightTable* previous)
    : impl_(std::make_unique<const Impl>(scene, textures, bounds, context, previous ? previous->impl_.get() : nullptr)) {}
LightTable::~LightTable() = default;

std::size_t LightTable::size() const { return impl_->lists.size(); }
bool LightTable::has_environment() const { return impl_->lists.environment.has_value(); }

LightSample LightTable::sample(const Vec3& position, const Vec3& normal, float u_pick, const Vec2& u) const {
  const LightPicker::Pick pick = impl_->pick(position, normal, u_pick);
  if (!(pick.probability > 0)) return {};
  return impl_->sample_light(pick.light, pick.probability, position, u);
}

void LightTable::sample(const Vec3Batch& position, const Vec3Batch& normal, std::span<const float> u_pick, std::span<const float> u0,
                        std::span<const float> u1, std::size_t count, LightSampleBatch& samples) const {
  const std::optional<std::uint32_t> only = size() == 1 ? std::optional<std::uint32_t>(0) : std::nullopt;
  sample_by(impl_->picker.table(), only, position, normal, u_pick, u0, u1, count, samples);
}

void LightTable::sample(const LightSubset& subset, const Vec3Batch& position, const Vec3Batch& normal, std::span<const float> u_pick,
                        std::span<const float> u0, std::span<const float> u1, std::size_t count, LightSampleBatch& samples) const {
  const std::optional<std::uint32_t> only = subset.entries.size() == 1 ? std::optional(subset.entries.front()) : std::nullopt;
  sample_by(subset.choice, only, position, normal, u_pick, u0, u1, count, samples);
}

LightSubset LightTable::subset(std::uint32_t kinds) const {
  const LightLists& lists = impl_->lists;
  LightSubset subset;
  std::vector<float> powers(lists.powers.size(), 0.f);
  for (std::uint32_t i = 0; i < lists.size(); ++i) {
    const bool punctual = i >= lists.punctual_begin && i < lists.sphere_begin;
    const std::uint32_t kind = i == lists.environment_index ? LightSubset::kEnvironment
                               : punctual                   ? LightSubset::kPunctual
                                                            : LightSubset::kArea;
    if (!(kinds & kind) || !(lists.powers[i] > 0)) continue;
    subset.entries.push_back(i);
    powers[i] = lists.powers[i];
  }
  subset.choice = AliasTable(powers);
  return subset;
}

LightSample LightTable::sample_light(std::uint32_t light, float selection, const Vec3& position, const Vec2& u) const {
  return impl_->sample_light(light, selection, position, u);
}

void LightTable::sample_by(const AliasTable& choice, std::optional<std::uint32_t> only, const Vec3Batch& position, const Vec3Batch&,
                           std::span<const float> u_pick, std::span<const float> u0, std::span<const float> u1, std::size_t count,
                           LightSampleBatch& samples) const {
  if (samples.pdf.size() < padded(count)) samples.resize(count);
  // One sample after the other where there is no vector code.
  const auto scalar = [&](std::size_t begin, std::size_t end) {
    std::array<LightSample, kLanes> drawn;
    for (; begin < end; begin += kLanes) {
      const std::size_t n = std::min(kLanes, end - begin);
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t i = begin + k;
        drawn[k] = {};
        if (!choice.can_sample()) continue;
        const std::uint32_t light = only ? *only : choice.sample(u_pick[i]).index;
        drawn[k] = impl_->sample_light(light, choice.probability(light), {position.x[i], position.y[i], position.z[i]}, {u0[i], u1[i]});
      }
      samples.set(begin, std::span(drawn.data(), n));
    }
  };
  if (!choice.can_sample()) return scalar(0, count);
  if (only) {
    LightLanes lanes{};
    lanes.x = position.x.data(), lanes.y = position.y.data(), lanes.z = position.z.data();
    lanes.u0 = u0.data(), lanes.u1 = u1.data();
    lanes.count = count;
    lanes.single = *only;
    lanes.single_selection = choice.probability(*only);
    return scalar(impl_->sample_lanes(lanes, *only, *only, u0, u1, 0, samples), count);
  }
  constexpr std::size_t kChunk = 256;
  alignas(kCacheLine) std::array<std::uint32_t, kChunk> light;
  alignas(kCacheLine) std::array<float, kChunk> probability;
  std::size_t begin = 0;
  while (begin < count) {
    const std::size_t picked =
        pick_lights(choice, u_pick.data() + begin, std::min(kChunk, count - begin), light.data(), probability.data());
    if (picked == 0) return scalar(begin, count);
    impl_->sample_chosen({light.data(), picked}, {probability.data(), picked}, position, u0, u1, begin, samples);
    begin += picked;
  }
}

void LightTable::sample_entries(std::span<const std::uint32_t> light, std::span<const float> selection, const Vec3Batch& position,
                                std::span<const float> u0, std::span<const float> u1, std::size_t count, LightSampleBatch& samples) const {
  if (samples.pdf.size() < padded(count)) samples.resize(count);
  impl_->sample_chosen(light.first(count), selection.first(count), position, u0, u1, 0, samples);
}

// Lights that have been chosen, for lanes from `first` on: all of them together where one kind is all there is, else whole padded groups
// that chose one kind.
void LightTable::Impl::sample_chosen(std::span<const std::uint32_t> light, std::span<const float> selection, const Vec3Batch& position,
                                     std::span<const float> u0, std::span<const float> u1, std::size_t first,
                                     LightSampleBatch& samples) const {
  const std::size_t group = lists.is_all_one_kind() ? light.size() : kLanes;
  for (std::size_t at = 0; at < light.size(); at += group) {
    const std::size_t n = std::min(group, light.size() - at), begin = first + at;
    // Which kinds a group holds shows in its range of entries; where there is but one kind, nothing needs to be looked at.
    std::uint32_t least = 0, greatest = static_cast<std::uint32_t>(lists.size() - 1);
    if (!lists.is_all_one_kind()) {
      const auto [low, high] = std::ranges::minmax_element(light.subspan(at, n));
      least = *low, greatest = *high;
    }
    LightLanes lanes{};
    lanes.x = position.x.data() + begin, lanes.y = position.y.data() + begin, lanes.z = position.z.data() + begin;
    lanes.u0 = u0.data() + begin, lanes.u1 = u1.data() + begin;
    lanes.count = n;
    lanes.light = light.data() + at, lanes.selection = selection.data() + at;
    const std::size_t done = sample_lanes(lanes, least, greatest, u0, u1, begin, samples);
    std::array<LightSample, kLanes> drawn;
    for (std::size_t k = done; k < n;) {
      const std::size_t few = std::min(kLanes, n - k);
      for (std::size_t j = 0; j < few; ++j) {
        const std::size_t lane = begin + k + j;
        drawn[j] = sample_light(light[at + k + j], selection[at + k + j], {position.x[lane], position.y[lane], position.z[lane]},
                                {u0[lane], u1[lane]});
      }
      samples.set(begin + k, std::span(drawn.data(), few));
      k += few;
    }
  }
}

std::uint32_t LightTable::light_of(std::uint32_t instance, std::uint32_t primitive) const {
  if (instance == kNoHit) return kNoLight;
  if (instance & kSphereBit) {
    const std::uint32_t sphere = instance & ~kSphereBit;
    return sphere < impl_->lists.light_of_sphere.size() ? impl_->lists.light_of_sphere[sphere] : kNoLight;
  }
  return impl_->lists.meshes.light_of(instance, primitive);
}

float LightTable::pdf(const Vec3& position, const Vec3& normal, std::uint32_t light, const Vec3& hit_point, const Vec3&,
                      const Vec3& direction) const {
  const LightLists& lists = impl_->lists;
  if (light >= lists.size()) return 0;
  const float selection = impl_->picker.probability(position, normal, light);
  if (light < lists.punctual_begin) {
    const FlatLight& flat = lists.flats[light];
    return view_flat(flat, lists.emitters[flat.emitter].is(FlatEmitter::kTwoSided), position, hit_point, selection).pdf;
  }
  if (light < lists.sphere_begin) return 0;
  if (light == lists.environment_index) return selection * lists.environment->pdf(direction);
  return pdf_sphere(lists.spheres[light - lists.sphere_begin], selection, position, hit_point);
}

Color LightTable::emission(std::uint32_t light, const TexturePoint& point, bool front_side) const {
  const LightLists& lists = impl_->lists;
  const auto textured = [&](const Color& radiance, TextureId texture) {
    return texture.valid() ? radiance * glm::max(Color(impl_->textures.sample(texture, point)), Color(0)) : radiance;
  };
  if (light < lists.punctual_begin) {
    const FlatEmitter& emitter = lists.emitters[lists.flats[light].emitter];
    return front_side || emitter.is(FlatEmitter::kTwoSided) ? textured(emitter.radiance, emitter.texture) : Color(0);
  }
  if (light >= lists.sphere_begin && light < lists.size() && light != lists.environment_index) {
    // The front of a reversed sphere is its inside.
    const SphereEmitter& sphere = lists.spheres[light - lists.sphere_begin];
    const bool two_sided = sphere.emits_inside && sphere.emits_outside;
    return front_side || two_sided ? textured(sphere.radiance, sphere.texture) : Color(0);
  }
  return Color(0);
}

Color LightTable::environment(const Vec3& direction) const {
  return impl_->lists.environment ? impl_->lists.environment->radiance(direction) : Color(0);
}

void LightTable::environment(const Vec3Batch& direction, std::size_t count, Vec3Batch& radiance) const {
  if (impl_->lists.environment) return impl_->lists.environment->radiance(direction, count, radiance);
  if (radiance.x.size() < padded(count)) radiance.resize(count);
  for (AlignedVector<float>* values : {&radiance.x, &radiance.y, &radiance.z}) std::fill(values->begin(), values->end(), 0.f);
}

float LightTable::environment_density(const Vec3& direction) const {
  return impl_->lists.environment ? impl_->lists.environment->pdf(direction) : 0.f;
}

float LightTable::environment_pdf(const Vec3& position, const Vec3& normal, const Vec3& direction) const {
  const LightLists& lists = impl_->lists;
  if (!lists.environment) return 0;
  return impl_->picker.probability(position, normal, lists.environment_index) * lists.environment->pdf(direction);
}

float LightTable::area(std::uint32_t light) const {
  const LightLists& lists = impl_->lists;
  if (light < lists.punctual_begin) return lists.flats[light].area;
  if (light < lists.sphere_begin || light >= lists.sphere_begin + lists.spheres.size()) return 0;
  const float radius = lists.spheres[light - lists.sphere_begin].radius;
  return 2 * kPi * radius * radius;
}

const FlatLight* LightTable::flat(std::uint32_t light) const {
  return light < impl_->lists.punctual_begin ? &impl_->lists.flats[light] : nullptr;
}
const FlatEmitter* LightTable::flat_emitter(std::uint32_t light) const {
  const FlatLight* found = flat(light);
  return found ? &impl_->lists.emitters[found->emitter] : nullptr;
}

float LightTable::power(std::uint32_t light) const { return light < impl_->lists.size() ? impl_->lists.powers[light] : 0.f; }

}  // namespace sightline
