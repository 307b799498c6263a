// The progressive loop: passes until a limit is reached, with checkpoints and sinks.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bake/bake_store.h"
#include "base/core/stopwatch.h"
#include "film/frame.h"
#include "film/frame_file.h"
#include "methods/method.h"
#include "session/scheduler.h"

namespace sightline {

/// What to render with, as the user states it.
struct RenderRequest {
  std::string method = "reference";
  std::optional<std::string> visibility;
  std::vector<std::string> settings;  ///< "key=value" of the method or the visibility
  std::optional<int> spp, light_samples, max_bounces;
  std::optional<double> target_error, time_limit_s;
  std::optional<SampleRange> sample_range;  ///< part of the total spp
  AovSet aovs;
  std::optional<std::filesystem::path> checkpoint, resume;
  /// Whether the result says what slices and checkpoints of it must share: a hash of the whole scene, which a viewer need not pay for.
  bool wants_identity = true;
  /// Where methods keep what they precompute, over frames and runs; null: nowhere.
  std::shared_ptr<BakeStore> bakes;
};

/// Wall seconds by phase.
struct Timings {
  double load = 0, build = 0, prepare = 0, render = 0, write = 0, total = 0;
};

struct RenderResult {
  Frame frame;
  PassStatistics statistics;
  StopReason stop = StopReason::none;
  std::string method, visibility;
  std::vector<std::pair<std::string, std::string>> settings;  ///< all, with defaults, of method then visibility
  int spp = 0, light_samples = 0, max_bounces = 0;
  std::optional<double> error;
  std::uint64_t bake_bytes = 0;  ///< of what the method precomputed
  Timings seconds;
  FrameIdentity identity;  ///< what slices and checkpoints of this picture carry
};

/// Receives snapshots; called between passes on the rendering thread. The session knows nothing of files, bars or servers.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// `statistics` are those of all passes so far.
  virtual void pass_done(const Frame& frame, SampleRange pass, SampleRange all, const PassStatistics& statistics) = 0;
};

/// Renders one view. `filter` names the pixel filter that View was made with unless total spp is 1 (then rays go through pixel centres).
/// Cancelling the context ends the loop after the pass, or, if that takes longer than 5 s, with what complete tiles hold
/// (StopReason::interrupted); a time limit ends it within the pass. Both throw only if there is no complete tile at all. A checkpoint that
/// cannot be written is a warning.
RenderResult render(const std::shared_ptr<const World>& world, const Camera& camera, IVec2 size_px, PixelFilter filter,
                    const RenderRequest& request, const Context& context, const Stopwatch& since_start,
                    const std::vector<FrameSink*>& sinks = {});

/// What a method precomputes for this scene, made and kept in request.bakes without a picture. Returns its bytes.
std::uint64_t bake(const std::shared_ptr<const World>& world, const RenderRequest& request, const Context& context);

/// The settings of a request resolved: throws Error{usage} for unknown keys (nearest of both schemas) and bad values.
struct ResolvedSettings {
  SettingsValue method, visibility;
  std::vector<std::string> unused;  ///< settings of other visibilities, given so that runs to be compared differ in --visibility alone
};
ResolvedSettings resolve_settings(const Method& method, const VisibilityInfo& visibility, const std::vector<std::string>& assignments);

/// Layers of the frame that the request leads to.
AovSet frame_layers(const RenderRequest& request);

/// Name of the SIMD target that Highway kernels run on ("AVX3", ...).
std::string simd_target_name();

}  // namespace sightline
