// Nanoseconds a query of the visibility cache, keys included: a tile of eye points on a floor, all light ends in sight, table warm. Cold:
// each time a new scope, rays included; what it takes more than warm, divided by the clusters, is the price of a miss.
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

struct Case {
  std::uint32_t lights = 64;  ///< a query for each at each eye point
  bool own = false;           ///< each query has a light end of its own: stratified samples of 1 m² or of the sphere; else all share them
  QuerySemantic semantic = QuerySemantic::surface;
  QuerySplit split = QuerySplit::eye;
  enum class Way { warm, cold, wave } way = Way::warm;
  std::vector<std::string> settings;
};

/// A tile of eye points 1 cm apart under lights at a height of 4 m.
QueryBatch tile(const Case& c) {
  const std::uint32_t lights = c.lights;
  const bool own = c.own, sphere = c.semantic == QuerySemantic::solid_angle;
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
    const float radius = std::sqrt(1 - u * u), angle = 2 * kPi * v;
    const Vec3 upwards{radius * std::cos(angle), u, radius * std::sin(angle)};
    batch.light.set(i, sphere ? upwards : Vec3{u, 4, v}, sphere ? Vec3(0) : Vec3{0, -1, 0}, 1e-6f,
                    (sphere ? 2 * kPi : 1.f) / static_cast<float>(lights), i);
    batch.semantic[i] = static_cast<std::uint8_t>(c.semantic);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    batch.eye_of[i] = i / lights;
    batch.light_of[i] = own ? i : i % lights;
  }
  return batch;
}

void look_up(benchmark::State& state, const Case& c) {
  const VisibilityInfo& info = find_visibility("cached");
  SettingsValue value = info.settings;
  for (const std::string& setting : c.settings) value.apply(setting);
  Context context;
  context.threads = 1;
  const std::unique_ptr<Visibility> visibility = info.make(floor_world(), value, context);
  const std::unique_ptr<VisibilityWorker> worker = visibility->worker();
  QueryBatch batch = tile(c);
  batch.split = c.split;
  AlignedVector<float> weights(padded(batch.size));
  RayCounts rays;
  VisibilityCounts counts;
  const std::unique_ptr<VisibilityWave> wave = c.way == Case::Way::wave ? visibility->wave(1) : nullptr;
  std::uint32_t scope = 0;
  const auto ask = [&] {
    if (c.way == Case::Way::cold) worker->begin(++scope);
    if (!wave) return worker->visible(batch, weights, rays, counts);
    wave->look_up(0, batch, rays, counts);
    wave->trace(context, rays, counts);
    wave->resolve(0, weights);
  };
  ask();
  const std::uint64_t traced = counts.traced;
  for (auto _ : state) ask();
  state.counters["query"] =
      benchmark::Counter(static_cast<double>(batch.size), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["clusters"] = static_cast<double>(traced);
}

void add(const std::string& name, const Case& c) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) { look_up(state, c); });
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  using sightline::add;
  using sightline::Case;
  using sightline::QuerySemantic;
  using sightline::QuerySplit;
  for (const std::string refine : {"refine=none", "refine=4"}) {
    for (const bool own : {false, true}) {
      for (const std::uint32_t lights : {1u, 16u, 64u, 256u})
        add(refine + (own ? "/own/" : "/shared/") + std::to_string(lights), {.lights = lights, .own = own, .settings = {refine}});
    }
    add(refine + "/environment/own/64", {.own = true, .semantic = QuerySemantic::solid_angle, .settings = {refine}});
    add(refine + "/points/16", {.lights = 16, .semantic = QuerySemantic::point, .settings = {refine}});
    for (const std::string hash : {"recurrence", "mix64"})
      add(refine + "/shared/256/" + hash, {.lights = 256, .settings = {refine, "hash=" + hash}});
  }
  add("refine=4/shared/256/counters", {.lights = 256, .settings = {"counters=2"}});
  add("refine=64/shared/256", {.lights = 256, .settings = {"refine=64"}});
  add("refine=4/shared/64/cold", {.way = Case::Way::cold});
  add("refine=4/own/64/cold", {.own = true, .way = Case::Way::cold});
  add("connections/own/16", {.lights = 16, .own = true, .split = QuerySplit::symmetric});
  add("connections/own/16/wave", {.lights = 16, .own = true, .split = QuerySplit::symmetric, .way = Case::Way::wave});
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
