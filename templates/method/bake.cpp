#include "methods/example/bake.h"

namespace sightline {

std::unique_ptr<const Bake> build_example_bake(const World& world, const Context& context) {
  context.check_cancelled();
  return std::make_unique<ExampleBake>(world.bounds().half_diagonal());
}

}  // namespace sightline
