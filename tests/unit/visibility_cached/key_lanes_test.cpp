// Vector keys, hashes and look-ups against the scalar definitions, bit for bit, on every instruction set of this machine.
#include "visibility/cached/key_lanes.h"

#include <gtest/gtest.h>

#include "cache_cases.h"
#include "visibility/cached/hash.h"
#include "visibility/cached/look_up_lanes.h"
#include "visibility/cached/table.h"

namespace sightline::test {
namespace {

constexpr CacheSalt kLaneSalt{77, 99};

struct Variant {
  const char* name;
  CachedVisibilitySettings settings;
};

std::vector<Variant> variants() {
  std::vector<Variant> result(3, {"default", {}});
  result[1].name = "floor and octahedral";
  result[1].settings.normals = CacheNormals::floored;
  result[1].settings.sphere = CacheSphere::octahedral;
  result[1].settings.eq9_as_printed = true;
  result[2].name = "other constants";
  result[2].settings.directions = 32;
  result[2].settings.flatness = 3;
  result[2].settings.level_ratio = 1.1f;
  return result;
}

EndWords light_words(const Quantizer& q, const QueryBatch& batch, std::size_t i, float shift) {
  return q.light(static_cast<QuerySemantic>(batch.semantic[i]), end_position(batch.light, i), end_normal(batch.light, i),
                 batch.light.cell_area[i], shift);
}

TEST(KeyLanes, KeysAndPartsEqualTheScalarOnes) {
  std::mt19937 random(1);
  QueryBatch batch = random_batch(random, 1003, 1501, 100);
  for (std::size_t i = 100; i < 164; ++i) batch.semantic[i] = 2, batch.eye.set(i, random_point(random, 1), {0, 1, 0}, 0, 1e-4f, 0);
  batch.eye.set(5, {std::nanf(""), 0, 0}, {std::nanf(""), 0, 1}, 0, 1e-4f, 0);
  for (const std::int64_t target : simd_targets()) {
    const PinnedTarget pinned(target);
    for (const Variant& variant : variants()) {
      SCOPED_TRACE(std::string(hwy::TargetName(target)) + ", " + variant.name);
      const Quantizer q(cube(1), variant.settings);
      GridPoints points;
      locate_lanes(q.constants(), batch.eye, points);
      EndKeys words, parts;
      words.resize(batch.eye.size, false), parts.resize(batch.eye.size, true);
      eye_key_lanes(q.constants(), points, 0, batch.eye.size, q.eye_offset(8), false, words);
      eye_key_lanes(q.constants(), points, 0, batch.eye.size, q.eye_offset(8), true, parts);
      for (std::size_t i = 0; i < batch.eye.size; ++i) {
        const GridPoint p = q.locate(end_position(batch.eye, i), end_normal(batch.eye, i), batch.eye.cell_area[i]);
        const EndWords expected = q.eye(p, q.eye_offset(8));
        ASSERT_EQ(points.bins[i], p.bins) << i;
        ASSERT_EQ(words.words(i), expected) << i;
        ASSERT_EQ(parts.part(i), eye_part(expected)) << i;
      }
      for (const float shift : {0.f, 3.8f}) {
        light_key_lanes(q.constants(), batch.light, batch.semantic.data(), shift, {false, kLaneSalt}, words);
        EXPECT_EQ(light_key_lanes(q.constants(), batch.light, batch.semantic.data(), shift, {true, kLaneSalt}, parts), 15u);
        for (std::size_t i = 0; i < batch.light.size; ++i) {
          const EndWords expected = light_words(q, batch, i, shift);
          ASSERT_EQ(words.words(i), expected) << i << " " << int{batch.semantic[i]};
          ASSERT_EQ(parts.part(i), light_part(expected, kLaneSalt)) << i;
        }
      }
    }
  }
}

TEST(KeyLanes, ConnectionsEqualTheScalarOnes) {
  std::mt19937 random(2);
  const QueryBatch batch = random_batch(random, 300, 400, 2005);
  const Quantizer q(cube(1), {});
  for (const std::int64_t target : simd_targets()) {
    const PinnedTarget pinned(target);
    SCOPED_TRACE(hwy::TargetName(target));
    GridPoints eyes, lights;
    EndKeys words, eye, light;
    locate_lanes(q.constants(), batch.eye, eyes);
    locate_lanes(q.constants(), batch.light, lights);
    light_key_lanes(q.constants(), batch.light, batch.semantic.data(), 0, {false, kLaneSalt}, words);
    ConnectionEnds ends{&eyes, &lights, &words, batch.semantic.data(), batch.eye_of.data(), batch.light_of.data(), {}, 0};
    for (float& offset : ends.eye_offset) offset = q.eye_offset(12);
    ends.symmetric_offset = q.symmetric_offset(12);
    connection_key_lanes(q.constants(), ends, batch.size, {false, kLaneSalt}, eye, light);
    for (std::size_t i = 0; i < batch.size; ++i) {
      const std::uint32_t e = batch.eye_of[i], l = batch.light_of[i];
      if (l == kNoQuery) continue;
      const GridPoint p = q.locate(end_position(batch.eye, e), end_normal(batch.eye, e), batch.eye.cell_area[e]);
      const Quantizer::Pair expected = q.connection(p, static_cast<QuerySemantic>(batch.semantic[l]), end_position(batch.light, l),
                                                    end_normal(batch.light, l), batch.light.cell_area[l], 12);
      ASSERT_EQ(eye.words(i), expected.eye) << i;
      ASSERT_EQ(light.words(i), expected.light) << i;
    }
  }
}

/// The look-up of one query as [Popov2013, Alg. 2] has it, on scalars.
struct ScalarLookUp {
  const std::vector<std::uint32_t>& table;
  CacheHash hash;
  SlotFormat format;
  int bits;

  std::uint32_t slot(const EndWords& eye, const EndWords& light, std::uint32_t& tag) const {
    const CacheSlot s = cache_slot(hash, eye, light, kLaneSalt, bits);
    tag = format.tag(s.digest);
    return table[s.index];
  }
  bool differs(const EndWords& eye, const EndWords& light, bool visible) const {
    std::uint32_t tag;
    const std::uint32_t there = slot(eye, light, tag);
    if (!format.matches(there, tag)) return false;
    const std::uint32_t rest = there ^ tag;
    if (!format.counters) return (rest != 0) != visible;
    return visible ? (rest & 7) != 0 : (rest >> 3) != 0;
  }
};

EndWords moved(EndWords w, int dx, int dy) {
  w.x += static_cast<std::uint32_t>(dx), w.y += static_cast<std::uint32_t>(dy);
  return w;
}

TEST(LookUpLanes, AnswersAreThoseOfTheScalarAlgorithm) {
  std::mt19937 random(3);
  constexpr int kFewBits = 12;
  const Quantizer q(cube(1), {});
  // Few cells, so that many queries meet the same ones.
  QueryBatch batch = random_batch(random, 301, 40, 5001);
  for (std::size_t i = 0; i < batch.eye.size; ++i)
    batch.eye.set(i, Vec3(0.2f, 0.2f, 0) * random_point(random, 1), {0, 0, 1}, 0, i % 20 == 0 ? 0 : 1e-4f, 0);
  AlignedVector<float> importance(padded(batch.size));
  for (float& value : importance) value = std::uniform_real_distribution<float>(0, 1)(random);
  for (const std::int64_t target : simd_targets()) {
    const PinnedTarget pinned(target);
    for (const CacheHash hash : {CacheHash::separable, CacheHash::recurrence, CacheHash::mix64}) {
      for (const CacheRefinement refine : {CacheRefinement::none, CacheRefinement::four, CacheRefinement::sixty_four}) {
        for (const std::uint32_t rays_a_cell : {0u, 1u, 2u}) {
          SCOPED_TRACE(std::string(hwy::TargetName(target)) + " hash " + std::to_string(int(hash)) + " refine " +
                       std::to_string(int(refine)) + " rays " + std::to_string(rays_a_cell));
          const bool parts = hash == CacheHash::separable && refine != CacheRefinement::sixty_four;
          const SlotFormat format{rays_a_cell > 0};
          GridPoints points;
          EndKeys eye, light;
          locate_lanes(q.constants(), batch.eye, points);
          eye.resize(batch.eye.size, parts);
          eye_key_lanes(q.constants(), points, 0, batch.eye.size, q.eye_offset(8), parts, eye);
          light_key_lanes(q.constants(), batch.light, batch.semantic.data(), 0, {parts, kLaneSalt}, light);

          std::vector<std::uint32_t> table(1 << kFewBits);
          const ScalarLookUp scalar{table, hash, format, kFewBits};
          const auto words_of = [&](std::size_t i) {
            const std::uint32_t e = batch.eye_of[i];
            const GridPoint p = q.locate(end_position(batch.eye, e), end_normal(batch.eye, e), batch.eye.cell_area[e]);
            return std::pair{q.eye(p, q.eye_offset(8)), light_words(q, batch, batch.light_of[i], 0)};
          };
          // Two of three keys are in the table, with answers of no order.
          for (std::size_t i = 0; i < batch.size; ++i) {
            if (batch.light_of[i] == kNoQuery || i % 3 == 0) continue;
            const auto [e, l] = words_of(i);
            const CacheSlot s = cache_slot(hash, e, l, kLaneSalt, kFewBits);
            table[s.index] = format.after(table[s.index], format.tag(s.digest), random() % 5 != 0);
          }

          LookUp look_up;
          look_up.eye = batch.eye_of.data(), look_up.light = batch.light_of.data();
          look_up.count = batch.size;
          look_up.eye_keys = &eye, look_up.light_keys = &light;
          look_up.table = table.data(), look_up.table_bits = kFewBits;
          look_up.salt = kLaneSalt, look_up.hash = hash;
          look_up.neighbours = refine, look_up.last_level = refine == CacheRefinement::none;
          look_up.counters = format.counters, look_up.rays_a_cell = rays_a_cell;
          look_up.importance = importance.data(), look_up.most_important = 0.9f;
          AlignedVector<float> weights(padded(batch.size), -1);
          LookUpResult result;
          look_up_lanes(look_up, weights.data(), result);

          std::size_t misses = 0, refines = 0, exacts = 0, answered = 0, rejected = 0;
          for (std::uint32_t i = 0; i < batch.size; ++i) {
            if (batch.light_of[i] == kNoQuery) {
              ASSERT_EQ(weights[i], 0);
              continue;
            }
            const auto [e, l] = words_of(i);
            if (e.unknown() || l.unknown() || importance[i] > 0.9f) {
              ASSERT_EQ(result.exact_id[exacts++], i);
              continue;
            }
            std::uint32_t tag;
            const std::uint32_t slot = scalar.slot(e, l, tag), rest = slot ^ tag;
            const std::uint32_t seen = (rest >> 3) & 7, hidden = rest & 7;
            const bool mixed = format.counters && seen > 0 && hidden > 0;
            const auto expect_miss = [&] {
              ASSERT_EQ(result.miss_index[misses], cache_slot(hash, e, l, kLaneSalt, kFewBits).index);
              ASSERT_EQ(result.miss_tag[misses], tag);
              ASSERT_EQ(result.miss_id[misses++], i);
            };
            if (!format.matches(slot, tag)) {
              rejected += slot != 0;
              expect_miss();
              continue;
            }
            const bool visible = format.counters ? seen >= hidden : (rest & 1) != 0;
            bool differs = refine != CacheRefinement::none && mixed;
            if (refine == CacheRefinement::four) {
              for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {-1, 0}, {0, -1}})
                differs |= scalar.differs(moved(e, dx, dy), l, visible);
            }
            if (refine == CacheRefinement::sixty_four) {
              const bool cells = l.semantic() >= 2;
              for (int a = 0; a < 9; ++a) {
                for (int b = 0; b < 9; ++b) {
                  if (a == 4 || (cells && b == 4)) continue;
                  differs |= scalar.differs(moved(e, a % 3 - 1, a / 3 - 1), cells ? moved(l, b % 3 - 1, b / 3 - 1) : l, visible);
                }
              }
            }
            if (differs) {
              ASSERT_EQ(result.refine_id[refines++], i);
              continue;
            }
            if (refine != CacheRefinement::none && format.counters && seen + hidden < rays_a_cell) {
              expect_miss();
              continue;
            }
            ++answered;
            ASSERT_EQ(weights[i], visible ? 1 : 0) << i;
          }
          EXPECT_EQ(result.misses, misses);
          EXPECT_EQ(result.refines, refines);
          EXPECT_EQ(result.exacts, exacts);
          EXPECT_EQ(result.answered, answered);
          EXPECT_EQ(result.rejected, rejected);
          EXPECT_GT(misses, 100u);
          EXPECT_GT(answered, 100u);
          EXPECT_TRUE(refine == CacheRefinement::none || refines > 100);
        }
      }
    }
  }
}

}  // namespace
}  // namespace sightline::test
