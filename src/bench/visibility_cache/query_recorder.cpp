#include "bench/visibility_cache/query_recorder.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "methods/method.h"

namespace sightline {
namespace {

/// Hands everything on, and keeps a copy of what the wanted scopes ask.
class Recorder final : public Visibility {
 public:
  Recorder(std::unique_ptr<Visibility> inner, std::uint32_t every, std::uint64_t most)
      : inner_(std::move(inner)), every_(every), most_(most) {}

  bool binary() const override { return inner_->binary(); }
  bool exact() const override { return inner_->exact(); }
  float cluster_edge() const override { return inner_->cluster_edge(); }
  void begin_pass(const VisibilityPass& pass, const Context& context) override { inner_->begin_pass(pass, context); }
  std::unique_ptr<VisibilityWorker> worker() override { return std::make_unique<Worker>(*this); }

  std::vector<RecordedScope> take() {
    std::sort(scopes_.begin(), scopes_.end(), [](const RecordedScope& a, const RecordedScope& b) { return a.scope < b.scope; });
    return std::move(scopes_);
  }

 private:
  class Worker final : public VisibilityWorker {
   public:
    explicit Worker(Recorder& recorder) : recorder_(recorder), inner_(recorder.inner_->worker()) {}
    ~Worker() override { recorder_.keep(std::move(current_)); }
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;
    void begin(std::uint32_t scope) override {
      recorder_.keep(std::exchange(current_, {}));
      current_.scope = scope;
      inner_->begin(scope);
    }
    void visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) override {
      if (current_.scope % recorder_.every_ == recorder_.every_ / 2) current_.batches.push_back(queries);
      inner_->visible(queries, weights, rays, counts);
    }

   private:
    Recorder& recorder_;
    std::unique_ptr<VisibilityWorker> inner_;
    RecordedScope current_;
  };

  void keep(RecordedScope scope) {
    if (scope.batches.empty()) return;
    const std::lock_guard lock(mutex_);
    if (recorded_ >= most_) return;
    for (const QueryBatch& batch : scope.batches) recorded_ += batch.size;
    scopes_.push_back(std::move(scope));
  }

  std::unique_ptr<Visibility> inner_;
  std::uint32_t every_;
  std::uint64_t most_, recorded_ = 0;
  std::mutex mutex_;
  std::vector<RecordedScope> scopes_;
};

}  // namespace

std::vector<RecordedScope> record_queries(const CacheView& view, const std::string& visibility, const std::vector<std::string>& settings,
                                          std::uint64_t queries, const Context& context) {
  const Method& method = find_method("visibility-cache");
  const VisibilityInfo& info = find_visibility(visibility);
  const ResolvedSettings resolved = resolve_settings(method, info, settings);
  const View camera_view(view.camera, view.size_px, PixelFilter(PixelFilter::Kind::centre));
  Frame frame(view.size_px.x, view.size_px.y, {});
  // Tiles far from each other; more of them where a tile asks little.
  const auto every = static_cast<std::uint32_t>(std::clamp<std::size_t>(frame.tile_count() / 16, 1, 97));
  Recorder recorder(info.make(view.world, resolved.visibility, context), every, queries);
  RenderJob job;
  job.world = view.world;
  job.view = &camera_view;
  job.settings = resolved.method;
  job.visibility = &recorder;
  job.max_bounces = view.max_bounces;
  job.light_samples = view.light_samples;
  PassStatistics statistics;
  method.render_pass(job, {0, 1}, frame, statistics, context);
  return recorder.take();
}

}  // namespace sightline
