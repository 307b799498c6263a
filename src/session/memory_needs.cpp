#include "session/memory_needs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.h"

namespace sightline {
namespace {

constexpr double kGib = 1u << 30;

std::uint64_t picture_bytes(IVec2 size_px, AovSet aovs, bool light_image) {
  std::uint64_t bytes_a_pixel = 0;
  for (const AovInfo& info : aov_table()) {
    // While it is written, a picture also exists as floats and once more encoded.
    if (aovs.has(info.id)) bytes_a_pixel += info.channels.size() * (sizeof(ExactSum) + 2 * sizeof(float));
  }
  for (const Aov aov : kLightImageLayers) {
    if (light_image && aovs.has(aov)) bytes_a_pixel += aov_info(aov).channels.size() * sizeof(ExactSum);
  }
  return bytes_a_pixel * static_cast<std::uint64_t>(size_px.x) * static_cast<std::uint64_t>(size_px.y);
}

std::uint64_t machine_bytes() {
  return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

MemoryNeeds picture_needs(IVec2 size_px, const RenderRequest& request, bool light_image, const Context& context) {
  const Method& method = find_method(request.method);
  const VisibilityInfo& visibility = find_visibility(request.visibility.value_or(method.default_visibility()));
  MemoryNeeds needs;
  needs.picture = picture_bytes(size_px, frame_layers(request), light_image);
  if (visibility.table_bytes)
    needs.visibility = visibility.table_bytes(resolve_settings(method, visibility, request.settings).visibility, context);
  return needs;
}

MemoryNeeds with_world(MemoryNeeds needs, const World& world) {
  needs.scene = scene_bytes(world.scene()) + world.textures().memory_bytes();
  needs.acceleration = world.acceleration_bytes();
  return needs;
}

void check_memory(const MemoryNeeds& needs, const Context& context) {
  const bool limited = context.memory_budget_bytes > 0;
  const std::uint64_t limit = limited ? context.memory_budget_bytes : machine_bytes();
  if (needs.total() <= limit) return;
  const std::array<std::pair<const char*, std::uint64_t>, 4> parts = {{{"scene", needs.scene},
                                                                       {"acceleration structure", needs.acceleration},
                                                                       {"picture", needs.picture},
                                                                       {"visibility", needs.visibility}}};
  std::vector<std::string> listed;
  for (const auto& [name, bytes] : parts) {
    if (bytes > 0) listed.push_back(fmt::format("{} {:.2f}", name, static_cast<double>(bytes) / kGib));
  }
  const std::string sum = listed.size() > 1 ? fmt::format(", together {:.2f}", static_cast<double>(needs.total()) / kGib) : "";
  std::vector<std::string> ways;
  if (limited) ways.emplace_back("raise --memory-limit");
  if (needs.picture > 0) ways.emplace_back("render smaller or with fewer layers");
  if (needs.scene > needs.picture) ways.emplace_back("use a smaller scene");
  if (needs.visibility > needs.picture) ways.emplace_back("lower the settings of the visibility that size its tables");
  throw resource_error(fmt::format("too little memory: {}{} GiB needed, {} {:.2f} GiB", fmt::join(listed, ", "), sum,
                                   limited ? "the memory limit is" : "this machine has", static_cast<double>(limit) / kGib))
      .remedy(fmt::format("{}", fmt::join(ways, ", or ")));
}

}  // namespace sightline
