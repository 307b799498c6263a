#include "visibility/cached/look_up_lanes.h"

#include "visibility/query_batch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "visibility/cached/look_up_lanes.cpp"
#include "base/simd/targets.h"

#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "base/simd/compress-inl.h"
#include "visibility/cached/hash-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

using DF = hn::RebindToFloat<DU>;
using DI = hn::RebindToSigned<DU>;

HWY_INLINE VU gather(DU d, const std::uint32_t* base, VU index) { return hn::GatherIndex(d, base, hn::BitCast(DI(), index)); }

/// Elements `index` of arrays: one broadcast where all lanes ask for the same, one load where they stand side by side.
struct Picker {
  DU d;
  VU index;
  std::uint32_t first;
  bool same, row;
  HWY_INLINE Picker(DU du, VU i, bool whole, VU lanes_from_0) : d(du), index(i), first(hn::GetLane(i)) {
    same = hn::AllTrue(d, hn::Eq(i, hn::Set(d, first)));
    row = whole && !same && hn::AllTrue(d, hn::Eq(i, hn::Add(lanes_from_0, hn::Set(d, first))));
  }
  HWY_INLINE VU operator()(const std::uint32_t* array) const {
    if (same) return hn::Set(d, array[first]);
    if (row) return hn::LoadU(d, array + first);
    return gather(d, array, index);
  }
};

/// Keys in parts: the neighbour cells mostly lie in the block of 16 slots that is asked for anyway.
struct PartKeys {
  DU d;
  int bits;
  PartV eye, light;
  VU cell;
  SlotV own;

  HWY_INLINE PartKeys(DU du, const LookUp& q, const Picker& e, const Picker& l) : d(du), bits(q.table_bits) {
    eye = {e(q.eye_keys->word[0].data()), e(q.eye_keys->word[1].data())};
    light = {l(q.light_keys->word[0].data()), l(q.light_keys->word[1].data())};
    own = separable_slot(d, eye, light, bits);
  }
  HWY_INLINE MU unknown() const {
    return hn::Ne(hn::And(hn::Xor(eye.b, light.b), hn::Set(d, EndPart::kUnknownEye | EndPart::kUnknownLight)), hn::Zero(d));
  }
  /// Calls take(slot) for the four neighbours.
  template <class Take>
  HWY_INLINE void four(Take&& take) const {
    using H = HashConstants;
    const VU three = hn::Set(d, 3u), one = hn::Set(d, 1u), four_v = hn::Set(d, 4u), twelve = hn::Set(d, 12u);
    const VU column = hn::And(eye.b, three), row = hn::And(eye.b, twelve);
    const MU left = hn::Eq(column, hn::Zero(d)), right = hn::Eq(column, three);
    const MU low = hn::Eq(row, hn::Zero(d)), high = hn::Eq(row, twelve);
    // Only one of two opposite neighbours can lie in another block.
    const VU step_x = hn::IfThenElse(left, hn::Set(d, 0u - H::kStepX), hn::Set(d, H::kStepX));
    const VU step_y = hn::IfThenElse(low, hn::Set(d, 0u - H::kStepY), hn::Set(d, H::kStepY));
    const SlotV x = separable_slot(d, {hn::Add(eye.a, step_x), eye.b}, light, bits);
    const SlotV y = separable_slot(d, {eye.a, hn::Add(eye.b, step_y)}, light, bits);
    const auto pick = [&](MU other, const SlotV& there, VU index_there, VU index_here) -> SlotV {
      return {hn::IfThenElse(other, index_there, index_here), hn::IfThenElse(other, there.digest, own.digest)};
    };
    take(pick(right, x, hn::Sub(x.index, three), hn::Add(own.index, one)));
    take(pick(high, y, hn::Sub(y.index, twelve), hn::Add(own.index, four_v)));
    take(pick(left, x, hn::Add(x.index, three), hn::Sub(own.index, one)));
    take(pick(low, y, hn::Add(y.index, twelve), hn::Sub(own.index, four_v)));
  }
};

/// Keys in words, hashed anew for every neighbour.
template <CacheHash kHash>
struct WordKeys {
  DU d;
  int bits;
  CacheSalt salt;
  WordsV eye, light;
  SlotV own;

  HWY_INLINE WordKeys(DU du, const LookUp& q, const Picker& e, const Picker& l) : d(du), bits(q.table_bits), salt(q.salt) {
    const auto words = [](const Picker& pick, const EndKeys& keys) -> WordsV {
      return {pick(keys.word[0].data()), pick(keys.word[1].data()), pick(keys.word[2].data()), pick(keys.word[3].data())};
    };
    eye = words(e, *q.eye_keys), light = words(l, *q.light_keys);
    own = slot(eye, light);
  }
  HWY_INLINE SlotV slot(const WordsV& e, const WordsV& l) const {
    if constexpr (kHash == CacheHash::separable) return separable_slot(d, eye_part(d, e), light_part(d, l, salt), bits);
    if constexpr (kHash == CacheHash::recurrence) return recurrence_slot(d, e, l, salt, bits);
    return mix64_slot(d, e, l, salt, bits);
  }
  HWY_INLINE MU unknown() const { return hn::Ne(hn::And(hn::Or(eye.packed, light.packed), hn::Set(d, EndWords::kUnknown)), hn::Zero(d)); }
  HWY_INLINE WordsV moved(const WordsV& w, int dx, int dy) const {
    return {w.packed, hn::Add(w.x, hn::Set(d, static_cast<std::uint32_t>(dx))), hn::Add(w.y, hn::Set(d, static_cast<std::uint32_t>(dy))),
            w.z};
  }
  template <class Take>
  HWY_INLINE void four(Take&& take) const {
    take(slot(moved(eye, 1, 0), light)), take(slot(moved(eye, 0, 1), light));
    take(slot(moved(eye, -1, 0), light)), take(slot(moved(eye, 0, -1), light));
  }
  /// The eight cells around X, each with the eight around Y where the light end has cells.
  template <class Take>
  HWY_INLINE void sixty_four(Take&& take) const {
    const MU has_cells = hn::Ne(hn::And(light.packed, hn::Set(d, 2u << EndWords::kSemanticShift)), hn::Zero(d));
    const bool any = !hn::AllFalse(d, has_cells);
    for (int i = 0; i < 9; ++i) {
      if (i == 4) continue;
      const WordsV e = moved(eye, i % 3 - 1, i / 3 - 1);
      for (int j = 0; j < (any ? 9 : 1); ++j) {
        if (any && j == 4) continue;
        WordsV l = moved(light, j % 3 - 1, j / 3 - 1);
        l.x = hn::IfThenElse(has_cells, l.x, light.x), l.y = hn::IfThenElse(has_cells, l.y, light.y);
        take(slot(e, l));
      }
    }
  }
};

/// What a slot says of a key.
struct AnswerV {
  MU same_key, mixed;
  VU visible;  ///< 0 or 1
  VU rays;
};

template <bool kCounters>
struct Format {
  DU d;
  HWY_INLINE VU tag(VU digest) const {
    constexpr std::uint32_t kMask = kCounters ? 63 : 1;
    const VU kept = hn::And(digest, hn::Set(d, ~kMask));
    return hn::IfThenElse(hn::Eq(kept, hn::Zero(d)), hn::Set(d, kMask + 1), kept);
  }
  HWY_INLINE AnswerV read(VU slot, VU tag_value) const {
    const VU rest = hn::Xor(slot, tag_value);
    if constexpr (!kCounters) {
      return {hn::Lt(rest, hn::Set(d, 2u)), hn::Ne(rest, rest), rest, rest};
    } else {
      const VU seven = hn::Set(d, 7u), zero = hn::Zero(d);
      const VU seen = hn::And(hn::ShiftRight<3>(rest), seven), hidden = hn::And(rest, seven);
      const MU mixed = hn::And(hn::Ne(seen, zero), hn::Ne(hidden, zero));
      return {hn::Lt(rest, hn::Set(d, 64u)), mixed, hn::IfThenElse(hn::Lt(seen, hidden), zero, hn::Set(d, 1u)), hn::Add(seen, hidden)};
    }
  }
  /// Lanes where a neighbour holds a ray that answered otherwise.
  HWY_INLINE MU differs(VU slot, VU tag_value, VU visible) const {
    const VU rest = hn::Xor(slot, tag_value);
    if constexpr (!kCounters) {
      return hn::Eq(rest, hn::Xor(visible, hn::Set(d, 1u)));
    } else {
      const VU other = hn::IfThenElse(hn::Eq(visible, hn::Zero(d)), hn::ShiftRight<3>(rest), hn::And(rest, hn::Set(d, 7u)));
      return hn::And(hn::Lt(rest, hn::Set(d, 64u)), hn::Ne(other, hn::Zero(d)));
    }
  }
};

template <class Keys, bool kCounters>
HWY_INLINE void look_up(const LookUp& q, float* HWY_RESTRICT weights, LookUpResult& out) {
  const DU d;
  const DF df;
  const std::size_t lanes = hn::Lanes(d);
  const VU iota = hn::Iota(d, 0);  // once: it is made in memory
  const Format<kCounters> format{d};
  const VU rays_a_cell = hn::Set(d, q.rays_a_cell);
  std::size_t misses = 0, refines = 0, exacts = 0;
  std::uint64_t asked = 0, answered = 0, lookups = 0, rejected = 0;
  for (std::size_t i = 0; i < q.count; i += lanes) {
    const bool whole = i + lanes <= q.count;
    const VU raw_light = hn::LoadU(d, q.light + i);
    const MU valid = hn::And(hn::FirstN(d, q.count - i), hn::Ne(raw_light, hn::Set(d, kNoQuery)));
    const Picker light(d, hn::IfThenElseZero(valid, raw_light), whole, iota);
    const Picker eye(d, hn::IfThenElseZero(valid, hn::LoadU(d, q.eye + i)), whole, iota);
    const VU id = q.id ? hn::LoadU(d, q.id + i) : hn::Add(iota, hn::Set(d, q.first + static_cast<std::uint32_t>(i)));
    const Keys keys(d, q, eye, light);
    MU exact = hn::And(valid, keys.unknown());
    if (q.importance != nullptr) {
      const auto importance = q.id ? hn::GatherIndex(df, q.importance, hn::BitCast(DI(), hn::IfThenElseZero(valid, id)))
                                   : hn::LoadU(df, q.importance + q.first + i);
      const MU above = hn::RebindMask(d, hn::Gt(importance, hn::Set(df, q.most_important)));
      exact = hn::Or(exact, hn::And(valid, above));
    }
    const MU ask = hn::AndNot(exact, valid);
    const VU tag = format.tag(keys.own.digest);
    const VU slot = gather(d, q.table, keys.own.index);
    const AnswerV answer = format.read(slot, tag);
    MU hit = hn::And(ask, answer.same_key);
    MU miss = hn::AndNot(answer.same_key, ask);
    MU refine = hn::AndNot(hit, hit);
    std::uint64_t neighbours = 0;
    if (q.neighbours != CacheRefinement::none && !hn::AllFalse(d, hit)) {
      if constexpr (kCounters) refine = answer.mixed;
      const auto take = [&](const SlotV& there) {
        refine = hn::Or(refine, format.differs(gather(d, q.table, there.index), format.tag(there.digest), answer.visible));
        ++neighbours;
      };
      if constexpr (requires { keys.sixty_four(take); }) {
        if (q.neighbours == CacheRefinement::sixty_four)
          keys.sixty_four(take);
        else
          keys.four(take);
      } else {
        keys.four(take);
      }
      refine = hn::And(refine, hit);
      if constexpr (kCounters) {
        // Nothing contradicts the cell, but too few rays speak for it.
        lookups += hn::CountTrue(d, hit) * neighbours;
        const MU unsure = hn::AndNot(refine, hn::And(hit, hn::Lt(answer.rays, rays_a_cell)));
        miss = hn::Or(miss, unsure), hit = hn::AndNot(unsure, hit);
        neighbours = 0;
      }
    } else if constexpr (kCounters) {
      if (!q.last_level) refine = hn::And(answer.mixed, hit);
    }
    const MU done = hn::AndNot(refine, hit);

    const auto weight = hn::IfThenElseZero(hn::RebindMask(df, done), hn::ConvertTo(df, hn::BitCast(DI(), answer.visible)));
    const std::size_t hits = hn::CountTrue(d, hit);
    asked += hn::CountTrue(d, ask);
    lookups += hits * neighbours;
    answered += hits;
    if (!hn::AllTrue(d, done)) {
      rejected += hn::CountTrue(d, hn::AndNot(answer.same_key, hn::And(miss, hn::Ne(slot, hn::Zero(d)))));
      if (!hn::AllFalse(d, miss)) {
        lanes::compress_store(id, miss, d, out.miss_id.data() + misses);
        lanes::compress_store(keys.own.index, miss, d, out.miss_index.data() + misses);
        misses += lanes::compress_store(tag, miss, d, out.miss_tag.data() + misses);
      }
      if (!hn::AllFalse(d, refine)) {
        const std::size_t count = lanes::compress_store(id, refine, d, out.refine_id.data() + refines);
        refines += count, answered -= count;
      }
      if (!hn::AllFalse(d, exact)) exacts += lanes::compress_store(id, exact, d, out.exact_id.data() + exacts);
    }
    if (!q.id) {
      hn::StoreU(weight, df, weights + q.first + i);
    } else {
      alignas(kCacheLine) float value[kLanes] = {};
      alignas(kCacheLine) std::uint32_t place[kLanes] = {};
      hn::Store(weight, df, value);
      const std::size_t count = lanes::compress_store(id, done, d, place);
      lanes::compress_store(weight, hn::RebindMask(df, done), df, value);
      for (std::size_t k = 0; k < count; ++k) weights[place[k]] = value[k];
    }
  }
  out.misses = misses, out.refines = refines, out.exacts = exacts;
  out.asked = asked, out.answered = answered, out.lookups = asked + lookups, out.rejected = rejected;
}

template <class Keys>
void look_up_format(const LookUp& q, float* weights, LookUpResult& result) {
  if (q.counters)
    look_up<Keys, true>(q, weights, result);
  else
    look_up<Keys, false>(q, weights, result);
}

// Keys in parts need the separable hash and the four neighbours; all else works on words.
bool has_parts(const LookUp& q) { return q.hash == CacheHash::separable && !q.eye_keys->in_words; }

void LookUpLanes(const LookUp& q, float* weights, LookUpResult& result) {
  if (has_parts(q)) return look_up_format<PartKeys>(q, weights, result);
  switch (q.hash) {
    case CacheHash::separable:
      return look_up_format<WordKeys<CacheHash::separable>>(q, weights, result);
    case CacheHash::recurrence:
      return look_up_format<WordKeys<CacheHash::recurrence>>(q, weights, result);
    case CacheHash::mix64:
      return look_up_format<WordKeys<CacheHash::mix64>>(q, weights, result);
  }
}

template <class Keys>
void slots(const LookUp& q, std::uint32_t* HWY_RESTRICT index, std::uint32_t* HWY_RESTRICT digest) {
  const DU d;
  for (std::size_t i = 0; i < q.count; i += hn::Lanes(d)) {
    const MU valid = hn::FirstN(d, q.count - i);
    const bool whole = i + hn::Lanes(d) <= q.count;
    const VU iota = hn::Iota(d, 0);
    const Keys keys(d, q, Picker(d, hn::IfThenElseZero(valid, hn::LoadU(d, q.eye + i)), whole, iota),
                    Picker(d, hn::IfThenElseZero(valid, hn::LoadU(d, q.light + i)), whole, iota));
    hn::StoreU(keys.own.index, d, index + i), hn::StoreU(keys.own.digest, d, digest + i);
  }
}

void SlotLanes(const LookUp& q, std::uint32_t* index, std::uint32_t* digest) {
  if (has_parts(q)) return slots<PartKeys>(q, index, digest);
  if (q.hash == CacheHash::separable) return slots<WordKeys<CacheHash::separable>>(q, index, digest);
  if (q.hash == CacheHash::recurrence) return slots<WordKeys<CacheHash::recurrence>>(q, index, digest);
  slots<WordKeys<CacheHash::mix64>>(q, index, digest);
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
HWY_EXPORT(LookUpLanes);
HWY_EXPORT(SlotLanes);

void look_up_lanes(const LookUp& queries, float* weights, LookUpResult& result) {
  result.reserve(queries.count);
  HWY_DYNAMIC_DISPATCH(LookUpLanes)(queries, weights, result);
}
void slot_lanes(const LookUp& queries, std::uint32_t* index, std::uint32_t* digest) {
  HWY_DYNAMIC_DISPATCH(SlotLanes)(queries, index, digest);
}

}  // namespace sightline
#endif
