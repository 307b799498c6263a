#include "bench/visibility_cache/frame_share.h"

#include <mutex>

#include "bench/visibility_cache/one_pass.h"

namespace sightline {
namespace {

/// A clock around every batch.
class Timed final : public VisibilityInFront {
 public:
  using VisibilityInFront::VisibilityInFront;
  std::unique_ptr<VisibilityWorker> worker() override { return std::make_unique<Worker>(*this); }
  double seconds() const { return seconds_; }

 private:
  class Worker final : public VisibilityWorker {
   public:
    explicit Worker(Timed& timed) : timed_(timed), inner_(timed.inner_.worker()) {}
    ~Worker() override {
      const std::lock_guard lock(timed_.mutex_);
      timed_.seconds_ += seconds_;
    }
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;
    void begin(std::uint32_t scope) override {
      const Stopwatch watch;
      inner_->begin(scope);
      seconds_ += watch.seconds();
    }
    bool exact() const override { return inner_->exact(); }
    void visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) override {
      const Stopwatch watch;
      inner_->visible(queries, weights, rays, counts);
      seconds_ += watch.seconds();
    }

   private:
    Timed& timed_;
    std::unique_ptr<VisibilityWorker> inner_;
    double seconds_ = 0;
  };

  std::mutex mutex_;
  double seconds_ = 0;
};

}  // namespace

FrameShare measure_frame_share(const CacheView& view, const std::string& visibility, const std::vector<std::string>& settings,
                               const Context& context) {
  FrameShare best;
  for (int run = 0; run < 2; ++run) {
    const MadeVisibility made = make_visibility(view, visibility, settings, context);
    Timed timed(*made.visibility);
    const OnePass pass = render_one_pass(view, made.method_settings, timed, context);
    if (run == 0 || pass.seconds < best.frame_seconds) best = {pass.seconds, timed.seconds(), pass.statistics.visibility};
  }
  return best;
}

}  // namespace sightline
