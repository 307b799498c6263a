#include "shade/material_eval.h"

#include <algorithm>
#include <cmath>

namespace sightline {

namespace {

/// A mix may name a mix; a file that nests them deeper than this, or in a circle, gets the default material.
constexpr int kMaxMixDepth = 32;

/// Into [0, 1]; not-a-number becomes 0.
float unit(float v) { return v > 0 ? std::min(v, 1.f) : 0.f; }
Color unit(const Color& c) { return {unit(c.x), unit(c.y), unit(c.z)}; }
float finite_or(float v, float fallback) { return std::isfinite(v) ? v : fallback; }
Color non_negative(const Color& c) {
  return {c.x > 0 ? finite_or(c.x, 0) : 0.f, c.y > 0 ? finite_or(c.y, 0) : 0.f, c.z > 0 ? finite_or(c.z, 0) : 0.f};
}

const Material* find(const Scene& scene, MaterialId id) { return id.index < scene.materials.size() ? &scene.materials[id.index] : nullptr; }

/// Looks up the parameters of each model.
struct BsdfMaker {
  const TextureSet& textures;
  const TexturePoint& point;

  template <class Param>
  auto at(const Param& param) const {
    return textures.sample(param, point);
  }
  Ggx ggx(const FloatParam& u, const FloatParam& v, bool remap) const {
    const float alpha_u = unit(at(u)), alpha_v = unit(at(v));
    return remap ? Ggx(std::sqrt(alpha_u), std::sqrt(alpha_v)) : Ggx(alpha_u, alpha_v);
  }

  Bsdf::Model operator()(const DiffuseMaterial& m) const { return Lambert{unit(at(m.reflectance))}; }
  Bsdf::Model operator()(const MetallicRoughnessMaterial& m) const {
    return MetallicRoughness(unit(at(m.base_color)), unit(at(m.metallic)), unit(at(m.roughness)));
  }
  Bsdf::Model operator()(const ConductorMaterial& m) const {
    return Conductor(non_negative(at(m.eta)), non_negative(at(m.k)), unit(at(m.reflectance_tint)),
                     ggx(m.alpha_u, m.alpha_v, m.remap_roughness));
  }
  Bsdf::Model operator()(const DielectricMaterial& m) const {
    return Dielectric(m.eta, ggx(m.alpha_u, m.alpha_v, m.remap_roughness), m.thin);
  }
  Bsdf::Model operator()(const CoatedDiffuseMaterial& m) const {
    return CoatedDiffuse(unit(at(m.reflectance)), m.eta, ggx(m.alpha_u, m.alpha_v, m.remap_roughness));
  }
  Bsdf::Model operator()(const PhongMaterial& m) const {
    return Phong(unit(at(m.diffuse)), unit(at(m.specular)), finite_or(at(m.exponent), 0));
  }
  Bsdf::Model operator()(const DiffuseTransmissionMaterial& m) const {
    return DiffuseTransmission(unit(at(m.reflectance)), unit(at(m.transmittance)));
  }
  Bsdf::Model operator()(const WardMaterial& m) const {
    return Ward(unit(at(m.diffuse)), unit(at(m.specular)), finite_or(at(m.alpha_x), 1), finite_or(at(m.alpha_y), 1));
  }
  Bsdf::Model operator()(const CookTorranceMaterial& m) const {
    return CookTorrance(unit(at(m.diffuse)), unit(at(m.specular)), finite_or(at(m.roughness), 1), unit(at(m.f0)));
  }
  Bsdf::Model operator()(const MeasuredMaterial& m) const {
    if (!m.data) return Lambert{};
    return MeasuredBrdf(*m.data);
  }
  Bsdf::Model operator()(const MixMaterial&) const { return Lambert{}; }
  /// Light passes straight through.
  Bsdf::Model operator()(const InterfaceMaterial&) const { return Dielectric(1, Ggx(), false); }
};

/// `n` turned as little as it takes to lie at least slightly on the positive side of unit `axis`.
Vec3 turned_towards(const Vec3& n, const Vec3& axis) {
  constexpr float kLeastCosine = 0.01f;
  const float cosine = glm::dot(n, axis);
  if (cosine >= kLeastCosine) return n;
  return normalize_or(n + (kLeastCosine - cosine) * axis, axis);
}

/// The normal that a tangent-space map asks for. Green points up the image, that is against v, whose zero is the top row.
Vec3 mapped_normal(const Vec4& texel, float scale, const Frame3& frame, const Vec3& dp_dv) {
  const Vec3 local{(2 * texel.x - 1) * scale, (2 * texel.y - 1) * scale, std::max(2 * texel.z - 1, 1e-3f)};
  const Vec3 up = glm::dot(frame.bitangent, dp_dv) > 0 ? -frame.bitangent : frame.bitangent;
  return normalize_or(local.x * frame.tangent + local.y * up + local.z * frame.normal, frame.normal);
}

/// The normal of the surface displaced by the height map `height` along the normal, by forward differences half a footprint wide
/// [Blinn1978]: with P' = P + h n, dP'/du = dP/du + dh/du n + h dn/du.
Vec3 bumped_normal(const TextureSet& textures, const FloatParam& height, const TexturePoint& point, const Frame3& frame, const Vec3& dp_du,
                   const Vec3& dp_dv, const Vec3& dn_du, const Vec3& dn_dv) {
  constexpr float kLeastStep = 5e-4f;
  const Vec2 footprint = 0.5f * (glm::abs(point.duv_dx) + glm::abs(point.duv_dy));
  const float du = footprint.x > 0 && std::isfinite(footprint.x) ? footprint.x : kLeastStep;
  const float dv = footprint.y > 0 && std::isfinite(footprint.y) ? footprint.y : kLeastStep;
  TexturePoint shifted_u = point, shifted_v = point;
  shifted_u.uv.x += du;
  shifted_v.uv.y += dv;
  const float here = textures.sample(height, point);
  const float slope_u = (textures.sample(height, shifted_u) - here) / du;
  const float slope_v = (textures.sample(height, shifted_v) - here) / dv;
  const Vec3& n = frame.normal;
  const Vec3 tangent_u = dp_du - n * glm::dot(n, dp_du), tangent_v = dp_dv - n * glm::dot(n, dp_dv);
  Vec3 bumped = glm::cross(tangent_u + slope_u * n + here * dn_du, tangent_v + slope_v * n + here * dn_dv);
  if (glm::dot(bumped, n) < 0) bumped = -bumped;
  return normalize_or(bumped, n);
}

}  // namespace

MaterialId resolve_mix(const Scene& scene, const TextureSet& textures, MaterialId material, const TexturePoint& point, float& u_mix) {
  for (int depth = 0; depth < kMaxMixDepth; ++depth) {
    const Material* found = find(scene, material);
    const MixMaterial* mix = found ? std::get_if<MixMaterial>(&found->model) : nullptr;
    if (!mix) return material;
    const float amount = unit(textures.sample(mix->amount, point));
    const bool second = u_mix < amount;
    u_mix = std::min(second ? u_mix / amount : (u_mix - amount) / (1 - amount), kOneMinusEpsilon);
    material = second ? mix->second : mix->first;
  }
  return {};
}

Bsdf make_bsdf(const Scene& scene, const TextureSet& textures, MaterialId material, const TexturePoint& point, float u_mix) {
  const Material* found = find(scene, resolve_mix(scene, textures, material, point, u_mix));
  if (!found) return Bsdf(Lambert{});
  return Bsdf(std::visit(BsdfMaker{textures, point}, found->model));
}

bool is_interface(const Scene& scene, MaterialId material) {
  const Material* found = find(scene, material);
  return found && std::holds_alternative<InterfaceMaterial>(found->model);
}

Frame3 perturb_frame(const Scene& scene, const TextureSet& textures, MaterialId material, const TexturePoint& point, const Frame3& frame,
                     const Vec3& dp_du, const Vec3& dp_dv, const Vec3& dn_du, const Vec3& dn_dv, const Vec3& geometric_normal,
                     const Vec3& wo) {
  const Material* found = find(scene, material);
  Frame3 result = frame;
  if (found && found->normal_map.valid()) {
    const Vec3 n = mapped_normal(textures.sample(found->normal_map, point), found->normal_scale, result, dp_dv);
    result = frame_from_normal_tangent(n, frame.tangent);
  }
  if (found && found->bump.valid()) {
    FloatParam height(found->bump_scale);
    height.texture = found->bump;
    result = frame_from_normal_tangent(bumped_normal(textures, height, point, result, dp_du, dp_dv, dn_du, dn_dv), frame.tangent);
  }
  return face_viewer(result, frame.tangent, geometric_normal, wo);
}

Frame3 face_viewer(const Frame3& frame, const Vec3& tangent, const Vec3& geometric_normal, const Vec3& wo) {
  const float outside = glm::dot(wo, geometric_normal) < 0 ? -1.f : 1.f;
  Vec3 n = turned_towards(frame.normal, geometric_normal);
  if (glm::dot(n, wo) * outside <= 0 && !is_black(wo)) n = turned_towards(n, outside * wo);
  return n == frame.normal ? frame : frame_from_normal_tangent(n, tangent);
}

}  // namespace sightline
