// Embree behind the Tracer interface: one static scene in world space, and a top-level scene of instances and spheres.
#include "trace/embree/embree_tracer.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/core/error.h"
#include "base/parallel/parallel.h"
#include "trace/alpha_mask.h"
#include "trace/embree/committed_scene.h"
#include "trace/embree/packets.h"
#include "trace/tracer.h"

namespace sightline {
namespace {

using Kind = PlacedMesh::Kind;
using ArrayKey = std::pair<const void*, const void*>;

class EmbreeTracer final : public Tracer {
 public:
  EmbreeTracer(const Scene& scene, const TextureSet& textures, const TracerOptions& options, const Context& context,
               const EmbreeTracer* previous)
      : placement_(place_meshes(scene, context, previous ? &previous->placement_ : nullptr)),
        masks_(scene, textures, options.alpha_masks),
        options_(options) {
    if (previous && (previous->options_.robust != options.robust || previous->options_.compact != options.compact ||
                     previous->options_.isa != options.isa)) {
      previous = nullptr;
    }
    run_in_arena(context, [&] { build(scene, textures, context, previous); });
    scenes_.static_scene = static_ ? static_->get() : nullptr;
    scenes_.top_scene = top_ ? top_->get() : nullptr;
    scenes_.masks = &masks_;
    scenes_.detail = geometry_detail(statistics_.static_triangles);
    const std::vector<std::uint32_t>& table = scenes_.tables.static_instances;
    scenes_.static_is_identity = true;
    for (std::size_t i = 0; i < table.size(); ++i) scenes_.static_is_identity = scenes_.static_is_identity && table[i] == i;
  }

  void intersect(const RayBatch& rays, HitBatch& hits, BatchKind kind, RayCounts& counts) const override {
    hits.resize(rays.size);
    intersect_batch(scenes_, rays, hits, intersect_style(kind, scenes_, device_->native_width()));
    counts.closest += rays.active_count();
  }

  void occluded(const RayBatch& rays, std::span<std::uint8_t> occluded, BatchKind kind, RayCounts& counts) const override {
    occluded_batch(scenes_, rays, occluded, occluded_style(kind, scenes_, device_->native_width()));
    counts.occlusion += rays.active_count();
  }

  Bounds bounds() const override { return bounds_; }
  TracerMemory memory() const override { return memory_; }
  TracerStatistics statistics() const override { return statistics_; }
  const Placement& placement() const override { return placement_; }
  std::string_view name() const override { return "embree"; }
  const EmbreeScenes& scenes() const { return scenes_; }

 private:
  void build(const Scene& scene, const TextureSet& textures, const Context& context, const EmbreeTracer* previous) {
    device_ = previous ? previous->device_ : std::make_shared<EmbreeDevice>(options_.isa);
    const std::uint64_t other_bytes = scene_bytes(scene) + textures.memory_bytes() + placement_.copied_bytes + options_.reserved_bytes;
    EmbreeDevice::Build build(*device_, context, other_bytes);

    // Sort the instances: one list of static geometries, one mesh scene for each array that is instanced.
    std::vector<TriangleGeometry> static_geometries;
    std::map<ArrayKey, TriangleGeometry> mesh_geometries;
    for (std::size_t i = 0; i < placement_.instances.size(); ++i) {
      const PlacedMesh& placed = placement_.instances[i];
      const auto instance = static_cast<std::uint32_t>(i);
      const HitFilter filter{masks_.masked(instance), masks_.has_interface(instance)};
      if (placed.kind == Kind::baked) {
        static_geometries.push_back({placed.positions, placed.triangles, filter});
        scenes_.tables.static_instances.push_back(instance);
        statistics_.static_triangles += placed.triangles.size();
      } else if (placed.kind == Kind::instanced) {
        TriangleGeometry& geometry = mesh_geometries[{placed.positions.data(), placed.triangles.data()}];
        if (geometry.triangles.empty()) statistics_.instanced_triangles += placed.triangles.size();
        geometry = {placed.positions, placed.triangles, geometry.filter | filter};
        scenes_.tables.top_instances.push_back(instance);
        ++statistics_.instances;
      }
    }

    // Build what no earlier version of this World has built.
    SceneCommitter committer(device_, build, options_.robust, options_.compact,
                             statistics_.static_triangles + statistics_.instanced_triangles);
    if (previous && previous->static_ && previous->static_->serves(static_geometries)) {
      static_ = previous->static_;
    } else if (!static_geometries.empty()) {
      static_ = committer.commit_triangles(std::move(static_geometries));
      statistics_.static_scenes_built = 1;
    }
    for (auto& [key, geometry] : mesh_geometries) {
      if (previous) {
        const auto found = previous->meshes_.find(key);
        if (found != previous->meshes_.end() && found->second->serves({&geometry, 1})) {
          meshes_[key] = found->second;
          ++statistics_.mesh_scenes_shared;
          continue;
        }
      }
      meshes_[key] = committer.commit_triangles({geometry});
      ++statistics_.mesh_scenes_built;
    }
    std::vector<InstanceGeometry> instances;
    for (const std::uint32_t i : scenes_.tables.top_instances) {
      const PlacedMesh& placed = placement_.instances[i];
      instances.push_back({meshes_.at({placed.positions.data(), placed.triangles.data()}), placed.world_from_object});
    }
    if (!instances.empty() || !scene.spheres.empty())
      top_ = committer.commit_top(instances, scene.spheres, {masks_.any_sphere(), masks_.any_interface_sphere()});

    memory_.acceleration_bytes = placement_.copied_bytes + bytes_of(static_) + bytes_of(top_);
    for (const auto& [key, mesh] : meshes_) memory_.acceleration_bytes += mesh->bytes();
    memory_.peak_build_bytes = placement_.copied_bytes + build.peak_bytes();
    for (const CommittedScene* part : {static_.get(), top_.get()}) add_bounds(part);
  }

  static std::uint64_t bytes_of(const std::shared_ptr<const CommittedScene>& scene) { return scene ? scene->bytes() : 0; }

  void add_bounds(const CommittedScene* part) {
    if (!part) return;
    RTCBounds box;
    rtcGetSceneBounds(part->get(), &box);
    const Bounds bounds{{box.lower_x, box.lower_y, box.lower_z}, {box.upper_x, box.upper_y, box.upper_z}};
    if (!bounds.is_empty()) bounds_.add(bounds);
  }

  Placement placement_;
  AlphaMasks masks_;
  TracerOptions options_;
  std::shared_ptr<EmbreeDevice> device_;
  std::shared_ptr<const CommittedScene> static_, top_;
  std::map<ArrayKey, std::shared_ptr<const CommittedScene>> meshes_;
  EmbreeScenes scenes_;
  Bounds bounds_;
  TracerMemory memory_;
  TracerStatistics statistics_;
};

}  // namespace

const EmbreeScenes* embree_scenes(const Tracer& tracer) {
  const auto* embree = dynamic_cast<const EmbreeTracer*>(&tracer);
  return embree ? &embree->scenes() : nullptr;
}

std::unique_ptr<Tracer> make_embree_tracer(const Scene& scene, const TextureSet& textures, const TracerOptions& options,
                                           const Context& context, const Tracer* previous) {
  const auto* earlier = dynamic_cast<const EmbreeTracer*>(previous);
  if (previous && !earlier) throw Error(ErrorCode::bug, "the previous tracer is not an Embree tracer");
  return std::make_unique<EmbreeTracer>(scene, textures, options, context, earlier);
}

}  // namespace sightline
