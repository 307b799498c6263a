// Bidirectional path tracing with all strategies. See README.md beside this file.
#pragma once

#include "methods/method.h"

namespace sightline {

class BidirectionalMethod final : public Method {
 public:
  const MethodInfo& info() const override;
  SettingsValue default_settings() const override;
  std::unique_ptr<const Bake> prepare(const RenderJob& job, const Context& context) const override;
  std::uint32_t pass_multiple(const RenderJob& job) const override;
  bool light_image(const RenderJob& job) const override;
  void render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                   const Context& context) const override;
};

}  // namespace sightline
