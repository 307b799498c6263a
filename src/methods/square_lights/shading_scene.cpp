#include "methods/square_lights/shading_scene.h"

#include <algorithm>

#include "world/surface.h"

namespace sightline::square_lights {
namespace {

constexpr std::uint32_t kGeometryVersion = 1;

}  // namespace

ShadingScene::ShadingScene(const World& world, RecentValues* recent) : objects_(collect_objects(world)) {
  key_ = geometry_key(world, objects_);
  const auto build = [&] { return ShadingGeometry(world, objects_); };
  geometry_ = recent != nullptr ? recent->get<ShadingGeometry>({"square-lights.geometry", kGeometryVersion, key_}, build)
                                : std::make_shared<const ShadingGeometry>(build());
  for (std::size_t o = 0; o < objects_.size(); ++o) {
    const ShadingGeometry::Part& part = geometry_->parts()[o];
    objects_[o].first = part.first, objects_[o].count = part.count;
    objects_[o].center = part.center, objects_[o].radius = part.radius;
  }
}

bool ShadingScene::any_moving() const {
  return std::any_of(objects_.begin(), objects_.end(), [](const ShadingObject& o) { return o.moving; });
}

Scene object_scene(const Scene& scene, const ShadingObject& object) {
  Scene alone = scene;
  alone.instances.clear(), alone.spheres.clear(), alone.lights.clear(), alone.nodes.clear(), alone.cameras.clear();
  for (std::size_t m = 0; m < object.members.size(); ++m) {
    const std::uint32_t index = object.members[m];
    if (index & kSphereBit) {
      alone.spheres.push_back(scene.spheres[index & ~kSphereBit]);
      continue;
    }
    Instance instance = scene.instances[index];
    instance.world_from_object = object.object_from_member[m];
    instance.node = {};
    alone.instances.push_back(std::move(instance));
  }
  return alone;
}

}  // namespace sightline::square_lights
