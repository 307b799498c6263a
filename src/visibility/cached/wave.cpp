#include "visibility/cached/wave.h"

#include <algorithm>

#include "base/parallel/parallel.h"
#include "visibility/cached/miss_set.h"

namespace sightline {
namespace {

constexpr std::size_t kChunk = 4096;  // queries whose results stay in the cache of a core

}  // namespace

void CachedWave::look_up(std::size_t slot, const QueryBatch& queries, RayCounts&, VisibilityCounts& counts) {
  std::unique_ptr<Scratch> scratch;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) scratch = std::move(idle_.back()), idle_.pop_back();
  }
  if (!scratch) scratch = std::make_unique<Scratch>(*core_);

  Slot& own = slots_[slot];
  own.queries = &queries;
  own.keyless.clear(), own.corrections.clear();
  own.weights.resize(std::max(own.weights.size(), padded(queries.size)));
  if (core_->settings.residual > 0) own.mark.assign(queries.size, 0);
  scratch->misses.clear();
  BatchKeys& keys = scratch->keys;
  keys.prepare(queries, salt_);
  const std::size_t groups = keys.groups().size();
  if (groups != 1) std::fill_n(own.weights.data(), queries.size, 0.f);  // gaps
  bool in_order = groups == 1;
  for (std::size_t g = 0; g < groups; ++g) {
    in_order &= keys.groups()[g].levels == 1;
    const std::size_t size = groups == 1 ? queries.size : keys.members(g).size();
    for (std::size_t first = 0; first < size; first += kChunk) {
      LookUp range;
      range.count = std::min(kChunk, size - first);
      if (groups == 1) {
        range.eye = keys.eye_of() + first, range.light = keys.light_of() + first;
        range.first = static_cast<std::uint32_t>(first);
      } else {
        scratch->id.resize(std::max(scratch->id.size(), padded(range.count)));
        std::copy_n(keys.members(g).data() + first, range.count, scratch->id.data());
      }
      look_up_range(own, *scratch, g, range, counts);
    }
  }
  sort_misses(own, *scratch, !in_order);

  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(scratch));
}

// Some queries through all levels of the table as it is.
void CachedWave::look_up_range(Slot& own, Scratch& scratch, std::size_t group, LookUp range, VisibilityCounts& counts) const {
  const int levels = scratch.keys.groups()[group].levels;
  for (int level = 0; level < levels && range.count > 0; ++level) {
    if (range.eye == nullptr) {
      const std::size_t size = padded(range.count);
      if (scratch.eye.size() < size) scratch.eye.resize(size), scratch.light.resize(size);
      for (std::size_t k = 0; k < range.count; ++k) {
        scratch.eye[k] = scratch.keys.eye_of()[scratch.id[k]];
        scratch.light[k] = scratch.keys.light_of()[scratch.id[k]];
      }
      range.eye = scratch.eye.data(), range.light = scratch.light.data(), range.id = scratch.id.data();
    }
    LookUp look_up = scratch.keys.level(group, level);
    look_up.eye = range.eye, look_up.light = range.light, look_up.id = range.id;
    look_up.first = range.first, look_up.count = range.count;
    look_up.table = table_->table().data(), look_up.table_bits = table_->table().bits();
    LookUpResult& result = scratch.result;
    look_up_lanes(look_up, own.weights.data(), result);

    if (level == 0) counts.queries += result.asked + result.exacts;
    counts.lookups += result.lookups, counts.rejected += result.rejected, counts.cached += result.answered;
    counts.answered_at_depth[static_cast<std::size_t>(level)] += result.answered;
    for (std::size_t k = 0; k < result.misses; ++k)
      scratch.misses.push_back({result.miss_id[k], result.miss_index[k], result.miss_tag[k], static_cast<std::uint32_t>(level)});
    own.keyless.insert(own.keyless.end(), result.exact_id.begin(), result.exact_id.begin() + static_cast<std::ptrdiff_t>(result.exacts));
    if (core_->settings.residual > 0) {
      for (std::size_t k = 0; k < result.refines; ++k) own.mark[result.refine_id[k]] = kMarkEdge;
    }
    range = {};
    range.count = result.refines;
    scratch.id.resize(std::max(scratch.id.size(), padded(range.count)));
    std::copy_n(result.refine_id.data(), result.refines, scratch.id.data());
  }
}

// Misses by part of the table, in the order of their queries within each.
void CachedWave::sort_misses(Slot& own, Scratch& scratch, bool by_query) const {
  std::vector<Miss>& found = scratch.misses;
  if (by_query) std::sort(found.begin(), found.end(), [](const Miss& a, const Miss& b) { return a.query < b.query; });
  own.part_begin.fill(0);
  for (const Miss& miss : found) ++own.part_begin[table_->part_of(miss.index) + 1];
  for (std::size_t part = 0; part < kParts; ++part) own.part_begin[part + 1] += own.part_begin[part];
  own.misses.resize(found.size());
  std::array<std::size_t, kParts + 1> next = own.part_begin;
  for (const Miss& miss : found) own.misses[next[table_->part_of(miss.index)]++] = miss;
}

void CachedWave::trace(const Context& context, RayCounts& rays, VisibilityCounts& counts) {
  parallel_for(context, kParts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part) find_keys(part);
  });
  parallel_for(context, slots_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = begin; slot < end; ++slot) trace_slot(slot);
  });
  parallel_for(context, kParts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part) {
      for (const Key& key : parts_[part].keys) table_->insert(key.index, key.tag, key.visible, core_->format());
    }
  });
  for (const Part& part : parts_) counts += part.counts;
  for (const Slot& slot : slots_) rays += slot.rays, counts += slot.counts;
}

// The keys that were missed in one part of the table: slots in order, so that the first query of the wave stands for each.
void CachedWave::find_keys(std::size_t part) {
  Part& own = parts_[part];
  own.keys.clear(), own.slot_begin.clear();
  own.counts = {};
  std::size_t total = 0;
  for (const Slot& slot : slots_) {
    if (slot.queries != nullptr) total += slot.part_begin[part + 1] - slot.part_begin[part];
  }
  MissSet seen;
  seen.begin(total);
  for (Slot& slot : slots_) {
    own.slot_begin.push_back(own.keys.size());
    if (slot.queries == nullptr) continue;
    for (std::size_t i = slot.part_begin[part]; i < slot.part_begin[part + 1]; ++i) {
      Miss& miss = slot.misses[i];
      const auto next = static_cast<std::uint32_t>(own.keys.size());
      miss.key = seen.first(miss.index, miss.tag, next);
      if (miss.key == next) {
        own.keys.push_back({miss.query, miss.index, miss.tag});
      } else {
        ++own.counts.cached;
        ++own.counts.answered_at_depth[miss.depth];
      }
    }
  }
  own.slot_begin.push_back(own.keys.size());
}

// Rays of the queries of a slot that stand for a key, in their order: neighbours are traced together.
void CachedWave::trace_slot(std::size_t slot) {
  Slot& own = slots_[slot];
  own.rays = {}, own.counts = {};
  if (own.queries == nullptr) return;
  std::vector<OwnRay> own_rays;
  for (std::uint32_t part = 0; part < kParts; ++part) {
    const Part& p = parts_[part];
    for (std::size_t key = p.slot_begin[slot]; key < p.slot_begin[slot + 1]; ++key)
      own_rays.push_back({p.keys[key].query, part, static_cast<std::uint32_t>(key)});
  }
  for (const std::uint32_t query : own.keyless) own_rays.push_back({query, kParts, 0});
  std::sort(own_rays.begin(), own_rays.end(), [](const OwnRay& a, const OwnRay& b) { return a.query < b.query; });

  QueryTracer tracer(*core_->world);
  std::vector<std::uint32_t> which;
  for (std::size_t first = 0; first < own_rays.size(); first += kChunk) {
    const std::span some = std::span(own_rays).subspan(first, std::min(kChunk, own_rays.size() - first));
    which.clear();
    for (const OwnRay& ray : some) which.push_back(ray.query);
    const std::span<const std::uint8_t> occluded = tracer.trace(*own.queries, which, own.rays, own.counts);
    for (std::size_t k = 0; k < some.size(); ++k) {
      const bool visible = !occluded[k];
      own.weights[some[k].query] = visible ? 1.f : 0.f;
      if (some[k].part < kParts) parts_[some[k].part].keys[some[k].key].visible = visible;
      if (core_->settings.residual > 0) own.mark[some[k].query] = kMarkTraced;
    }
  }
  if (core_->settings.residual > 0) trace_residual(own, tracer);
}

void CachedWave::trace_residual(Slot& own, QueryTracer& tracer) const {
  const QueryBatch& queries = *own.queries;
  const ResidualChoice choice(core_->settings, core_->pass);
  std::vector<std::uint32_t> which;
  for (std::uint32_t i = 0; i < queries.size; ++i) {
    if (queries.light_of[i] == kNoQuery || own.mark[i] == kMarkTraced) continue;
    const float p = choice.probability(own.mark[i] == kMarkEdge);
    if (!choice.taken(queries, i, p)) continue;
    which.push_back(i);
    own.corrections.push_back({i, p, false});
  }
  for (std::size_t first = 0; first < which.size(); first += kChunk) {
    const std::size_t count = std::min(kChunk, which.size() - first);
    const std::span<const std::uint8_t> occluded = tracer.trace(queries, std::span(which).subspan(first, count), own.rays, own.counts);
    for (std::size_t k = 0; k < count; ++k) own.corrections[first + k].visible = !occluded[k];
  }
  own.counts.residual += which.size();
}

void CachedWave::resolve(std::size_t slot, std::span<float> weights) {
  Slot& own = slots_[slot];
  std::copy_n(own.weights.data(), own.queries->size, weights.data());
  for (std::size_t part = 0; part < kParts; ++part) {
    for (std::size_t i = own.part_begin[part]; i < own.part_begin[part + 1]; ++i)
      weights[own.misses[i].query] = parts_[part].keys[own.misses[i].key].visible ? 1.f : 0.f;
  }
  for (const Correction& c : own.corrections) {
    float& weight = weights[c.query];
    weight += ((c.visible ? 1.f : 0.f) - weight) / c.probability;
  }
  own.queries = nullptr;  // not part of the next wave unless looked up again
}

}  // namespace sightline
