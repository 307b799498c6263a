// All-frequency environments on moving objects: precomputed distances, squares of light, tables of the BRDF.
#pragma once

#include "methods/method.h"
#include "methods/square_lights/settings.h"

namespace sightline {

class SquareLightsMethod final : public Method {
 public:
  const MethodInfo& info() const override;
  SettingsValue default_settings() const override;
  int default_spp() const override { return 4; }
  void check(const Scene& scene, const RenderJob& job) const override;
  std::unique_ptr<const Bake> prepare(const RenderJob& job, const Context& context) const override;
  void render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                   const Context& context) const override;
};

}  // namespace sightline
