#include "methods/media.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/math/vec3_batch.h"

namespace sightline {
namespace {

constexpr int kMaxCrossings = 1024;  // interfaces on one ray: a bound against files made to hang

// Behind a surface, in the ray's direction and off it by the error bound.
Vec3 origin_behind(const SurfaceBatch& surfaces, std::size_t i, const Vec3& direction) {
  return offset_origin(load(surfaces.position, i), load(surfaces.geometric_normal, i), surfaces.error[i], direction);
}

// How far along `ray` its projection is, in units of its direction: the offset off a surface is part of the way.
float along(const Ray& ray, const Vec3& point) {
  return glm::dot(point - ray.origin, ray.direction) / glm::dot(ray.direction, ray.direction);
}

void copy_lane(const SurfaceBatch& from, std::size_t i, SurfaceBatch& to, std::size_t at) {
  store(to.position, at, load(from.position, i));
  store(to.geometric_normal, at, load(from.geometric_normal, i));
  store(to.shading_normal, at, load(from.shading_normal, i));
  store(to.albedo, at, load(from.albedo, i));
  to.error[at] = from.error[i], to.material[at] = from.material[i], to.light[at] = from.light[i], to.plain[at] = from.plain[i];
  if (!from.shadow_offset.x.empty()) store(to.shadow_offset, at, load(from.shadow_offset, i));
}

}  // namespace

Media::Media(const World& world) : world_(world) {
  const Scene& scene = world.scene();
  for (const Medium& medium : scene.media) any_ |= !is_black(medium.sigma_a);
  is_interface_.reserve(scene.materials.size());
  for (const Material& material : scene.materials) {
    const bool interface = std::holds_alternative<InterfaceMaterial>(material.model);
    is_interface_.push_back(interface);
    any_interface_ |= interface;
  }
}

Color Media::transmittance(MediumId medium, float distance) const {
  const std::vector<Medium>& media = world_.scene().media;
  return medium.index < media.size() ? glm::exp(-media[medium.index].sigma_a * distance) : Color(1);
}

MediumId Media::behind(const SurfaceBatch& surfaces, std::size_t i, const Vec3& direction) const {
  const std::vector<Material>& materials = world_.scene().materials;
  const std::uint32_t material = surfaces.material[i];
  const bool enters = glm::dot(direction, load(surfaces.geometric_normal, i)) < 0;
  return enters && material < materials.size() ? materials[material].interior : MediumId{};
}

// The first way out of a medium that the ray did not enter on its way tells what it began in.
void MediumRays::find(const RayBatch& rays, std::span<MediumId> medium, RayCounts& counts) {
  std::fill(medium.begin(), medium.end(), MediumId{});
  if (!media_.any()) return;
  pending_.clear();
  entered_.assign(rays.size, 0);
  onward_.resize(rays.size);
  for (std::uint32_t i = 0; i < rays.size; ++i) {
    if (!(rays.t_near[i] <= rays.t_far[i])) continue;
    onward_.set(pending_.size(), rays.get(i));
    pending_.push_back({i, 0});
  }
  const std::vector<Material>& materials = world_.scene().materials;
  for (int crossing = 0; crossing < kMaxCrossings && !pending_.empty(); ++crossing) {
    onward_.resize(pending_.size());
    world_.tracer().intersect(onward_, hits_, BatchKind::bounce, counts);
    world_.surfaces(onward_, hits_, surfaces_);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < pending_.size(); ++k) {
      if (!hits_.hit(k)) continue;
      const std::uint32_t i = pending_[k].ray, material = surfaces_.material[k];
      const Vec3 direction = load(onward_.direction, k);
      const MediumId interior = material < materials.size() ? materials[material].interior : MediumId{};
      if (interior.valid()) {
        const bool enters = glm::dot(direction, load(surfaces_.geometric_normal, k)) < 0;
        if (!enters && entered_[i] == 0) {
          medium[i] = interior;
          continue;
        }
        entered_[i] += enters ? 1 : -1;
      }
      onward_.set(kept, {origin_behind(surfaces_, k, direction), 0, direction, kInfinity});
      pending_[kept++] = {i, 0};
    }
    pending_.resize(kept);
  }
}

MediumId MediumRays::around_camera(const View& view) {
  if (!media_.any() || view.camera().projection != Camera::Projection::perspective) return {};
  RayBatch ray;
  ray.resize(1);
  ray.set(0, {Vec3(view.world_from_camera()[3]), 0, glm::normalize(Vec3(0.3f, 0.9f, 0.5f)), kInfinity});
  MediumId medium;
  RayCounts not_counted;
  find(ray, {&medium, 1}, not_counted);
  return medium;
}

std::span<const Color> MediumRays::travel(const RayBatch& rays, HitBatch& hits, SurfaceBatch& surfaces, std::span<MediumId> medium,
                                          RayCounts& counts) {
  left_.assign(rays.size, Color(1));
  pending_.clear();
  for (std::uint32_t i = 0; i < rays.size; ++i) {
    if (!hits.hit(i)) continue;
    const Vec3 direction = load(rays.direction, i);
    if (medium[i].valid()) left_[i] *= media_.transmittance(medium[i], hits.t[i] * glm::length(direction));
    if (media_.any_interface() && media_.is_interface(surfaces.material[i])) pending_.push_back({i, 0});
  }
  for (int crossing = 0; crossing < kMaxCrossings && !pending_.empty(); ++crossing) {
    onward_.resize(pending_.size());
    for (std::size_t k = 0; k < pending_.size(); ++k) {
      const std::uint32_t i = pending_[k].ray;
      const Ray ray = rays.get(i);
      medium[i] = media_.behind(surfaces, i, ray.direction);
      const Vec3 origin = origin_behind(surfaces, i, ray.direction);
      pending_[k].travelled = along(ray, origin);
      onward_.set(k, {origin, 0, ray.direction, ray.t_far - pending_[k].travelled});
    }
    world_.tracer().intersect(onward_, hits_, BatchKind::bounce, counts);
    world_.surfaces(onward_, hits_, surfaces_);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < pending_.size(); ++k) {
      const auto [i, travelled] = pending_[k];
      copy_lane(surfaces_, k, surfaces, i);
      hits.instance[i] = hits_.instance[k], hits.primitive[i] = hits_.primitive[k];
      hits.u[i] = hits_.u[k], hits.v[i] = hits_.v[k];
      const float before = std::exchange(hits.t[i], travelled + hits_.t[k]);
      if (!hits_.hit(k)) continue;
      if (medium[i].valid()) left_[i] *= media_.transmittance(medium[i], (hits.t[i] - before) * glm::length(load(rays.direction, i)));
      if (media_.is_interface(surfaces.material[i])) pending_[kept++] = {i, 0};
    }
    pending_.resize(kept);
  }
  return left_;
}

std::span<const Color> MediumRays::attenuate(const RayBatch& rays, std::span<const MediumId> medium, RayCounts& counts) {
  left_.assign(rays.size, Color(1));
  medium_.assign(medium.begin(), medium.end());
  pending_.clear();
  onward_.resize(rays.size);
  for (std::uint32_t i = 0; i < rays.size; ++i) {
    const Ray ray = rays.get(i);
    if (!(ray.t_near <= ray.t_far)) continue;
    if (!media_.any_interface()) {
      if (medium_[i].valid() && std::isfinite(ray.t_far))
        left_[i] = media_.transmittance(medium_[i], ray.t_far * glm::length(ray.direction));
    } else {
      onward_.set(pending_.size(), ray);
      pending_.push_back({i, 0});
    }
  }
  for (int crossing = 0; crossing < kMaxCrossings && !pending_.empty(); ++crossing) {
    onward_.resize(pending_.size());
    world_.tracer().intersect(onward_, hits_, BatchKind::bounce, counts);
    world_.surfaces(onward_, hits_, surfaces_);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < pending_.size(); ++k) {
      const std::uint32_t i = pending_[k].ray;
      const Ray ray = onward_.get(k);
      const bool crosses = hits_.hit(k) && media_.is_interface(surfaces_.material[k]);
      // Anything else that is hit can only be the end: nothing is in the way.
      const float t = crosses ? hits_.t[k] : ray.t_far;
      if (medium_[i].valid() && std::isfinite(t))
        left_[i] *= media_.transmittance(medium_[i], t * glm::length(ray.direction) + pending_[k].travelled);
      if (!crosses) continue;
      medium_[i] = media_.behind(surfaces_, k, ray.direction);
      const Vec3 origin = origin_behind(surfaces_, k, ray.direction);
      const bool finite = std::isfinite(ray.t_far);
      const float offset = (along(ray, origin) - t) * glm::length(ray.direction);
      onward_.set(kept, {origin, 0, finite ? ray.origin + ray.direction - origin : ray.direction, ray.t_far});
      pending_[kept++] = {i, offset};
    }
    pending_.resize(kept);
  }
  return left_;
}

}  // namespace sightline
