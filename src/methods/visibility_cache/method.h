// Whitted-style pictures with direct light and instant radiosity, all of whose visibility is asked in batches [Popov2013]. See README.md.
#pragma once

#include "methods/method.h"

namespace sightline {

class VisibilityCacheMethod final : public Method {
 public:
  const MethodInfo& info() const override;
  SettingsValue default_settings() const override;
  std::string default_visibility() const override { return "cached"; }
  int default_spp() const override { return 16; }
  std::uint32_t pass_multiple(const RenderJob& job) const override;
  void render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                   const Context& context) const override;
};

}  // namespace sightline
