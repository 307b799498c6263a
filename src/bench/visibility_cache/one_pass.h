// One pass of the method with a visibility of the benchmark's own in front of the real one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/visibility_cache/cache_view.h"
#include "methods/method.h"

namespace sightline {

/// A visibility and the settings that it and the method were made with.
struct MadeVisibility {
  std::unique_ptr<Visibility> visibility;
  SettingsValue method_settings;
};
MadeVisibility make_visibility(const CacheView& view, const std::string& name, const std::vector<std::string>& settings,
                               const Context& context);

struct OnePass {
  double seconds = 0;
  PassStatistics statistics;
};
/// The view at one sample a pixel.
OnePass render_one_pass(const CacheView& view, const SettingsValue& method_settings, Visibility& visibility, const Context& context);

/// Hands everything on; what to do about queries is for a derived class's workers.
class VisibilityInFront : public Visibility {
 public:
  explicit VisibilityInFront(Visibility& inner) : inner_(inner) {}
  bool binary() const override { return inner_.binary(); }
  bool exact() const override { return inner_.exact(); }
  float cluster_edge() const override { return inner_.cluster_edge(); }
  void begin_pass(const VisibilityPass& pass, const Context& context) override { inner_.begin_pass(pass, context); }

 protected:
  Visibility& inner_;
};

}  // namespace sightline
