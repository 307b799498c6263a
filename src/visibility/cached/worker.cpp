#include "visibility/cached/worker.h"

#include <algorithm>
#include <utility>

namespace sightline {
namespace {

constexpr std::size_t kResidualPacket = 1024;

}  // namespace

CachedWorker::CachedWorker(std::shared_ptr<CacheCore> core)
    : core_(std::move(core)), table_(core_->settings.table_bits), keys_(core_->quantizer, core_->settings), tracer_(*core_->world) {
  core_->bytes += table_.bytes();
  begin(0);
}

CachedWorker::~CachedWorker() { core_->bytes -= table_.bytes(); }

void CachedWorker::begin(std::uint32_t scope) {
  table_.clear();
  salt_ = core_->salt(core_->pass.first_sample, core_->pass.frame, scope);
}

void CachedWorker::visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) {
  const Batch batch{queries, weights, rays, counts};
  keys_.prepare(queries, salt_);
  if (core_->settings.residual > 0) mark_.assign(queries.size, 0);
  const std::size_t step = padded(static_cast<std::size_t>(core_->settings.group));
  const std::size_t groups = keys_.groups().size();
  if (groups != 1) std::fill_n(weights.data(), queries.size, 0.f);  // gaps
  if (groups == 1) {
    for (std::size_t first = 0; first < queries.size; first += step) {
      const std::size_t count = std::min(step, queries.size - first);
      answer(batch, 0, {keys_.eye_of() + first, keys_.light_of() + first, nullptr, static_cast<std::uint32_t>(first), count});
    }
  } else {
    for (std::size_t g = 0; g < groups; ++g) {
      const AlignedVector<std::uint32_t>& members = keys_.members(g);
      for (std::size_t first = 0; first < members.size(); first += step) {
        next_.count = std::min(step, members.size() - first);
        next_.id.resize(std::max(next_.id.size(), padded(next_.count)));
        std::copy_n(members.data() + first, next_.count, next_.id.data());
        answer(batch, g, gather(next_));
      }
    }
  }
  if (core_->settings.residual > 0) add_residual(batch);
}

CachedWorker::Range CachedWorker::gather(List& list) const {
  const std::size_t size = padded(list.count);
  if (list.id.size() < size) list.id.resize(size);
  if (list.eye.size() < size) list.eye.resize(size), list.light.resize(size);
  for (std::size_t k = 0; k < list.count; ++k) {
    list.eye[k] = keys_.eye_of()[list.id[k]];
    list.light[k] = keys_.light_of()[list.id[k]];
  }
  return {list.eye.data(), list.light.data(), list.id.data(), 0, list.count};
}

LookUp CachedWorker::look_up_of(std::size_t group, int level, const Range& range) {
  LookUp look_up = keys_.level(group, level);
  look_up.eye = range.eye, look_up.light = range.light, look_up.id = range.id;
  look_up.first = range.first, look_up.count = range.count;
  look_up.table = table_.data(), look_up.table_bits = table_.bits();
  return look_up;
}

// [Popov2013, Alg. 2] for some hundred queries at a time: those that hit and agree with their neighbours are answered, misses are traced
// and stored, those at an edge go on with cells half as wide.
void CachedWorker::answer(const Batch& batch, std::size_t group, Range range) {
  const int levels = keys_.groups()[group].levels;
  VisibilityCounts& counts = batch.counts;
  for (int level = 0; level < levels && range.count > 0; ++level) {
    look_up_lanes(look_up_of(group, level, range), batch.weights.data(), result_);
    // A query is counted where it begins.
    if (level == 0) counts.queries += result_.asked + result_.exacts;
    counts.lookups += result_.lookups, counts.rejected += result_.rejected;
    counts.cached += result_.answered, counts.answered_at_depth[static_cast<std::size_t>(level)] += result_.answered;
    if (core_->settings.residual > 0 && level == 0) {
      for (std::size_t k = 0; k < result_.refines; ++k) mark_[result_.refine_id[k]] = kMarkEdge;
    }

    duplicates_.count = 0;
    if (result_.misses + result_.exacts > 0) trace_misses(batch, level);
    next_.count = result_.refines;
    next_.id.resize(std::max(next_.id.size(), padded(range.count)));
    std::copy_n(result_.refine_id.data(), result_.refines, next_.id.data());
    if (duplicates_.count > 0) resolve_duplicates(batch, group, level);
    range = gather(next_);
  }
}

// One ray for each key that was missed, traced for the query that came first; and one for each query that cannot be cached.
void CachedWorker::trace_misses(const Batch& batch, int level) {
  const LookUpResult& r = result_;
  const std::size_t most = r.misses + r.exacts;
  if (which_.size() < most) which_.resize(padded(most));
  if (owner_.size() < r.misses) owner_.resize(padded(r.misses));
  if (duplicates_.id.size() < r.misses) duplicates_.id.resize(padded(r.misses));
  seen_.begin(r.misses);
  std::size_t rays = 0;
  for (std::size_t k = 0; k < r.misses; ++k) {
    const std::uint32_t slot = static_cast<std::uint32_t>(rays);
    owner_[k] = seen_.first(r.miss_index[k], r.miss_tag[k], slot);
    if (owner_[k] == slot) which_[rays++] = r.miss_id[k];
  }
  const std::size_t keys = rays;
  std::copy_n(r.exact_id.data(), r.exacts, which_.data() + rays);
  rays += r.exacts;

  const std::span<const std::uint8_t> occluded = tracer_.trace(batch.queries, std::span(which_).first(rays), batch.rays, batch.counts);
  for (std::size_t k = keys; k < rays; ++k) batch.weights[which_[k]] = occluded[k] ? 0.f : 1.f;
  std::size_t stored = 0;
  for (std::size_t k = 0; k < r.misses; ++k) {
    const bool visible = !occluded[owner_[k]];
    batch.weights[r.miss_id[k]] = visible ? 1.f : 0.f;
    if (owner_[k] == stored) {
      table_.insert(r.miss_index[k], r.miss_tag[k], visible, core_->format());
      ++stored;
    } else {
      duplicates_.id[duplicates_.count++] = r.miss_id[k];
    }
  }
  if (core_->settings.residual > 0) {
    for (std::size_t k = 0; k < rays; ++k) mark_[which_[k]] = kMarkTraced;
  }
  batch.counts.cached += duplicates_.count;
  batch.counts.answered_at_depth[static_cast<std::size_t>(level)] += duplicates_.count;
}

// Queries that share the ray of an earlier one of their group have its answer; where they would have found it in the cache they would
// have looked at the neighbours too, which by now hold what the group has traced.
void CachedWorker::resolve_duplicates(const Batch& batch, std::size_t group, int level) {
  const LookUp probe = look_up_of(group, level, gather(duplicates_));
  if (probe.last_level) return;
  look_up_lanes(probe, batch.weights.data(), again_);
  batch.counts.lookups += again_.lookups;
  if (again_.refines == 0) return;
  batch.counts.cached -= again_.refines;
  batch.counts.answered_at_depth[static_cast<std::size_t>(level)] -= again_.refines;
  if (core_->settings.residual > 0) {
    for (std::size_t k = 0; k < again_.refines; ++k) mark_[again_.refine_id[k]] = kMarkEdge;
  }
  const std::size_t before = next_.count;
  next_.count += again_.refines;
  if (next_.id.size() < next_.count) next_.id.resize(padded(next_.count));
  std::copy_n(again_.refine_id.data(), again_.refines, next_.id.data() + before);
  const auto begin = next_.id.begin();
  std::inplace_merge(begin, begin + static_cast<std::ptrdiff_t>(before), begin + static_cast<std::ptrdiff_t>(next_.count));
}

// V^c + (B / p) (V - V^c) with B = 1 in a share p of all cached answers: right in the mean, and noisy only where the cache is wrong.
void CachedWorker::add_residual(const Batch& batch) {
  const QueryBatch& queries = batch.queries;
  const ResidualChoice choice(core_->settings, core_->pass);
  which_.resize(std::max(which_.size(), kResidualPacket));
  std::size_t count = 0;
  const auto flush = [&] {
    if (count == 0) return;
    const std::span<const std::uint8_t> occluded = tracer_.trace(queries, std::span(which_).first(count), batch.rays, batch.counts);
    for (std::size_t k = 0; k < count; ++k) {
      float& weight = batch.weights[which_[k]];
      weight += ((occluded[k] ? 0.f : 1.f) - weight) / choice.probability(mark_[which_[k]] == kMarkEdge);
    }
    batch.counts.residual += count;
    count = 0;
  };
  for (std::uint32_t i = 0; i < queries.size; ++i) {
    if (queries.light_of[i] == kNoQuery || mark_[i] == kMarkTraced) continue;
    if (!choice.taken(queries, i, choice.probability(mark_[i] == kMarkEdge))) continue;
    which_[count++] = i;
    if (count == kResidualPacket) flush();
  }
  flush();
}

}  // namespace sightline
