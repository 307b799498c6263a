#include "bench/visibility_cache/query_recorder.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "bench/visibility_cache/one_pass.h"

namespace sightline {
namespace {

/// Hands everything on, and keeps a copy of what the wanted scopes ask.
class Recorder final : public VisibilityInFront {
 public:
  Recorder(Visibility& inner, std::uint32_t every, std::uint64_t most) : VisibilityInFront(inner), every_(every), most_(most) {}

  std::unique_ptr<VisibilityWorker> worker() override { return std::make_unique<Worker>(*this); }

  std::vector<RecordedScope> take() {
    std::sort(scopes_.begin(), scopes_.end(), [](const RecordedScope& a, const RecordedScope& b) { return a.scope < b.scope; });
    return std::move(scopes_);
  }

 private:
  class Worker final : public VisibilityWorker {
   public:
    explicit Worker(Recorder& recorder) : recorder_(recorder), inner_(recorder.inner_.worker()) {}
    ~Worker() override { recorder_.keep(std::move(current_)); }
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;
    void begin(std::uint32_t scope) override {
      recorder_.keep(std::exchange(current_, {}));
      current_.scope = scope;
      inner_->begin(scope);
    }
    bool exact() const override { return inner_->exact(); }
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

  std::uint32_t every_;
  std::uint64_t most_, recorded_ = 0;
  std::mutex mutex_;
  std::vector<RecordedScope> scopes_;
};

}  // namespace

std::vector<RecordedScope> record_queries(const CacheView& view, const std::string& visibility, const std::vector<std::string>& settings,
                                          std::uint64_t queries, const Context& context) {
  const MadeVisibility made = make_visibility(view, visibility, settings, context);
  // Tiles far from each other; more of them where a tile asks little.
  const std::size_t tiles = Frame(view.size_px.x, view.size_px.y, {}).tile_count();
  const auto every = static_cast<std::uint32_t>(std::clamp<std::size_t>(tiles / 16, 1, 97));
  Recorder recorder(*made.visibility, every, queries);
  render_one_pass(view, made.method_settings, recorder, context);
  return recorder.take();
}

}  // namespace sightline
