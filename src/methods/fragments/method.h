// Direct light from area lights at the resolution that the shadow needs. See README.md beside this file.
#pragma once

#include "methods/fragments/picture_buffers.h"
#include "methods/method.h"

namespace sightline {

class FragmentsMethod final : public Method {
 public:
  const MethodInfo& info() const override;
  SettingsValue default_settings() const override;
  int default_spp() const override { return 1; }
  void check(const Scene& scene, const RenderJob& job) const override;
  void render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                   const Context& context) const override;

 private:
  PictureBufferStore buffers_;
};

}  // namespace sightline
