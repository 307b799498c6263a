#include "world/world.h"

#include <utility>

#include "base/core/error.h"
#include "scene/materialize.h"
#include "world/scene_difference.h"
#include "world/surface_records.h"

namespace sightline {

struct World::Impl {
  Scene scene;
  WorldOptions options;
  std::shared_ptr<const TextureSet> textures;
  std::unique_ptr<const Tracer> tracer;
  std::shared_ptr<const LightTable> lights;
  SurfaceTables surfaces;
  std::shared_ptr<const void> shadows;  ///< an address that nothing else has while somebody keeps it
};

namespace {

void check_indices(const Scene& scene) {
  for (const Instance& instance : scene.instances) {
    if (instance.mesh.index >= scene.meshes.size()) throw usage_error("instance '" + instance.name + "' has no mesh");
  }
}

void materialize_all(Scene& scene, const WorldOptions& options, const Context& context) {
  for (Mesh& mesh : scene.meshes) {
    if (mesh.source) mesh = materialize(mesh, context, options.tracer.reserved_bytes);
  }
}

std::unique_ptr<const Tracer> make_tracer(const Scene& scene, const TextureSet& textures, const WorldOptions& options,
                                          const Context& context, const Tracer* previous) {
  if (options.backend == WorldOptions::Backend::brute) return make_brute_tracer(scene, textures, options.tracer, context);
  return make_embree_tracer(scene, textures, options.tracer, context, previous);
}

}  // namespace

World::World(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
World::~World() = default;

std::shared_ptr<const World> World::build(Scene scene, const WorldOptions& options, const Context& context) {
  check_indices(scene);
  materialize_all(scene, options, context);
  auto impl = std::make_unique<Impl>();
  impl->scene = std::move(scene);
  impl->options = options;
  impl->textures = std::make_shared<const TextureSet>(impl->scene, context);
  impl->tracer = make_tracer(impl->scene, *impl->textures, options, context, nullptr);
  impl->lights = std::make_shared<const LightTable>(impl->scene, *impl->textures, impl->tracer->bounds(), context);
  impl->surfaces = make_surface_tables(impl->scene, impl->tracer->placement(), options.shadow_terminator);
  impl->shadows = std::make_shared<const char>();
  return std::shared_ptr<const World>(new World(std::move(impl)));
}

std::shared_ptr<const World> World::edit(const World& previous, Scene scene, const Context& context) {
  check_indices(scene);
  const Impl& before = *previous.impl_;
  materialize_all(scene, before.options, context);
  auto impl = std::make_unique<Impl>();
  impl->scene = std::move(scene);
  impl->options = before.options;
  const bool textures_kept = same_textures(before.scene, impl->scene);
  impl->textures = textures_kept ? before.textures : std::make_shared<const TextureSet>(impl->scene, context);
  impl->tracer = make_tracer(impl->scene, *impl->textures, impl->options, context, before.tracer.get());
  const Bounds bounds = impl->tracer->bounds();
  const bool lights_kept = textures_kept && same_lights(before.scene, impl->scene, before.tracer->bounds(), bounds);
  impl->lights =
      lights_kept ? before.lights : std::make_shared<const LightTable>(impl->scene, *impl->textures, bounds, context, before.lights.get());
  impl->surfaces = make_surface_tables(impl->scene, impl->tracer->placement(), impl->options.shadow_terminator);
  impl->shadows = lights_kept && same_surfaces(before.scene, impl->scene) ? before.shadows : std::make_shared<const char>();
  return std::shared_ptr<const World>(new World(std::move(impl)));
}

const Scene& World::scene() const { return impl_->scene; }
const Tracer& World::tracer() const { return *impl_->tracer; }
const TextureSet& World::textures() const { return *impl_->textures; }
const LightTable& World::lights() const { return *impl_->lights; }
Bounds World::bounds() const { return impl_->tracer->bounds(); }
bool World::shadow_terminator() const { return impl_->options.shadow_terminator; }
const std::shared_ptr<const void>& World::shadows() const { return impl_->shadows; }
std::uint64_t World::acceleration_bytes() const { return impl_->tracer->memory().acceleration_bytes; }

void World::surfaces(const RayBatch& rays, const HitBatch& hits, SurfaceBatch& surfaces) const {
  reconstruct(impl_->surfaces, *impl_->lights, rays, hits, surfaces);
}

SurfaceDetail World::detail(const RayBatch& rays, const HitBatch& hits, std::size_t i, float cone_width) const {
  return reconstruct_detail(impl_->scene, impl_->surfaces, rays, hits, i, cone_width);
}

}  // namespace sightline
