#include "visibility/automatic/automatic.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <utility>

#include "visibility/automatic/trial.h"
#include "visibility/cached/cached.h"
#include "visibility/exact/exact.h"

namespace sightline {
namespace {

/// The trial of all workers of one picture, and its outcome.
class SharedTrial {
 public:
  std::optional<Trial::Side> verdict() const {
    const int value = verdict_.load(std::memory_order_acquire);
    return value < 0 ? std::nullopt : std::optional(static_cast<Trial::Side>(value));
  }
  Trial::Side next() {
    const std::lock_guard lock(mutex_);
    return trial_.next();
  }
  void add(Trial::Side side, double seconds, std::uint64_t queries) {
    const std::lock_guard lock(mutex_);
    if (verdict()) return;
    trial_.add(side, seconds, queries);
    const std::optional<Trial::Side> found = trial_.verdict();
    if (!found) return;
    verdict_.store(*found, std::memory_order_release);
    if (!context_) return;
    constexpr double kNanoseconds = 1e9;
    context_->info(fmt::format("auto: {:.0f} ns a query with the cache, {:.0f} ns with rays: {}",
                               kNanoseconds * trial_.cost(Trial::cached).per_query(), kNanoseconds * trial_.cost(Trial::exact).per_query(),
                               *found == Trial::cached ? "going on with the cache" : "the cache does not pay here, going on with rays"));
  }
  void begin(const Context& context) {
    context_ = &context;
    if (verdict() || announced_) return;
    announced_ = true;
    context.info("auto: rays, until some tiles have shown whether the cache is cheaper");
  }

 private:
  std::mutex mutex_;
  Trial trial_;
  std::atomic<int> verdict_{-1};
  const Context* context_ = nullptr;
  bool announced_ = false;
};

/// While a scope is on trial it is answered by rays: a picture too small for a verdict is exact.
class AutomaticWorker final : public VisibilityWorker {
 public:
  AutomaticWorker(SharedTrial& trial, std::unique_ptr<VisibilityWorker> cached, std::unique_ptr<VisibilityWorker> exact)
      : trial_(trial), cached_(std::move(cached)), exact_(std::move(exact)) {}

  void begin(std::uint32_t scope) override {
    close_scope();
    const std::optional<Trial::Side> verdict = trial_.verdict();
    side_ = verdict ? *verdict : trial_.next();
    measuring_ = !verdict;
    current().begin(scope);
  }
  // Rays are measured in the order in which they would be traced.
  bool exact() const override { return side_ == Trial::exact; }
  void visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) override {
    if (!measuring_) return current().visible(queries, weights, rays, counts);
    VisibilityCounts tried;
    const auto start = std::chrono::steady_clock::now();
    current().visible(queries, weights, rays, tried);
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    queries_ += tried.queries;
    if (side_ == Trial::exact) {
      counts += tried;
      return;
    }
    counts.traced += tried.traced;
    exact_->visible(queries, weights, rays, counts);
  }

 private:
  VisibilityWorker& current() { return side_ == Trial::cached ? *cached_ : *exact_; }
  // A scope counts as a whole: a cache is filled by its first queries and pays with the later ones.
  void close_scope() {
    if (measuring_) trial_.add(side_, seconds_, queries_);
    seconds_ = 0, queries_ = 0;
  }

  SharedTrial& trial_;
  std::unique_ptr<VisibilityWorker> cached_, exact_;
  Trial::Side side_ = Trial::cached;
  bool measuring_ = false;
  double seconds_ = 0;
  std::uint64_t queries_ = 0;
};

class AutomaticVisibility final : public Visibility {
 public:
  AutomaticVisibility(std::unique_ptr<Visibility> cached, std::unique_ptr<Visibility> exact)
      : cached_(std::move(cached)), exact_(std::move(exact)) {}
  bool binary() const override { return cached_->binary(); }
  bool passes_are_independent() const override { return false; }
  float cluster_edge() const override { return cached_->cluster_edge(); }
  void begin_pass(const VisibilityPass& pass, const Context& context) override {
    trial_.begin(context);
    cached_->begin_pass(pass, context);
    exact_->begin_pass(pass, context);
  }
  std::unique_ptr<VisibilityWorker> worker() override {
    return std::make_unique<AutomaticWorker>(trial_, cached_->worker(), exact_->worker());
  }
  // Waves share answers over a whole pass: there is no part of one that could be tried beforehand.
  std::unique_ptr<VisibilityWave> wave(std::size_t slots) override { return cached_->wave(slots); }
  std::uint64_t memory_bytes() const override { return cached_->memory_bytes(); }

 private:
  std::unique_ptr<Visibility> cached_, exact_;
  SharedTrial trial_;
};

}  // namespace

VisibilityInfo automatic_visibility() {
  const VisibilityInfo cached = cached_visibility();
  VisibilityInfo info = cached;
  info.name = "auto";
  info.help = "the cache, unless the first tiles show that rays are cheaper here; depends on timing";
  info.deterministic = false;
  info.make = [](std::shared_ptr<const World> world, const SettingsValue& settings, const Context& context) -> std::unique_ptr<Visibility> {
    const VisibilityInfo rays = exact_visibility();
    std::unique_ptr<Visibility> cached_answers = cached_visibility().make(world, settings, context);
    return std::make_unique<AutomaticVisibility>(std::move(cached_answers), rays.make(std::move(world), rays.settings, context));
  };
  return info;
}

}  // namespace sightline
