// The reference: path tracing, naive on purpose. See README.md beside this file.
#pragma once

#include "methods/method.h"

namespace sightline {

class ReferenceMethod final : public Method {
 public:
  const MethodInfo& info() const override;
  SettingsValue default_settings() const override;
  std::uint32_t pass_multiple(const RenderJob& job) const override;
  void render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                   const Context& context) const override;
};

}  // namespace sightline
