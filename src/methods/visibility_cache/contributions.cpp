#include "methods/visibility_cache/contributions.h"
#include "base/math/vec3_batch.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sightline {
namespace {

/// What all lights at one eye point share.
struct EyeView {
  explicit EyeView(const EyeSample& e) : eye(e), wo_local(e.frame.to_local(e.wo)), outside(glm::dot(e.wo, e.geometric_normal)) {}

  /// f cos towards unit `wi`. Reflection by the shading normal must be reflection by the geometric one, else light would leak through.
  BsdfEval evaluate(const Vec3& wi) const {
    const Vec3 wi_local = eye.frame.to_local(wi);
    if ((wo_local.z * wi_local.z > 0) != (outside * glm::dot(wi, eye.geometric_normal) > 0)) return {};
    return eye.bsdf.evaluate(wo_local, wi_local);
  }

  const EyeSample& eye;
  Vec3 wo_local;
  float outside;
};

Color contribution_of_sample(const EyeView& view, const LightSampleBatch& lights, std::size_t lane, const SampleWeights& weights) {
  const float pdf = lights.pdf[lane];
  if (!(pdf > 0)) return Color(0);
  const BsdfEval eval = view.evaluate(load(lights.wi, lane));
  float scale = weights.scale / pdf;
  if (weights.mis_bsdf > 0) scale *= weights.mis_light * pdf / (weights.mis_light * pdf + weights.mis_bsdf * eval.pdf);
  return view.eye.weight * eval.f_cos * load(lights.radiance, lane) * scale;
}

Color contribution_of_virtual_light(const EyeView& view, const VirtualPointLights& lights, std::size_t j) {
  const EyeSample& eye = view.eye;
  const Vec3 to = load(lights.position, j) - eye.position;
  const float squared = glm::dot(to, to);
  if (!(squared > 0)) return Color(0);
  const Vec3 wi = to * (1 / std::sqrt(squared)), normal = load(lights.normal, j);
  if (lights.lambert[j] && !(glm::dot(wi, normal) < 0)) return Color(0);
  const BsdfEval at_eye = view.evaluate(wi);
  if (is_black(at_eye.f_cos)) return Color(0);
  // f_cos holds the eye's cosine.
  const float cos_eye = std::fabs(glm::dot(wi, eye.frame.normal)), cos_sent = std::fabs(glm::dot(wi, normal));
  const float geometry = cos_eye * cos_sent / squared;
  const float clamped = geometry > lights.max_geometry_term ? lights.max_geometry_term / geometry : 1.f;
  const Color sent = lights.lambert[j] ? load(lights.radiosity, j) : radiance_towards(lights, j, -wi);
  return eye.weight * at_eye.f_cos * sent * (clamped * cos_sent / squared);
}

void append(const Color& color, std::uint32_t eye_index, std::uint32_t light, Contributions& out) {
  if (!(max_component(color) > 0)) return;
  out.color.x[out.size] = color.x, out.color.y[out.size] = color.y, out.color.z[out.size] = color.z;
  out.eye[out.size] = eye_index, out.light[out.size] = light;
  ++out.size;
}

}  // namespace

Color sample_contribution(const EyeSample& eye, const LightSampleBatch& lights, std::size_t lane, const SampleWeights& weights) {
  return contribution_of_sample(EyeView(eye), lights, lane, weights);
}

Color virtual_light_contribution(const EyeSample& eye, const VirtualPointLights& lights, std::size_t j) {
  return contribution_of_virtual_light(EyeView(eye), lights, j);
}

void add_samples(const EyeSample& eye, std::uint32_t eye_index, const LightSampleBatch& lights, std::size_t first, std::size_t count,
                 std::uint32_t number, const SampleWeights& weights, Contributions& out) {
  const EyeView view(eye);
  if (const std::optional<SurfaceLobes> lobes = eye.bsdf.lobes(view.wo_local))
    return append_samples(eye, *lobes, eye_index, lights, first, count, number, weights, out);
  for (std::size_t k = 0; k < count; ++k)
    append(contribution_of_sample(view, lights, first + k, weights), eye_index, number + static_cast<std::uint32_t>(k), out);
}

void add_virtual_lights(const EyeSample& eye, std::uint32_t eye_index, const VirtualPointLights& lights,
                        std::span<const std::uint32_t> general, const SentRadiance& sent, Contributions& out) {
  const EyeView view(eye);
  const std::optional<SurfaceLobes> lobes = eye.bsdf.lobes(view.wo_local);
  if (!lobes) {
    for (std::uint32_t j = 0; j < lights.size; ++j) append(contribution_of_virtual_light(view, lights, j), eye_index, j, out);
    return;
  }
  append_virtual_lights(eye, *lobes, eye_index, lights, out);
  const std::size_t begin = out.size;
  append_unit_lights(eye, *lobes, eye_index, lights, general, out);
  const std::size_t end = out.size;
  out.size = begin;
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t place = out.light[i];
    append(load(out.color, i) * load(sent.radiance, place * sent.stride + eye_index), eye_index, general[place], out);
  }
}

}  // namespace sightline
