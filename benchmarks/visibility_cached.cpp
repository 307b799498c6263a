// Nanoseconds a query of the visibility cache, keys included: a tile of eye points on a floor, all light ends in sight, table warm.
//
//   taskset -c 1 visibility_cached [--benchmark_filter=...]
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "base/settings/settings.h"
#include "visibility/visibility.h"

namespace sightline {
namespace {

constexpr std::uint32_t kEdge = 32, kEyes = kEdge * kEdge;

std::shared_ptr<const World> floor_world() {
  Scene scene;
  Mesh mesh;
  mesh.positions = std::vector<Vec3>{{-5, 0, -5}, {5, 0, -5}, {5, 0, 5}, {-5, 0, 5}, {-5, 5, -5}, {-5, 5, -4.9f}, {-4.9f, 5, -5}};
  mesh.triangles = std::vector<UVec3>{{0, 2, 1}, {0, 3, 2}, {4, 5, 6}};
  for (const Vec3& p : mesh.positions) mesh.bounds.add(p);
  scene.meshes.push_back(mesh);
  Instance instance;
  instance.mesh = MeshId(0);
  scene.instances.push_back(instance);
  return World::build(std::move(scene), {}, Context());
}

/// A tile of eye points 1 cm apart under lights at a height of 4 m. `own`: each query has a light end of its own on an area light of
/// 1 m², as stratified samples; else all eye points share `lights` virtual point lights.
QueryBatch tile(std::uint32_t lights, bool own) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  QueryBatch batch;
  const std::uint32_t count = kEyes * lights, ends = own ? count : lights;
  batch.eye.resize(kEyes);
  batch.resize_lights(ends);
  batch.resize_queries(count);
  for (std::uint32_t i = 0; i < kEyes; ++i) {
    const Vec3 p{0.01f * static_cast<float>(i % kEdge), 0, 0.01f * static_cast<float>(i / kEdge)};
    batch.eye.set(i, p, {0, 1, 0}, 1e-6f, 1e-4f, i);
  }
  const auto strata = static_cast<std::uint32_t>(std::lround(std::sqrt(lights)));
  for (std::uint32_t i = 0; i < ends; ++i) {
    const float u = (static_cast<float>(i % strata) + uniform(random)) / static_cast<float>(strata);
    const float v = (static_cast<float>(i / strata % strata) + uniform(random)) / static_cast<float>(strata);
    batch.light.set(i, {u, 4, v}, {0, -1, 0}, 1e-6f, 1.f / static_cast<float>(lights), i);
    batch.semantic[i] = static_cast<std::uint8_t>(QuerySemantic::surface);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    batch.eye_of[i] = i / lights;
    batch.light_of[i] = own ? i : i % lights;
  }
  return batch;
}

void look_up(benchmark::State& state, std::uint32_t lights, bool own, const std::vector<std::string>& settings) {
  const VisibilityInfo& info = find_visibility("cached");
  SettingsValue value = info.settings;
  for (const std::string& setting : settings) value.apply(setting);
  const std::unique_ptr<Visibility> visibility = info.make(floor_world(), value, Context());
  const std::unique_ptr<VisibilityWorker> worker = visibility->worker();
  const QueryBatch batch = tile(lights, own);
  AlignedVector<float> weights(padded(batch.size));
  RayCounts rays;
  VisibilityCounts counts;
  worker->visible(batch, weights, rays, counts);
  const std::uint64_t traced = counts.traced;
  for (auto _ : state) worker->visible(batch, weights, rays, counts);
  state.counters["ns/query"] = benchmark::Counter(static_cast<double>(batch.size) * 1e-9,
                                                  benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["clusters"] = static_cast<double>(traced);
}

void add(const std::string& name, std::uint32_t lights, bool own, const std::vector<std::string>& settings) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) { look_up(state, lights, own, settings); });
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  using sightline::add;
  for (const std::string refine : {"refine=none", "refine=4"}) {
    for (const bool own : {false, true}) {
      for (const std::uint32_t lights : {1u, 16u, 64u, 256u})
        add(refine + (own ? "/own/" : "/shared/") + std::to_string(lights), lights, own, {refine});
    }
    for (const std::string hash : {"recurrence", "mix64"}) add(refine + "/shared/256/" + hash, 256, false, {refine, "hash=" + hash});
  }
  add("refine=4/shared/256/counters", 256, false, {"refine=4", "counters=2"});
  add("refine=64/shared/256", 256, false, {"refine=64"});
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
