#include "methods/visibility_cache/contributions.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

Vec3 load(const Vec3Batch& batch, std::size_t i) { return {batch.x[i], batch.y[i], batch.z[i]}; }

/// f cos of a surface for two world directions. Reflection by the shading normal must be reflection by the geometric one, else light would
/// leak through the surface.
BsdfEval evaluate(const Bsdf& bsdf, const Frame3& frame, const Vec3& geometric, const Vec3& wo, const Vec3& wi) {
  const Vec3 wo_local = frame.to_local(wo), wi_local = frame.to_local(wi);
  if ((wo_local.z * wi_local.z > 0) != (glm::dot(wo, geometric) * glm::dot(wi, geometric) > 0)) return {};
  return bsdf.evaluate(wo_local, wi_local);
}

void append(const Color& color, std::uint32_t eye_index, std::uint32_t light, Contributions& out) {
  if (!(max_component(color) > 0)) return;
  out.color.x[out.size] = color.x, out.color.y[out.size] = color.y, out.color.z[out.size] = color.z;
  out.eye[out.size] = eye_index, out.light[out.size] = light;
  ++out.size;
}

}  // namespace

Color sample_contribution(const EyeSample& eye, const LightSampleBatch& lights, std::size_t lane, const SampleWeights& weights) {
  const float pdf = lights.pdf[lane];
  if (!(pdf > 0)) return Color(0);
  const BsdfEval eval = evaluate(eye.bsdf, eye.frame, eye.geometric_normal, eye.wo, load(lights.wi, lane));
  float scale = weights.scale / pdf;
  if (weights.mis_bsdf > 0) scale *= weights.mis_light * pdf / (weights.mis_light * pdf + weights.mis_bsdf * eval.pdf);
  return eye.weight * eval.f_cos * load(lights.radiance, lane) * scale;
}

Color virtual_light_contribution(const EyeSample& eye, const VirtualPointLights& lights, std::size_t j) {
  const Vec3 to = load(lights.position, j) - eye.position;
  const float squared = glm::dot(to, to);
  if (!(squared > 0)) return Color(0);
  const Vec3 wi = to / std::sqrt(squared), normal = load(lights.normal, j);
  const BsdfEval at_eye = evaluate(eye.bsdf, eye.frame, eye.geometric_normal, eye.wo, wi);
  if (is_black(at_eye.f_cos)) return Color(0);
  // f_cos holds the eye's cosine.
  const float cos_eye = std::fabs(glm::dot(wi, eye.frame.normal)), cos_sent = std::fabs(glm::dot(wi, normal));
  const float geometry = cos_eye * cos_sent / squared;
  const float clamped = geometry > lights.max_geometry_term ? lights.max_geometry_term / geometry : 1.f;
  const Color sent =
      lights.lambert[j] ? (glm::dot(wi, normal) < 0 ? load(lights.radiosity, j) : Color(0)) : radiance_towards(lights, j, -wi);
  return eye.weight * at_eye.f_cos * sent * (clamped * cos_sent / squared);
}

void add_samples(const EyeSample& eye, std::uint32_t eye_index, const LightSampleBatch& lights, std::size_t first, std::size_t count,
                 std::uint32_t number, const SampleWeights& weights, Contributions& out) {
  if (eye.bsdf.lambert()) return append_samples(eye, eye_index, lights, first, count, number, weights, out);
  for (std::size_t k = 0; k < count; ++k)
    append(sample_contribution(eye, lights, first + k, weights), eye_index, number + static_cast<std::uint32_t>(k), out);
}

void add_virtual_lights(const EyeSample& eye, std::uint32_t eye_index, const VirtualPointLights& lights,
                        std::span<const std::uint32_t> general, Contributions& out) {
  if (eye.bsdf.lambert()) {
    append_virtual_lights(eye, eye_index, lights, out);
    for (const std::uint32_t j : general) append(virtual_light_contribution(eye, lights, j), eye_index, j, out);
    return;
  }
  for (std::uint32_t j = 0; j < lights.size; ++j) append(virtual_light_contribution(eye, lights, j), eye_index, j, out);
}

}  // namespace sightline
