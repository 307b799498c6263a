// Scenes and questions that shadow maps and roulette are tested with.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "unit/trace/trace_scenes.h"
#include "visibility/visibility.h"

namespace sightline::test {

/// One query by itself.
struct Question {
  Vec3 x{0}, x_normal{0};
  Vec3 y{0};
  QuerySemantic semantic = QuerySemantic::point;
  std::uint32_t id = 0;
};

inline QueryBatch batch_of(const std::vector<Question>& questions) {
  QueryBatch batch;
  batch.eye.resize(questions.size());
  batch.resize_lights(questions.size());
  batch.resize_queries(questions.size());
  for (std::uint32_t i = 0; i < questions.size(); ++i) {
    const Question& q = questions[i];
    batch.eye.set(i, q.x, q.x_normal, 1e-6f, 0, q.id);
    batch.light.set(i, q.y, Vec3(0), 0, 0, i);
    batch.semantic[i] = static_cast<std::uint8_t>(q.semantic);
    batch.eye_of[i] = batch.light_of[i] = i;
  }
  return batch;
}

struct Answers {
  std::vector<float> weights;
  VisibilityCounts counts;
  RayCounts rays;
  double mean() const {
    double sum = 0;
    for (const float weight : weights) sum += weight;
    return sum / static_cast<double>(weights.size());
  }
};

inline Answers ask(Visibility& visibility, const std::vector<Question>& questions) {
  Answers answers;
  answers.weights.assign(padded(questions.size()), -1);
  const std::unique_ptr<VisibilityWorker> worker = visibility.worker();
  worker->begin(0);
  worker->visible(batch_of(questions), answers.weights, answers.rays, answers.counts);
  answers.weights.resize(questions.size());
  return answers;
}

inline std::unique_ptr<Visibility> make_visibility(std::string_view name, const std::shared_ptr<const World>& world,
                                                   const std::vector<std::string>& settings = {}) {
  const VisibilityInfo& info = find_visibility(name);
  SettingsValue value = info.settings;
  for (const std::string& setting : settings) value.apply(setting);
  return info.make(world, value, Context());
}

inline Scene with_light(Scene scene, const decltype(Light::shape)& shape) {
  Light light;
  light.shape = shape;
  scene.lights.push_back(light);
  return scene;
}

/// Rectangle of two triangles around `center`.
inline Mesh quad(const Vec3& center, const Vec3& half_u, const Vec3& half_v) {
  return make_mesh({center - half_u - half_v, center + half_u - half_v, center + half_u + half_v, center - half_u + half_v},
                   {{0, 1, 2}, {0, 2, 3}});
}

inline int differences(const std::vector<float>& a, const std::vector<float>& b) {
  int different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) different += a[i] != b[i];
  return different;
}

}  // namespace sightline::test
