// Batches, targets and scenes for tests of the visibility cache, from fixed seeds.
#pragma once

#include <hwy/targets.h>

#include <string>
#include <vector>

#include "base/settings/settings.h"
#include "support/every_target.h"
#include "unit/trace/trace_scenes.h"
#include "visibility/cached/quantizer.h"
#include "visibility/visibility.h"

namespace sightline::test {

inline Bounds cube(float half) {
  Bounds bounds;
  bounds.add(Vec3(-half)), bounds.add(Vec3(half));
  return bounds;
}

inline Vec3 end_position(const QueryEnds& ends, std::size_t i) { return {ends.position.x[i], ends.position.y[i], ends.position.z[i]}; }
inline Vec3 end_normal(const QueryEnds& ends, std::size_t i) { return {ends.normal.x[i], ends.normal.y[i], ends.normal.z[i]}; }

/// Ends of every kind in a cube of half width 1, some with areas that are not known, and random queries between them with gaps.
inline QueryBatch random_batch(std::mt19937& random, std::size_t eyes, std::size_t lights, std::size_t queries) {
  std::uniform_real_distribution<float> exponent(-18, -1);
  const auto any = [&](std::size_t n) { return static_cast<std::uint32_t>(random() % n); };
  const auto area = [&] { return random() % 16 == 0 ? 0.f : std::exp2(exponent(random)); };
  QueryBatch batch;
  batch.eye.resize(eyes);
  batch.resize_lights(lights);
  batch.resize_queries(queries);
  for (std::size_t i = 0; i < eyes; ++i) batch.eye.set(i, random_point(random, 1), random_direction(random), 0, area(), any(1u << 30));
  for (std::size_t i = 0; i < lights; ++i) {
    const auto semantic = static_cast<QuerySemantic>(any(4));
    const bool direction = is_infinite(semantic);
    const Vec3 normal = semantic == QuerySemantic::surface ? random_direction(random) : Vec3(0);
    batch.light.set(i, direction ? random_direction(random) : random_point(random, 1), normal, 0, area(), any(1u << 30));
    batch.semantic[i] = static_cast<std::uint8_t>(semantic);
  }
  for (std::size_t i = 0; i < queries; ++i) {
    batch.eye_of[i] = any(eyes);
    batch.light_of[i] = random() % 20 == 0 ? kNoQuery : any(lights);
  }
  return batch;
}

struct Answers {
  std::vector<float> weights;
  VisibilityCounts counts;
  RayCounts rays;
};

/// A cached or exact visibility over a scene, with settings "key=value".
struct Cache {
  std::shared_ptr<const World> world;
  std::unique_ptr<Visibility> visibility;

  Cache(std::shared_ptr<const World> w, const std::vector<std::string>& settings, const char* name = "cached") : world(std::move(w)) {
    const VisibilityInfo& info = find_visibility(name);
    SettingsValue value = info.settings;
    for (const std::string& setting : settings) value.apply(setting);
    visibility = info.make(world, value, Context());
  }
  Answers ask(VisibilityWorker& worker, const QueryBatch& batch) const {
    Answers answers;
    AlignedVector<float> weights(padded(batch.size), -7);
    worker.visible(batch, weights, answers.rays, answers.counts);
    answers.weights.assign(weights.begin(), weights.begin() + static_cast<std::ptrdiff_t>(batch.size));
    return answers;
  }
  Answers ask(const QueryBatch& batch) const { return ask(*visibility->worker(), batch); }
};

}  // namespace sightline::test
