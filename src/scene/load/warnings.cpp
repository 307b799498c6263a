#include "scene/load/warnings.h"

#include <utility>

namespace sightline {

void add_warning(Scene& scene, const Context& context, std::string text) {
  constexpr std::size_t kMaxWarnings = 200;
  if (scene.warnings.size() > kMaxWarnings) return;
  if (scene.warnings.size() == kMaxWarnings) text = "more warnings were left out";
  context.warn(text);
  scene.warnings.push_back(std::move(text));
}

}  // namespace sightline
