#include "methods/visibility_cache/surface_point.h"

#include <cmath>

#include "base/math/vec3_batch.h"
#include "shade/material_eval.h"

namespace sightline::vpl {
namespace {

bool agrees(const Vec3& shading, const Vec3& geometric, const Vec3& w) { return glm::dot(w, shading) * glm::dot(w, geometric) > 0; }

}  // namespace

bool is_translucent(const Bsdf& bsdf) {
  return std::holds_alternative<DiffuseTransmission>(bsdf.model()) ||
         (std::holds_alternative<Dielectric>(bsdf.model()) && !bsdf.is_delta());
}

Frame3 frame_towards(const Frame3& frame, const Vec3& geometric_normal, const Vec3& w, bool plain) {
  if (agrees(frame.normal, geometric_normal, w)) return frame;
  if (plain) return frame_from_normal(geometric_normal);
  const Frame3 turned = face_viewer(frame, frame.tangent, geometric_normal, w);
  return agrees(turned.normal, geometric_normal, w) ? turned : frame_from_normal_tangent(geometric_normal, turned.tangent);
}

Color scattered(const Bsdf& bsdf, const Frame3& frame, const Vec3& geometric_normal, bool plain, const Vec3& wo, const Vec3& wi) {
  const Frame3 seen = frame_towards(frame, geometric_normal, wo, plain);
  const Vec3 o = seen.to_local(wo), i = seen.to_local(wi);
  // Reflection by the shading normal must be reflection by the geometric one, else light leaks through.
  if ((o.z * i.z > 0) != (glm::dot(wo, geometric_normal) * glm::dot(wi, geometric_normal) > 0)) return Color(0);
  return bsdf.evaluate(o, i, TransportMode::radiance).f_cos;
}

std::optional<Turn> turn_light(const SurfacePoint& surface, const Vec3& wi, float u_lobe, const Vec2& u) {
  const Vec3& geometric = surface.geometric_normal;
  const Frame3 lit = frame_towards(surface.frame, geometric, wi, surface.plain);
  const Vec3 i = lit.to_local(wi);
  const std::optional<BsdfSample> sample = surface.bsdf.sample(i, u_lobe, u, TransportMode::importance);
  if (!sample || !(sample->pdf > 0)) return std::nullopt;
  Turn turn;
  turn.direction = lit.to_world(sample->wi);
  turn.is_delta = sample->is_delta;
  const float leaving = glm::dot(turn.direction, geometric);
  turn.crosses = leaving * glm::dot(wi, geometric) < 0;
  if (turn.crosses != sample->is_transmission) return std::nullopt;
  if (!turn.is_delta) {
    turn.pdf = sample->pdf;
    turn.weight = scattered(surface, turn.direction, wi) * (std::fabs(leaving) / sample->pdf);
    return turn;
  }
  // An eye that sees another normal there has no such delta.
  if (frame_towards(surface.frame, geometric, turn.direction, surface.plain).normal != lit.normal || sample->wi.z == 0) return std::nullopt;
  turn.weight = sample->weight * std::fabs(i.z / sample->wi.z * leaving);
  return turn;
}

float light_turn_pdf(const SurfacePoint& surface, const Vec3& wi, const Vec3& wo) {
  const Vec3& geometric = surface.geometric_normal;
  const Frame3 lit = frame_towards(surface.frame, geometric, wi, surface.plain);
  const Vec3 i = lit.to_local(wi), o = lit.to_local(wo);
  if ((o.z * i.z > 0) != (glm::dot(wo, geometric) * glm::dot(wi, geometric) > 0)) return 0;
  return surface.bsdf.evaluate(i, o, TransportMode::importance).pdf;
}

std::optional<Turn> turn_eye(const SurfacePoint& surface, const Vec3& wo, float u_lobe, const Vec2& u) {
  const Frame3 seen = frame_towards(surface.frame, surface.geometric_normal, wo, surface.plain);
  const std::optional<BsdfSample> sample = surface.bsdf.sample(seen.to_local(wo), u_lobe, u, TransportMode::radiance);
  if (!sample || !sample->is_delta) return std::nullopt;
  Turn turn{seen.to_world(sample->wi), sample->weight, 0, true, false};
  turn.crosses = glm::dot(turn.direction, surface.geometric_normal) * glm::dot(wo, surface.geometric_normal) < 0;
  if (turn.crosses != sample->is_transmission) return std::nullopt;
  return turn;
}

SurfaceReader::SurfaceReader(const World& world) : world_(world), has_media_(!world.scene().media.empty()) {}

SurfacePoint SurfaceReader::read(const RayBatch& rays, const HitBatch& hits, const SurfaceBatch& surfaces, std::size_t i, float cone_width,
                                 float u_mix) const {
  SurfacePoint point;
  point.position = load(surfaces.position, i);
  point.geometric_normal = load(surfaces.geometric_normal, i);
  point.error = surfaces.error[i];
  point.plain = surfaces.plain[i] != 0;
  const Scene& scene = world_.scene();
  const std::uint32_t index = surfaces.material[i];
  MaterialId material = index == kDefaultMaterial ? MaterialId{} : MaterialId{index};
  if (point.plain) {
    point.frame = frame_from_normal(load(surfaces.shading_normal, i));
    point.bsdf = Bsdf(Lambert{load(surfaces.albedo, i)});
  } else {
    const SurfaceDetail detail = world_.detail(rays, hits, i, cone_width);
    material = resolve_mix(scene, world_.textures(), material, detail.texture, u_mix);
    point.frame = perturb_frame(scene, world_.textures(), material, detail.texture, detail.frame, detail.dp_du, detail.dp_dv, detail.dn_du,
                                detail.dn_dv, point.geometric_normal, Vec3(0));
    point.bsdf = make_bsdf(scene, world_.textures(), material, detail.texture, u_mix);
  }
  if (has_media_ && material.valid() && material.index < scene.materials.size()) point.interior = scene.materials[material.index].interior;
  return point;
}

}  // namespace sightline::vpl
