#include <string>

#include "base/core/error.h"
#include "visibility/automatic/automatic.h"
#include "visibility/cached/cached.h"
#include "visibility/exact/exact.h"
#include "visibility/nee_plus_plus/nee_plus_plus.h"
#include "visibility/shadow_map/shadow_map.h"
#include "visibility/visibility.h"

namespace sightline {

const std::vector<VisibilityInfo>& visibilities() {
  static const std::vector<VisibilityInfo> table = {
      exact_visibility(), cached_visibility(), automatic_visibility(), nee_plus_plus_visibility(), shadow_map_visibility(),
  };
  return table;
}

const VisibilityInfo& find_visibility(std::string_view name) {
  std::vector<std::string> known;
  for (const VisibilityInfo& info : visibilities()) {
    if (info.name == name) return info;
    known.push_back(info.name);
  }
  Error error = usage_error("unknown visibility '" + std::string(name) + "'");
  const std::string nearest = nearest_name(name, known);
  std::string list;
  for (const std::string& entry : known) list += (list.empty() ? "" : ", ") + entry;
  error.remedy(nearest.empty() ? "known: " + list : "did you mean '" + nearest + "'?");
  throw error;
}

}  // namespace sightline
