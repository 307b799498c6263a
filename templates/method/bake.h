// What the example method computes once before rendering. Delete this file if a method needs nothing.
#pragma once

#include "methods/method.h"

namespace sightline {

/// Immutable. Holds no pointer into a World, only what was computed from it.
class ExampleBake final : public Bake {
 public:
  explicit ExampleBake(float scene_radius) : scene_radius_(scene_radius) {}
  float scene_radius() const { return scene_radius_; }

 private:
  float scene_radius_;
};

std::unique_ptr<const Bake> build_example_bake(const World& world, const Context& context);

}  // namespace sightline
