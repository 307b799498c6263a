#include "shade/lights/light_emission.h"

#include <limits>

#include "base/math/frame.h"
#include "base/sample/warp.h"
#include "shade/lights/light_table_impl.h"
#include "trace/sphere.h"

namespace sightline {
namespace {

/// Cosine-weighted about `normal`, on a random one of its sides if `both`; the number that chose the side is stretched and used again.
Vec3 sample_lambert_emission(const Vec3& normal, bool both, Vec2 u) {
  bool back = false;
  if (both) {
    back = u.x < 0.5f;
    u.x = std::min(2 * (back ? u.x : u.x - 0.5f), kOneMinusEpsilon);
  }
  const Vec3 direction = frame_from_normal(normal).to_world(sample_cosine_hemisphere(u));
  return back ? direction - 2 * glm::dot(direction, normal) * normal : direction;
}

float lambert_emission_pdf(float cosine, bool both) {
  if (both) return 0.5f * kInvPi * std::fabs(cosine);
  return cosine > 0 ? kInvPi * cosine : 0.f;
}

/// 1 - cos of the cone that a spot fills; the whole sphere for points.
float emission_cone(const PunctualLight& light) { return light.kind == PunctualLight::kSpot ? 1 - light.cos_outer : 2.f; }

}  // namespace

Vec3 LightBeam::origin(const Vec3& direction, const Vec2& u) const {
  const Vec2 p = sample_concentric_disk(u);
  const Frame3 frame = frame_from_normal(direction);
  return center + radius * (p.x * frame.tangent + p.y * frame.bitangent - direction);
}

EmissionSample sample_flat_emission(const FlatLight& light, const FlatEmitter& emitter, float selection, const Vec2& u_point,
                                    const Vec2& u_direction) {
  const Vec2 ab = flat_parameters(emitter.flags, u_point);
  EmissionSample s;
  s.point = light.origin + ab.x * light.e1 + ab.y * light.e2;
  s.point_error = light.point_error;
  s.normal = light.normal;
  s.is_mesh = emitter.is(FlatEmitter::kMesh);
  s.is_two_sided = emitter.is(FlatEmitter::kTwoSided);
  s.direction = sample_lambert_emission(light.normal, s.is_two_sided, u_direction);
  s.radiance = emitter.radiance;
  s.pdf = flat_emission_pdf(light, emitter, selection, s.direction);
  return s;
}

EmissionPdf flat_emission_pdf(const FlatLight& light, const FlatEmitter& emitter, float selection, const Vec3& direction) {
  if (!(light.area > 0)) return {};
  return {selection / light.area, lambert_emission_pdf(glm::dot(light.normal, direction), emitter.is(FlatEmitter::kTwoSided))};
}

EmissionSample sample_sphere_emission(const SphereEmitter& sphere, float selection, const Vec2& u_point, const Vec2& u_direction) {
  const Vec3 outward = sample_uniform_sphere(u_point);
  EmissionSample s;
  s.point = sphere.center + sphere.radius * outward;
  s.point_error = sphere_point_error(sphere);
  s.normal = sphere.emits_outside ? outward : -outward;
  s.is_mesh = sphere.is_mesh;
  s.is_two_sided = sphere.emits_outside && sphere.emits_inside;
  s.direction = sample_lambert_emission(s.normal, s.is_two_sided, u_direction);
  s.radiance = sphere.radiance;
  s.pdf = sphere_emission_pdf(sphere, selection, s.point, s.direction);
  return s;
}

EmissionPdf sphere_emission_pdf(const SphereEmitter& sphere, float selection, const Vec3& point, const Vec3& direction) {
  const Vec3 outward = normalize_or(point - sphere.center, Vec3(0, 0, 1));
  const float cosine = glm::dot(outward, direction);
  const bool both = sphere.emits_outside && sphere.emits_inside;
  return {selection / (4 * kPi * sphere.radius * sphere.radius), lambert_emission_pdf(sphere.emits_outside ? cosine : -cosine, both)};
}

EmissionSample sample_punctual_emission(const PunctualLight& light, float selection, const LightBeam& beam, const Vec2& u_point,
                                        const Vec2& u_direction) {
  EmissionSample s;
  s.is_delta = true;
  s.radiance = light.intensity;
  if (light.kind == PunctualLight::kDirectional) {
    s.is_infinite = true;
    s.direction = light.direction;
    s.point = beam.origin(light.direction, u_point);
  } else {
    s.point = light.position;
    if (light.kind == PunctualLight::kSpot) {
      s.direction = frame_from_normal(light.direction).to_world(sample_uniform_cone(u_direction, emission_cone(light)));
      s.radiance *= spot_falloff(light, glm::dot(s.direction, light.direction));
    } else {
      s.direction = sample_uniform_sphere(u_direction);
    }
  }
  s.pdf = punctual_emission_pdf(light, selection, beam, s.direction);
  return s;
}

EmissionPdf punctual_emission_pdf(const PunctualLight& light, float selection, const LightBeam& beam, const Vec3& direction) {
  if (light.kind == PunctualLight::kDirectional) return {selection, beam.pdf()};
  if (light.kind == PunctualLight::kPoint) return {selection, pdf_uniform_sphere()};
  const bool inside = glm::dot(direction, light.direction) >= light.cos_outer && emission_cone(light) > 0;
  return {selection, inside ? pdf_uniform_cone(emission_cone(light)) : 0.f};
}

EmissionSample LightTable::sample_emission(float u_pick, const Vec2& u_point, const Vec2& u_direction) const {
  const LightLists& lists = impl_->lists;
  const AliasTable& table = impl_->picker.table();
  if (!table.can_sample()) return {};
  const AliasTable::Choice choice = lists.size() == 1 ? AliasTable::Choice{0, table.probability(0), 0} : table.sample(u_pick);
  EmissionSample s;
  if (choice.index < lists.punctual_begin) {
    const FlatLight& light = lists.flats[choice.index];
    const FlatEmitter& emitter = lists.emitters[light.emitter];
    s = sample_flat_emission(light, emitter, choice.probability, u_point, u_direction);
    if (emitter.is(FlatEmitter::kTextured)) s.radiance *= impl_->texture_of(light, u_point);
  } else if (choice.index < lists.sphere_begin) {
    s = sample_punctual_emission(lists.punctuals[choice.index - lists.punctual_begin], choice.probability, impl_->beam, u_point,
                                 u_direction);
  } else if (choice.index == lists.environment_index) {
    const Vec3 towards = lists.environment->sample(u_direction);
    if (towards == Vec3(0)) return {};
    const EnvironmentLight::Evaluation evaluation = lists.environment->evaluate(towards);
    s.is_infinite = true;
    s.direction = -towards;
    s.point = impl_->beam.origin(s.direction, u_point);
    s.radiance = evaluation.radiance;
    s.pdf = {choice.probability * evaluation.pdf, impl_->beam.pdf()};
  } else {
    const SphereEmitter& sphere = lists.spheres[choice.index - lists.sphere_begin];
    s = sample_sphere_emission(sphere, choice.probability, u_point, u_direction);
    if (sphere.texture.valid()) {
      const Vec2 uv = sphere_uv(sphere_local_direction(lists.scene_spheres[sphere.source], s.point));
      s.radiance *= glm::max(Color(impl_->textures.sample(sphere.texture, {.uv = uv})), Color(0));
    }
  }
  s.light = choice.index;
  return s;
}

EmissionPdf LightTable::emission_pdf(std::uint32_t light, const Vec3& point, const Vec3& direction) const {
  const LightLists& lists = impl_->lists;
  if (light >= lists.size()) return {};
  const float selection = impl_->picker.table().probability(light);
  if (light < lists.punctual_begin) {
    const FlatLight& flat = lists.flats[light];
    return flat_emission_pdf(flat, lists.emitters[flat.emitter], selection, direction);
  }
  if (light < lists.sphere_begin)
    return punctual_emission_pdf(lists.punctuals[light - lists.punctual_begin], selection, impl_->beam, direction);
  if (light == lists.environment_index) return {selection * lists.environment->pdf(-direction), impl_->beam.pdf()};
  return sphere_emission_pdf(lists.spheres[light - lists.sphere_begin], selection, point, direction);
}

std::uint32_t LightTable::environment_entry() const { return impl_->lists.environment_index; }

}  // namespace sightline
