// Direct light of the path kernel: light samples, shadow rays, and queries where a visibility answers instead of rays.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/reference/kernel.h"
#include "methods/reference/kernel_common.h"

namespace sightline {

using dimension::pair_of;

void PathKernel::sample_lights(std::uint32_t bounce) {
  if (world_.lights().size() == 0) return;
  if (options_.light_samples == 1)
    sample_lights_once(bounce);
  else
    sample_lights_often(bounce);
}

// Keys and sample indices of the living paths. Before the first bounce they stand in order.
void PathKernel::gather_keys(std::uint32_t bounce) {
  if (bounce == 0) {
    std::copy_n(key_.data(), alive_, scratch_key_.data());
    std::copy_n(sample_.data(), alive_, scratch_index_.data());
    return;
  }
  for (std::size_t i = 0; i < alive_; ++i) scratch_key_[i] = key_[slot_[i]], scratch_index_[i] = sample_[slot_[i]];
}

void PathKernel::draw_light_samples(std::uint32_t bounce, std::size_t count, const Vec3Batch& positions, const Vec3Batch& normals) {
  sobol_2d(scratch_key_.data(), scratch_index_.data(), pair_of(bounce, dimension::kLightPoint), count, u0_.data(), u1_.data());
  if (world_.lights().size() > 1)
    sobol_1d(scratch_key_.data(), scratch_index_.data(), pair_of(bounce, dimension::kLightPick), count, u2_.data());
  world_.lights().sample(positions, normals, u2_, u0_, u1_, count, light_);
}

// One light sample a point: lanes are the points themselves, nothing is copied.
void PathKernel::sample_lights_once(std::uint32_t bounce) {
  gather_keys(bounce);
  draw_light_samples(bounce, alive_, surfaces_.position, surfaces_.geometric_normal);
  shadow_.count = 0;
  shadow_.in_place = queries_ || coherent_shadows(bounce);
  append_direct_light_each({&rays_, &surfaces_, &throughput_}, 0, light_, alive_, plain_.data(), {1, !options_.one_hit}, shadow_);
  for (std::size_t i = 0; i < alive_ && !all_plain_; ++i) {
    if (!shaded_[i] || plain_[i] || bsdf_[i].is_delta()) continue;
    if (shadow_.in_place)
      set_general(i, i, i);
    else
      shadow_.count += set_general(i, i, shadow_.count);
  }
  trace_shadows(bounce);
}

// Camera hits of a block and the samples of one point make coherent packets; a few samples a point would leave most of a packet empty.
bool PathKernel::coherent_shadows(std::uint32_t bounce) const {
  return bounce == 0 && (options_.light_samples == 1 || options_.light_samples >= 8);
}

// Several samples a point: the samples of a point stand side by side, points are worked off in chunks of lanes.
void PathKernel::sample_lights_often(std::uint32_t bounce) {
  const std::uint32_t samples = static_cast<std::uint32_t>(options_.light_samples);
  const DirectLightOptions direct{static_cast<float>(samples), !options_.one_hit};
  std::size_t lanes = 0;
  const auto flush = [&] {
    if (lanes == 0) return;
    draw_light_samples(bounce, lanes, light_position_, light_normal_);
    shadow_.count = 0;
    shadow_.in_place = queries_ || coherent_shadows(bounce);
    for (const Run& run : runs_) {
      if (plain_[run.point]) {
        append_direct_light({&rays_, &surfaces_, &throughput_}, run.point, light_, run.first, run.count, direct, shadow_);
      } else {
        const std::size_t base = shadow_.count;
        for (std::size_t k = 0; k < run.count; ++k) {
          if (shadow_.in_place) set_inactive(base + k, run.point);
          shadow_.count += set_general(run.point, run.first + k, shadow_.in_place ? base + k : shadow_.count);
        }
        if (shadow_.in_place) {
          for (std::size_t k = run.count; k < padded(run.count); ++k) set_inactive(base + k, run.point);
          shadow_.count = base + padded(run.count);
        }
      }
    }
    trace_shadows(bounce);
    runs_.clear();
    lanes = 0;
  };
  for (std::size_t i = 0; i < alive_; ++i) {
    if (!shaded_[i] || (!plain_[i] && bsdf_[i].is_delta())) continue;
    const std::uint32_t slot = slot_[i], key = key_[slot], first_index = sample_[slot] * samples;
    // Where a point's samples are cut decides how their sum is rounded: at places that depend on nothing but their number.
    if (lanes + samples > kLightChunk) flush();
    for (std::uint32_t k = 0; k < samples;) {
      // As many samples of the point as the chunk still takes.
      const std::size_t run = std::min<std::size_t>(samples - k, kLightChunk - lanes);
      std::fill_n(scratch_key_.data() + lanes, run, key);
      std::iota(scratch_index_.data() + lanes, scratch_index_.data() + lanes + run, first_index + k);
      fill(light_position_, lanes, run, load(surfaces_.position, i));
      fill(light_normal_, lanes, run, load(surfaces_.geometric_normal, i));
      runs_.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(lanes), static_cast<std::uint32_t>(run)});
      lanes += run, k += static_cast<std::uint32_t>(run);
      if (lanes == kLightChunk) flush();
    }
  }
  flush();
}

void PathKernel::set_inactive(std::size_t at, std::size_t point) {
  shadow_.rays.set(at, {Vec3(0), 0, Vec3(0, 0, 1), -1});
  store(shadow_.contribution, at, Color(0));
  shadow_.point[at] = static_cast<std::uint32_t>(point);
}

// One light sample at a point whose material is not plain Lambert, to lane `at`: the scalar definition of what the vector path does.
// False if it carries nothing; the lane is then left as it is.
bool PathKernel::set_general(std::size_t point, std::size_t lane, std::size_t at) {
  if (!(light_.pdf[lane] > 0)) return false;
  const float samples = static_cast<float>(options_.light_samples);
  const Vec3 wi = load(light_.wi, lane);
  const Vec3 wo = -load(rays_.direction, point);
  const Vec3 geometric = load(surfaces_.geometric_normal, point);
  const Vec3 wo_local = frame_[point].to_local(wo), wi_local = frame_[point].to_local(wi);
  // Reflection by the shading normal must be reflection by the geometric one, else light leaks through.
  if ((wo_local.z * wi_local.z > 0) != (glm::dot(wo, geometric) * glm::dot(wi, geometric) > 0)) return false;
  const BsdfEval eval = bsdf_[point].evaluate(wo_local, wi_local);
  Color value = eval.f_cos * load(light_.radiance, lane) * (1 / (light_.pdf[lane] * samples));
  if (is_black(value)) return false;
  // Rays find emissive geometry and the environment too; lights that only sampling sees keep weight 1.
  const bool infinite = std::isinf(light_.distance[lane]);
  const bool other_technique = !options_.one_hit && !light_.is_delta[lane] && (light_.is_mesh[lane] || infinite);
  if (other_technique) value *= power_heuristic(samples * light_.pdf[lane], eval.pdf);
  const Vec3 origin = offset_origin(load(surfaces_.position, point), geometric, surfaces_.error[point], wi);
  if (infinite) {
    shadow_.rays.set(at, {origin, 0, wi, kInfinity});
  } else {
    const Vec3 target = offset_origin(load(light_.point, lane), load(light_.normal, lane), light_.point_error[lane], -wi);
    shadow_.rays.set(at, {origin, 0, target - origin, 1});
  }
  store(shadow_.contribution, at, load(throughput_, point) * value);
  shadow_.point[at] = static_cast<std::uint32_t>(point);
  return true;
}

// Beer-Lambert along the shadow rays that arrive: those whose weight is not `dark`.
template <class Weight>
void PathKernel::absorb_shadows(std::span<const Weight> weights, Weight dark) {
  const Media& media = medium_rays_.media();
  if (!media.any()) return;
  absorbed_.resize(shadow_.count);
  absorbed_medium_.clear(), absorbed_lane_.clear();
  for (std::uint32_t r = 0; r < shadow_.count; ++r) {
    if (weights[r] == dark || shadow_.rays.t_far[r] < 0) continue;
    const std::uint32_t point = shadow_.point[r], material = surfaces_.material[point];
    const Ray ray = shadow_.rays.get(r);
    const MediumId interior = material < world_.scene().materials.size() ? world_.scene().materials[material].interior : MediumId{};
    const MediumId medium =
        Media::towards(ray.direction, -load(rays_.direction, point), load(surfaces_.geometric_normal, point), medium_[point], interior);
    if (!medium.valid() && !media.any_interface()) continue;
    absorbed_.set(absorbed_lane_.size(), ray);
    absorbed_medium_.push_back(medium), absorbed_lane_.push_back(r);
  }
  absorbed_.resize(absorbed_lane_.size());
  const std::span<const Color> left = medium_rays_.attenuate(absorbed_, absorbed_medium_, counts_);
  for (std::size_t k = 0; k < absorbed_lane_.size(); ++k) {
    const std::uint32_t r = absorbed_lane_[k];
    store(shadow_.contribution, r, load(shadow_.contribution, r) * left[k]);
  }
}

// What trace_shadows does, with weights from the visibility.
void PathKernel::ask_visibility(std::uint32_t bounce) {
  for (std::size_t i = 0; i < alive_; ++i) point_id_[i] = hash_combine(hash_combine(key_[slot_[i]], sample_[slot_[i]]), bounce);
  // Runs of light samples begin at whole groups of lanes.
  light_lane_.clear();
  for (const Run& run : runs_) {
    for (std::uint32_t k = 0; k < padded(run.count); ++k) light_lane_.push_back(run.first + std::min(k, run.count - 1));
  }
  const ShadowStage stage{{&rays_, &surfaces_, &throughput_},
                          &hits_,
                          point_id_.data(),
                          &light_,
                          runs_.empty() ? nullptr : light_lane_.data(),
                          scratch_index_.data(),
                          &shadow_,
                          bounce == 0,
                          coherent_shadows(bounce)};
  const std::span<const float> weights = queries_->visible(stage, counts_, visibility_counts_);
  absorb_shadows(weights, 0.f);
  Vec3Batch& radiance = bounce == 0 ? direct_ : indirect_;
  for (std::size_t r = 0; r < shadow_.count;) {
    const std::uint32_t point = shadow_.point[r];
    Color sum(0);
    for (; r < shadow_.count && shadow_.point[r] == point; ++r) sum += weights[r] * load(shadow_.contribution, r);
    add(radiance, slot_[point], sum);
  }
}

void PathKernel::trace_shadows(std::uint32_t bounce) {
  if (shadow_.count == 0) return;
  if (queries_) {
    ask_visibility(bounce);
    return;
  }
  shadow_.rays.size = shadow_.count;
  world_.tracer().occluded(shadow_.rays, std::span(occluded_), shadow_.in_place ? BatchKind::shadow : BatchKind::shadow_diffuse, counts_);
  absorb_shadows(std::span<const std::uint8_t>(occluded_), std::uint8_t{1});
  Vec3Batch& radiance = bounce == 0 ? direct_ : indirect_;
  if (bounce == 0 && shadow_.in_place && options_.light_samples == 1) {
    // Before the first bounce the path of lane i is i.
    add_visible(shadow_, occluded_.data(), alive_, radiance);
    return;
  }
  // Samples of one point stand side by side: sum them before going to the path.
  for (std::size_t r = 0; r < shadow_.count;) {
    const std::uint32_t point = shadow_.point[r];
    Color sum(0);
    for (; r < shadow_.count && shadow_.point[r] == point; ++r) {
      const float visible = occluded_[r] ? 0.f : 1.f;
      sum += visible * load(shadow_.contribution, r);
    }
    add(radiance, slot_[point], sum);
  }
}

}  // namespace sightline
