// The standard views that figures are quoted for, so that they can be compared over time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/core/context.h"
#include "scene/scene.h"

namespace sightline {

/// A scene with camera and lights under a fixed name.
struct BenchView {
  std::string name;
  Scene scene;
  Camera camera;
  IVec2 size_px{1280, 960};
};

/// Names of all standard views.
std::vector<std::string> bench_view_names();
/// Throws Error{usage} with the nearest name if there is no such view; "builtin:..." is taken as it is.
void check_bench_view(const std::string& name);
/// The view, or nothing where its files are not below `data`: a folder, or several joined by ':', of which the first that has them counts.
/// "builtin:NAME,..." is a view of that scene as it is. Throws Error{usage} for unknown names.
std::optional<BenchView> load_bench_view(const std::string& name, const std::filesystem::path& data, const Context& context);

}  // namespace sightline
