#include "methods/bidirectional/method.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <vector>

#include "base/parallel/parallel.h"
#include "methods/bidirectional/kernel.h"
#include "methods/bidirectional/settings.h"
#include "methods/bidirectional/vertex_density.h"
#include "methods/tile_loop.h"

namespace sightline {
namespace {

using namespace bidirectional;

PathOptions path_options(const RenderJob& job, const CameraImportance& camera) {
  const auto& settings = job.settings.as<BidirectionalSettings>();
  PathOptions options;
  options.max_bounces = job.max_bounces;
  options.roulette_start = settings.roulette_start;
  options.heuristic.power = settings.heuristic == BidirectionalSettings::Heuristic::power;
  options.light_image = settings.light_image && camera.has_light_image();
  return options;
}

bool wants_guides(const Frame& frame) {
  for (const Aov aov : {Aov::albedo, Aov::normal, Aov::position, Aov::depth, Aov::surface}) {
    if (frame.aovs().has(aov)) return true;
  }
  return false;
}

/// How densely vertices lie, for visibilities that share answers.
struct DensityBake final : Bake {
  explicit DensityBake(VertexDensity d) : density(std::move(d)) {}
  VertexDensity density;
};

/// What the passes of one picture share.
struct Pass {
  explicit Pass(const RenderJob& j, const Context& context)
      : job(j), camera(*j.view), options(path_options(j, camera)), seed(context.seed) {}
  std::unique_ptr<Kernel> kernel(const VertexDensity* density) const {
    return std::make_unique<Kernel>(*job.world, *job.view, camera, options, density, seed);
  }

  const RenderJob& job;
  CameraImportance camera;
  PathOptions options;
  std::uint64_t seed;
};

/// One a thread: arrays too large to be made anew for every tile.
struct Worker {
  std::unique_ptr<Kernel> kernel;
  std::unique_ptr<VisibilityWorker> visibility;
  SampleBatch batch;
  Connections connections;
  AlignedVector<float> weights;
};

// Every query is a ray: tiles depend on nothing but themselves.
void render_tiles(const Pass& pass, SampleRange range, Frame& frame, PassStatistics& statistics, const Context& context) {
  std::vector<Worker> workers(static_cast<std::size_t>(context.thread_count()));
  std::mutex frame_mutex;
  const bool guides = wants_guides(frame);
  for_each_tile(context, frame, range, statistics, [&](const Tile& tile, SampleRange samples, PassStatistics& local) {
    Worker& worker = workers[static_cast<std::size_t>(worker_index()) % workers.size()];
    if (!worker.kernel) {
      worker.kernel = pass.kernel(nullptr);
      worker.visibility = pass.job.visibility->worker();
    }
    worker.visibility->begin(tile.index);
    for (const BatchRange& part : batches_of(tile, samples, Kernel::kBatch)) {
      worker.kernel->trace(part, guides, worker.batch, worker.connections, local);
      worker.weights.resize(std::max(worker.weights.size(), worker.connections.weights_size()));
      for (const ConnectionQueries* queries : {&worker.connections.light_samples, &worker.connections.vertices}) {
        worker.visibility->visible(queries->queries, worker.weights, local.rays, local.visibility);
        queries->add_answers(worker.weights, worker.batch);
      }
      const std::lock_guard lock(frame_mutex);
      commit(worker.batch, pass.camera, frame);
    }
  });
}

}  // namespace

const MethodInfo& BidirectionalMethod::info() const {
  static const MethodInfo info = [] {
    MethodInfo i;
    i.name = "bidirectional";
    i.help = "bidirectional path tracing with all strategies and the light image; connections may go through a visibility cache";
    i.citation = "Veach1997, Lafortune1993, Georgiev2012, Popov2013";
    i.unbiased = i.consistent = i.progressive = i.deterministic = true;
    for (int k = 0; k <= static_cast<int>(LightKind::environment); ++k) i.lights.push_back(static_cast<LightKind>(k));
    for (int k = 0; k <= static_cast<int>(MaterialKind::interface_only); ++k) i.materials.push_back(static_cast<MaterialKind>(k));
    return i;
  }();
  return info;
}

SettingsValue BidirectionalMethod::default_settings() const { return SettingsValue::of<BidirectionalSettings>(); }

std::unique_ptr<const Bake> BidirectionalMethod::prepare(const RenderJob&, const Context&) const { return nullptr; }

void BidirectionalMethod::render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                                      const Context& context) const {
  const Pass pass(job, context);
  if (pass.options.light_image) frame.enable_light_image();
  job.visibility->begin_pass({range.begin, 0}, context);
  render_tiles(pass, range, frame, statistics, context);
}

}  // namespace sightline
