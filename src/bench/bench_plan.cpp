#include "bench/bench_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/core/error.h"
#include "base/settings/settings.h"
#include "bench/bench_views.h"

namespace sightline {
namespace {

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

std::vector<std::string> part_names(const std::vector<BenchPart>& parts) {
  std::vector<std::string> names;
  names.reserve(parts.size());
  for (const BenchPart& part : parts) names.push_back(part.name);
  return names;
}

BenchPlan::BenchPlan(const std::vector<BenchPart>& parts, const std::vector<std::string>& wanted, const std::vector<std::string>& views)
    : parts_(parts), wanted_(wanted), views_given_(!views.empty()) {
  const std::vector<std::string> known = part_names(parts);
  for (const std::string& part : wanted) {
    if (contains(known, part)) continue;
    const std::string nearest = nearest_name(part, known);
    throw usage_error("unknown part '" + part + "'")
        .remedy(nearest.empty() ? fmt::format("known: {}", fmt::join(known, ", ")) : "did you mean '" + nearest + "'?");
  }
  // Before hours of work, not after.
  for (const std::string& view : views) check_bench_view(view);
  for (const BenchPart& part : parts_) {
    if (!this->wanted(part.name)) continue;
    for (const std::string& view : views_given_ ? views : part.views) {
      if (!contains(views_, view)) views_.push_back(view);
    }
  }
}

bool BenchPlan::has(const std::string& part_name, const std::string& view) const {
  const auto part = std::find_if(parts_.begin(), parts_.end(), [&](const BenchPart& p) { return p.name == part_name; });
  return part != parts_.end() && wanted(part_name) && (views_given_ || contains(part->views, view));
}

void BenchPlan::check_read(const char* option, bool given, const std::vector<std::string>& readers) const {
  if (!given || std::any_of(readers.begin(), readers.end(), [&](const std::string& reader) { return wanted(reader); })) return;
  throw usage_error(fmt::format("{} has no effect on the parts asked for", option))
      .remedy(fmt::format("leave it out or add --part {}", fmt::join(readers, " or ")));
}

bool BenchPlan::wanted(const std::string& part) const { return wanted_.empty() || contains(wanted_, part); }

}  // namespace sightline
