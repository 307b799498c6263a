#include "methods/fragments/sampled_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"

namespace sightline {

using dimension::pair_of;

SampledLight::SampledLight(const World& world, const View& view, int light_samples, Visibility* visibility)
    : world_(world), light_samples_(static_cast<std::uint32_t>(light_samples)) {
  if (visibility && !visibility->exact()) queries_ = std::make_unique<ShadowQueries>(world, view, *visibility, 1.f, light_samples);
  position_.resize(kChunk), normal_.resize(kChunk);
  key_.resize(kChunk), index_.resize(kChunk), u0_.resize(kChunk), u1_.resize(kChunk), u2_.resize(kChunk);
  light_.resize(kChunk + kLanes);
  shadow_.resize(2 * kChunk), occluded_.resize(2 * kChunk);
}

void SampledLight::begin(std::uint32_t scope) {
  if (queries_) queries_->begin_tile(scope);
}

void SampledLight::shade(const SampledPoints& points, std::span<const std::uint32_t> which, Vec3Batch& radiance,
                         PassStatistics& statistics) {
  if (world_.lights().size() == 0) return;
  if (throughput_.x.size() < padded(points.rays->size)) throughput_.resize(points.rays->size);
  fill(throughput_, 0, points.rays->size, Color(1));
  if (queries_) {
    point_id_.resize(points.rays->size);
    for (std::size_t i = 0; i < points.rays->size; ++i) point_id_[i] = hash_combine(hash_combine(points.key[i], points.sample), 0);
  }
  const std::uint32_t samples = light_samples_;
  for (const std::uint32_t i : which) {
    if (!points.plain[i] && (*points.bsdf)[i].is_delta()) continue;
    // Where a point's samples are cut decides how their sum is rounded: at places that depend on nothing but their number.
    if (lanes_ + samples > kChunk) flush(points, radiance, statistics);
    for (std::uint32_t k = 0; k < samples;) {
      const std::size_t run = std::min<std::size_t>(samples - k, kChunk - lanes_);
      std::fill_n(key_.data() + lanes_, run, points.key[i]);
      std::iota(index_.data() + lanes_, index_.data() + lanes_ + run, points.sample * samples + k);
      fill(position_, lanes_, run, load(points.surfaces->position, i));
      fill(normal_, lanes_, run, load(points.surfaces->geometric_normal, i));
      runs_.push_back({i, static_cast<std::uint32_t>(lanes_), static_cast<std::uint32_t>(run)});
      lanes_ += run, k += static_cast<std::uint32_t>(run);
      if (lanes_ == kChunk) flush(points, radiance, statistics);
    }
  }
  flush(points, radiance, statistics);
}

void SampledLight::flush(const SampledPoints& points, Vec3Batch& radiance, PassStatistics& statistics) {
  if (lanes_ == 0) return;
  sobol_2d(key_.data(), index_.data(), pair_of(0, dimension::kLightPoint), lanes_, u0_.data(), u1_.data());
  if (world_.lights().size() > 1) sobol_1d(key_.data(), index_.data(), pair_of(0, dimension::kLightPick), lanes_, u2_.data());
  world_.lights().sample(position_, normal_, u2_, u0_, u1_, lanes_, light_);
  shadow_.count = 0, shadow_.in_place = true;
  const ShadingPoints shading{points.rays, points.surfaces, &throughput_};
  light_lane_.clear();
  for (const Run& run : runs_) {
    if (points.plain[run.point]) {
      append_direct_light(shading, run.point, light_, run.first, run.count, {static_cast<float>(light_samples_), false}, shadow_);
    } else {
      const std::size_t base = shadow_.count;
      for (std::size_t k = 0; k < padded(run.count); ++k) {
        shadow_.rays.set(base + k, {Vec3(0), 0, Vec3(0, 0, 1), -1});
        store(shadow_.contribution, base + k, Color(0));
        shadow_.point[base + k] = run.point;
      }
      for (std::size_t k = 0; k < run.count; ++k) set_general(points, run.point, run.first + k, base + k);
      shadow_.count = base + padded(run.count);
    }
    for (std::uint32_t k = 0; queries_ && k < padded(run.count); ++k) light_lane_.push_back(run.first + std::min(k, run.count - 1));
  }
  std::span<const float> weights;
  if (queries_) {
    const ShadowStage stage{shading, points.hits, point_id_.data(), &light_, light_lane_.data(), index_.data(), &shadow_, true, true};
    weights = queries_->visible(stage, statistics.rays, statistics.visibility);
  } else {
    shadow_.rays.size = shadow_.count;
    const std::uint64_t before = statistics.rays.occlusion;
    world_.tracer().occluded(shadow_.rays, std::span(occluded_), BatchKind::shadow, statistics.rays);
    statistics.visibility.queries += statistics.rays.occlusion - before, statistics.visibility.traced += statistics.rays.occlusion - before;
  }
  for (std::size_t r = 0; r < shadow_.count;) {
    const std::uint32_t point = shadow_.point[r];
    Color sum(0);
    for (; r < shadow_.count && shadow_.point[r] == point; ++r)
      sum += (queries_ ? weights[r] : occluded_[r] ? 0.f : 1.f) * load(shadow_.contribution, r);
    add(radiance, point, sum);
  }
  runs_.clear();
  lanes_ = 0;
}

// The scalar definition of what the vector path does, for any BSDF.
void SampledLight::set_general(const SampledPoints& points, std::size_t point, std::size_t lane, std::size_t at) {
  if (!(light_.pdf[lane] > 0)) return;
  const SurfaceBatch& surfaces = *points.surfaces;
  const Frame3& frame = (*points.frames)[point];
  const Vec3 wi = load(light_.wi, lane), wo = -load(points.rays->direction, point);
  const Vec3 geometric = load(surfaces.geometric_normal, point);
  const Vec3 wo_local = frame.to_local(wo), wi_local = frame.to_local(wi);
  // Reflection by the shading normal must be reflection by the geometric one, else light leaks through.
  if ((wo_local.z * wi_local.z > 0) != (glm::dot(wo, geometric) * glm::dot(wi, geometric) > 0)) return;
  const Color value = (*points.bsdf)[point].evaluate(wo_local, wi_local).f_cos * load(light_.radiance, lane) *
                      (1 / (light_.pdf[lane] * static_cast<float>(light_samples_)));
  if (is_black(value)) return;
  const Vec3 origin = offset_origin(load(surfaces.position, point), geometric, surfaces.error[point], wi);
  if (std::isinf(light_.distance[lane])) {
    shadow_.rays.set(at, {origin, 0, wi, std::numeric_limits<float>::infinity()});
  } else {
    const Vec3 target = offset_origin(load(light_.point, lane), load(light_.normal, lane), light_.point_error[lane], -wi);
    shadow_.rays.set(at, {origin, 0, target - origin, 1});
  }
  store(shadow_.contribution, at, value);
}

}  // namespace sightline
