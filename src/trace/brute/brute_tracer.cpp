// Tests every triangle and sphere, simply: the truth for every other tracer.
#include <utility>

#include "trace/alpha_mask.h"
#include "trace/brute/woop_triangle.h"
#include "trace/sphere.h"
#include "trace/tracer.h"

namespace sightline {
namespace {

struct Nearest {
  float t, u = 0, v = 0;
  std::uint32_t instance = kNoHit, primitive = 0;
};

class BruteTracer final : public Tracer {
 public:
  BruteTracer(const Scene& scene, const TextureSet& textures, const TracerOptions& options, const Context& context)
      : placement_(place_meshes(scene, context)), spheres_(scene.spheres), masks_(scene, textures, options.alpha_masks) {
    for (const PlacedMesh& placed : placement_.instances) {
      object_from_world_.push_back(placed.kind == PlacedMesh::Kind::instanced ? glm::inverse(placed.world_from_object) : Mat4(1));
      if (placed.kind == PlacedMesh::Kind::absent) continue;
      Bounds box;
      for (const UVec3& t : placed.triangles) {
        if (!is_usable(placed, t)) continue;
        for (const std::uint32_t i : {t.x, t.y, t.z}) box.add(transform_point(placed.world_from_positions(), placed.positions[i]));
      }
      bounds_.add(box);
    }
    for (const Sphere& sphere : spheres_) {
      if (!is_finite(sphere.center) || !(sphere.radius > 0)) continue;
      bounds_.add(sphere.center - sphere.radius);
      bounds_.add(sphere.center + sphere.radius);
    }
  }

  void intersect(const RayBatch& rays, HitBatch& hits, BatchKind, RayCounts& counts) const override {
    hits.resize(rays.size);
    hits.size = rays.size;
    for (std::size_t i = 0; i < rays.size; ++i) {
      const Nearest nearest = closest(rays.get(i), false);
      hits.t[i] = nearest.t, hits.u[i] = nearest.u, hits.v[i] = nearest.v;
      hits.instance[i] = nearest.instance, hits.primitive[i] = nearest.primitive;
    }
    counts.closest += rays.active_count();
  }

  void occluded(const RayBatch& rays, std::span<std::uint8_t> occluded, BatchKind, RayCounts& counts) const override {
    for (std::size_t i = 0; i < rays.size; ++i) occluded[i] = closest(rays.get(i), true).instance != kNoHit;
    counts.occlusion += rays.active_count();
  }

  Bounds bounds() const override { return bounds_; }
  TracerMemory memory() const override { return {placement_.copied_bytes, placement_.copied_bytes}; }
  TracerStatistics statistics() const override { return {}; }
  const Placement& placement() const override { return placement_; }
  std::string_view name() const override { return "brute"; }

 private:
  static bool is_usable(const PlacedMesh& placed, const UVec3& t) {
    const std::size_t count = placed.positions.size();
    return t.x < count && t.y < count && t.z < count && is_finite(placed.positions[t.x]) && is_finite(placed.positions[t.y]) &&
           is_finite(placed.positions[t.z]);
  }

  Nearest closest(const Ray& ray, bool any) const {
    Nearest nearest{ray.t_far};
    if (!(ray.t_far >= ray.t_near)) return nearest;
    for (std::size_t i = 0; i < placement_.instances.size(); ++i) {
      const PlacedMesh& placed = placement_.instances[i];
      if (placed.kind == PlacedMesh::Kind::absent) continue;
      const auto instance = static_cast<std::uint32_t>(i);
      const WoopRay woop(transform_point(object_from_world_[i], ray.origin), transform_vector(object_from_world_[i], ray.direction));
      for (std::size_t j = 0; j < placed.triangles.size(); ++j) {
        const UVec3& t = placed.triangles[j];
        if (!is_usable(placed, t)) continue;
        const auto hit = woop.intersect(placed.positions[t.x], placed.positions[t.y], placed.positions[t.z], ray.t_near, nearest.t);
        const auto primitive = static_cast<std::uint32_t>(j);
        if (!hit || masks_.is_hole(instance, primitive, hit->u, hit->v)) continue;
        if (any && masks_.is_interface(instance, primitive)) continue;
        nearest = {hit->t, hit->u, hit->v, instance, primitive};
        if (any) return nearest;
      }
    }
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
      if (any && masks_.is_sphere_interface(static_cast<std::uint32_t>(i))) continue;
      closest_on_sphere(ray, static_cast<std::uint32_t>(i), nearest);
    }
    return nearest;
  }

  // A hole in the front of a sphere shows the inside of its back.
  void closest_on_sphere(const Ray& ray, std::uint32_t i, Nearest& nearest) const {
    float t_near = ray.t_near;
    for (int side = 0; side < 2; ++side) {
      const auto t = intersect_sphere(spheres_[i].center, spheres_[i].radius, ray.origin, ray.direction, t_near, nearest.t);
      if (!t) return;
      if (!masks_.is_sphere_hole(i, ray.origin + *t * ray.direction)) {
        nearest = {*t, 0, 0, i | kSphereBit, 0};
        return;
      }
      t_near = std::nextafter(*t, std::numeric_limits<float>::infinity());
    }
  }

  Placement placement_;
  std::vector<Mat4> object_from_world_;
  std::vector<Sphere> spheres_;
  AlphaMasks masks_;
  Bounds bounds_;
};

}  // namespace

std::unique_ptr<Tracer> make_brute_tracer(const Scene& scene, const TextureSet& textures, const TracerOptions& options,
                                          const Context& context) {
  return std::make_unique<BruteTracer>(scene, textures, options, context);
}

}  // namespace sightline
