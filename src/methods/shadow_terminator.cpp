#include "methods/shadow_terminator.h"

#include <cmath>

#include "base/math/vec3_batch.h"

namespace sightline {
namespace {

bool may_transmit(const SurfaceModel& model) {
  return std::holds_alternative<DielectricMaterial>(model) || std::holds_alternative<DiffuseTransmissionMaterial>(model) ||
         std::holds_alternative<MixMaterial>(model) || std::holds_alternative<InterfaceMaterial>(model);
}

}  // namespace

ShadowTerminator::ShadowTerminator(const World& world) {
  for (const Material& material : world.scene().materials) reflects_.push_back(!may_transmit(material.model));
}

bool ShadowTerminator::applies(const RayBatch& rays, const SurfaceBatch& surfaces, std::size_t i) const {
  const std::uint32_t material = surfaces.material[i];
  if (load(surfaces.shadow_offset, i) == Vec3(0) || surfaces.light[i] != kNoLight) return false;
  if (material < reflects_.size() && !reflects_[material]) return false;
  const Vec3 direction = load(rays.direction, i);
  return glm::dot(direction, load(surfaces.shading_normal, i)) * glm::dot(direction, load(surfaces.geometric_normal, i)) > 0;
}

Vec3 ShadowTerminator::lifted(const RayBatch& rays, const SurfaceBatch& surfaces, std::size_t i) {
  const Vec3 normal = load(surfaces.geometric_normal, i);
  const float margin = 2 * surfaces.error[i] * (std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z));
  const float side = glm::dot(load(rays.direction, i), normal) > 0 ? -margin : margin;
  return load(surfaces.position, i) + load(surfaces.shadow_offset, i) + side * normal;
}

void ShadowTerminator::move(const RayBatch& rays, SurfaceBatch& surfaces, std::size_t count) const {
  for (std::size_t i = 0; i < count; ++i) {
    if (!applies(rays, surfaces, i)) continue;
    store(surfaces.position, i, lifted(rays, surfaces, i));
    store(surfaces.geometric_normal, i, load(surfaces.shading_normal, i));
  }
}

}  // namespace sightline
