#include "methods/shadow_queries.h"

#include <algorithm>
#include <cmath>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"

namespace sightline {
namespace {

QuerySemantic semantic_of(const LightSampleBatch& light, std::size_t lane) {
  const bool infinite = std::isinf(light.distance[lane]);
  if (light.is_delta[lane]) return infinite ? QuerySemantic::direction : QuerySemantic::point;
  return infinite ? QuerySemantic::solid_angle : QuerySemantic::surface;
}

}  // namespace

ShadowQueries::ShadowQueries(const World& world, const View& view, Visibility& visibility, float samples_a_pixel, int light_samples)
    : footprint_(view, samples_a_pixel),
      light_samples_(static_cast<float>(light_samples)),
      worker_(visibility.worker()),
      end_of_light_(world.lights().size(), kNoQuery) {}

std::uint32_t ShadowQueries::add_eye(const ShadowStage& stage, std::uint32_t point) {
  const SurfaceBatch& surfaces = *stage.points.surfaces;
  const Vec3 direction = load(stage.points.rays->direction, point), geometric = load(surfaces.geometric_normal, point);
  // The side that the path arrived from.
  const Vec3 normal = glm::dot(geometric, direction) > 0 ? -geometric : geometric;
  const float area = stage.camera_hits ? footprint_.area(direction, stage.hits->t[point], geometric) : 0.f;
  const auto end = static_cast<std::uint32_t>(queries_.eye.size++);
  queries_.eye.set(end, load(surfaces.position, point), normal, surfaces.error[point], area, stage.point_id[point]);
  return end;
}

std::uint32_t ShadowQueries::add_light(const ShadowStage& stage, std::uint32_t lane) {
  const LightSampleBatch& light = *stage.light;
  const QuerySemantic semantic = semantic_of(light, lane);
  // All points ask about the same light without extent: one end serves them.
  std::uint32_t* shared = light.is_delta[lane] ? &end_of_light_[light.light[lane]] : nullptr;
  if (shared && *shared != kNoQuery) return *shared;
  const auto end = static_cast<std::uint32_t>(queries_.light.size++);
  queries_.semantic[end] = static_cast<std::uint8_t>(semantic);
  if (shared) {
    *shared = end;
    lights_used_.push_back(light.light[lane]);
    const Vec3 position = semantic == QuerySemantic::point ? load(light.point, lane) : load(light.wi, lane);
    queries_.light.set(end, position, Vec3(0), light.point_error[lane], 1, hash32(light.light[lane]));
    return end;
  }
  // N_S / (N_P P(p_l)), with n light samples a shading point 1 / (n P) [Popov2013, Eqs. 7 and 9].
  const float solid_angle = 1 / (light_samples_ * light.pdf[lane]);
  const std::uint32_t id = hash32(stage.sample_index[lane]);
  if (semantic == QuerySemantic::solid_angle) {
    queries_.light.set(end, load(light.wi, lane), Vec3(0), 0, solid_angle, id);
    return end;
  }
  // From solid angle to area. A light's end has its normal on the side of the ray.
  const Vec3 emitting = load(light.normal, lane), wi = load(light.wi, lane);
  const float cosine = std::fabs(glm::dot(emitting, wi)), distance = light.distance[lane];
  const Vec3 normal = glm::dot(emitting, wi) > 0 ? -emitting : emitting;
  const float area = solid_angle * distance * distance / std::fmax(cosine, 1e-3f);
  queries_.light.set(end, load(light.point, lane), normal, light.point_error[lane], area, id);
  return end;
}

void ShadowQueries::make_queries(const ShadowStage& stage) {
  const ShadowLanes& shadow = *stage.shadow;
  queries_.eye.resize(shadow.count), queries_.resize_lights(shadow.count), queries_.resize_queries(shadow.count);
  queries_.eye.size = queries_.light.size = queries_.size = 0;
  queries_.kind = stage.coherent ? BatchKind::shadow : BatchKind::shadow_diffuse;
  lane_of_.clear();
  std::uint32_t eye = kNoQuery, eye_point = kNoQuery;
  const auto add = [&](std::size_t lane, std::uint32_t eye_end, std::uint32_t light_end) {
    queries_.eye_of[queries_.size] = eye_end, queries_.light_of[queries_.size] = light_end;
    ++queries_.size;
    lane_of_.push_back(static_cast<std::uint32_t>(lane));
  };
  for (std::size_t lane = 0; lane < shadow.count; ++lane) {
    if (shadow.rays.t_far[lane] < 0) {
      // Coherent packets are what the caller made them; all others do without gaps.
      if (stage.coherent) add(lane, 0, kNoQuery);
      continue;
    }
    const std::uint32_t point = shadow.point[lane];
    if (point != eye_point) eye = add_eye(stage, point), eye_point = point;
    add(lane, eye, add_light(stage, stage.light_lane ? stage.light_lane[lane] : static_cast<std::uint32_t>(lane)));
  }
  for (const std::uint32_t light : lights_used_) end_of_light_[light] = kNoQuery;
  lights_used_.clear();
}

std::span<const float> ShadowQueries::visible(const ShadowStage& stage, RayCounts& rays, VisibilityCounts& counts) {
  const std::size_t lanes = stage.shadow->count;
  answers_.resize(std::max(answers_.size(), padded(lanes)));
  weights_.resize(std::max(weights_.size(), padded(lanes)));
  make_queries(stage);
  worker_->visible(queries_, answers_, rays, counts);
  std::fill_n(weights_.begin(), lanes, 0.f);
  for (std::size_t q = 0; q < queries_.size; ++q) weights_[lane_of_[q]] = answers_[q];
  return std::span<const float>(weights_).first(lanes);
}

}  // namespace sightline
