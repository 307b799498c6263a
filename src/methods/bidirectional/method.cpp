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
  for (const Aov aov : {Aov::albedo, Aov::normal, Aov::position, Aov::depth, Aov::surface, Aov::alpha}) {
    if (frame.aovs().has(aov)) return true;
  }
  return false;
}

/// How densely vertices lie, for visibilities that share answers.
struct DensityBake final : Bake {
  explicit DensityBake(VertexDensity d) : density(std::move(d)) {}
  VertexDensity density;
};

std::uint32_t samples_a_pass(const RenderJob& job) {
  const auto& settings = job.settings.as<BidirectionalSettings>();
  return std::min(static_cast<std::uint32_t>(settings.pass_spp), std::max(job.total_spp, 1u));
}

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
      for (ConnectionQueries* queries : {&worker.connections.light_samples, &worker.connections.vertices}) {
        worker.visibility->visible(queries->queries, worker.weights, local.rays, local.visibility);
        worker.kernel->add_answers(worker.weights, *queries, worker.batch, local.rays);
      }
      const std::lock_guard lock(frame_mutex);
      commit(worker.batch, pass.camera, frame, samples);
    }
  });
}

/// A batch of a wave, from its subpaths to its sums.
struct WaveBatch {
  BatchRange range;
  SampleBatch batch;
  Connections connections;
  PassStatistics statistics;
};

// Answers are shared by the whole pass: its tiles come in waves of a fixed number, and all queries of a wave are asked together. Tiles that
// a picture resumed from a file has already are rendered again, unless they come last, since others share their answers; for the same
// reason the whole of the pass `range` is rendered where only the samples `wanted` of it are added.
void render_waves(const Pass& pass, const VertexDensity& density, SampleRange range, SampleRange wanted, Frame& frame,
                  PassStatistics& statistics, const Context& context) {
  constexpr std::size_t kPathsPerWave = 32 * 1024;
  const auto lacks = [&](std::size_t tile) { return frame.first_sample() + frame.samples_done(tile) < wanted.end; };
  std::size_t tiles = frame.tile_count();
  while (tiles > 0 && !lacks(tiles - 1)) --tiles;
  if (tiles == 0) return;
  pass.job.visibility->begin_pass({range.begin, 0}, context);
  const bool guides = wants_guides(frame);
  const std::size_t tiles_a_wave =
      std::max<std::size_t>(1, kPathsPerWave / (std::size_t{Frame::kTileSize} * Frame::kTileSize * range.count()));
  std::vector<std::unique_ptr<Kernel>> kernels(static_cast<std::size_t>(context.thread_count()));
  std::vector<AlignedVector<float>> weights(kernels.size());
  std::vector<WaveBatch> batches;
  for (std::size_t first = 0; first < tiles; first += tiles_a_wave) {
    const std::size_t last = std::min(first + tiles_a_wave, tiles);
    std::size_t count = 0;
    for (std::size_t tile = first; tile < last; ++tile) {
      for (const BatchRange& part : batches_of(frame.tile(tile), range, Kernel::kBatch)) {
        if (count == batches.size()) batches.emplace_back();
        batches[count++].range = part;
      }
    }
    const std::unique_ptr<VisibilityWave> wave = pass.job.visibility->wave(2 * count);
    parallel_for(context, count, 1, [&](std::size_t begin, std::size_t end) {
      std::unique_ptr<Kernel>& kernel = kernels[static_cast<std::size_t>(worker_index()) % kernels.size()];
      if (!kernel) kernel = pass.kernel(&density);
      for (std::size_t i = begin; i < end; ++i) {
        WaveBatch& part = batches[i];
        part.statistics = {};
        kernel->trace(part.range, guides, part.batch, part.connections, part.statistics);
        wave->look_up(2 * i, part.connections.light_samples.queries, part.statistics.rays, part.statistics.visibility);
        wave->look_up(2 * i + 1, part.connections.vertices.queries, part.statistics.rays, part.statistics.visibility);
      }
    });
    wave->trace(context, statistics.rays, statistics.visibility);
    parallel_for(context, count, 1, [&](std::size_t begin, std::size_t end) {
      AlignedVector<float>& answers = weights[static_cast<std::size_t>(worker_index()) % weights.size()];
      std::unique_ptr<Kernel>& kernel = kernels[static_cast<std::size_t>(worker_index()) % kernels.size()];
      if (!kernel) kernel = pass.kernel(&density);
      for (std::size_t i = begin; i < end; ++i) {
        WaveBatch& part = batches[i];
        answers.resize(std::max(answers.size(), part.connections.weights_size()));
        wave->resolve(2 * i, answers);
        kernel->add_answers(answers, part.connections.light_samples, part.batch, part.statistics.rays);
        wave->resolve(2 * i + 1, answers);
        kernel->add_answers(answers, part.connections.vertices, part.batch, part.statistics.rays);
      }
    });
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t have = frame.first_sample() + frame.samples_done(batches[i].range.tile.index);
      commit(batches[i].batch, pass.camera, frame, {have, wanted.end});
      statistics += batches[i].statistics;
    }
    for (std::size_t tile = first; tile < last; ++tile) {
      frame.set_samples_done(tile, std::max(frame.samples_done(tile), wanted.end - frame.first_sample()));
      context.report("render", static_cast<double>(tile + 1), static_cast<double>(tiles));
    }
  }
}

// Counts the vertices of the first sample of as many pixels as that takes, spread evenly over the picture.
void count_vertices(const Pass& pass, VertexDensity& density, const Context& context) {
  constexpr std::size_t kPaths = std::size_t{1} << 18;
  const int width = pass.job.view->width(), height = pass.job.view->height();
  const Frame tiles(width, height, {});
  const std::size_t pixels = pass.job.view->pixel_count();
  const std::size_t stride = (pixels + kPaths - 1) / kPaths;
  struct Cells {
    std::vector<std::uint64_t> eye, light;
    std::uint64_t paths = 0;
  };
  std::vector<Cells> cells(tiles.tile_count());
  std::vector<Worker> workers(static_cast<std::size_t>(context.thread_count()));
  parallel_for(context, tiles.tile_count(), 1, [&](std::size_t begin, std::size_t end) {
    Worker& worker = workers[static_cast<std::size_t>(worker_index()) % workers.size()];
    if (!worker.kernel) worker.kernel = pass.kernel(nullptr);
    PassStatistics uncounted;
    for (std::size_t tile = begin; tile < end; ++tile) {
      for (BatchRange range : batches_of(tiles.tile(tile), {0, 1}, stride == 1 ? Kernel::kBatch : kLanes)) {
        if ((range.first_block + tile) % stride != 0) continue;
        worker.kernel->trace_subpaths(range, worker.batch, uncounted.rays);
        for (const PathVertex& vertex : worker.kernel->paths().eye_vertices())
          cells[tile].eye.push_back(density.cell_of(vertex.surface.position));
        for (const PathVertex& vertex : worker.kernel->paths().light_vertices())
          cells[tile].light.push_back(density.cell_of(vertex.surface.position));
        for (std::size_t i = 0; i < worker.batch.count; ++i) cells[tile].paths += worker.batch.in_picture[i];
      }
    }
  });
  Cells all;
  for (const Cells& tile : cells) {
    all.eye.insert(all.eye.end(), tile.eye.begin(), tile.eye.end());
    all.light.insert(all.light.end(), tile.light.begin(), tile.light.end());
    all.paths += tile.paths;
  }
  density.count(all.eye, all.light, all.paths);
}

}  // namespace

const MethodInfo& BidirectionalMethod::info() const {
  static const MethodInfo info = [] {
    MethodInfo i;
    i.name = "bidirectional";
    i.help = "bidirectional path tracing with all strategies and the light image; connections may go through a visibility cache";
    i.citation = "Veach1997, Lafortune1993, Georgiev2012, Popov2013";
    i.unbiased = i.consistent = i.progressive = i.deterministic = true;
    i.lights = all_light_kinds();
    i.materials = all_material_kinds();
    return i;
  }();
  return info;
}

SettingsValue BidirectionalMethod::default_settings() const { return SettingsValue::of<BidirectionalSettings>(); }

std::unique_ptr<const Bake> BidirectionalMethod::prepare(const RenderJob& job, const Context& context) const {
  if (!job.visibility || job.visibility->exact()) return nullptr;
  const auto& settings = job.settings.as<BidirectionalSettings>();
  const bool marginal = settings.density == BidirectionalSettings::Density::marginal;
  VertexDensity density(marginal ? VertexDensity::Kind::marginal : VertexDensity::Kind::conditional, job.world->bounds(),
                        std::uint64_t{job.view->pixel_count()} * samples_a_pass(job));
  if (marginal) count_vertices(Pass(job, context), density, context);
  return std::make_unique<DensityBake>(std::move(density));
}

std::uint32_t BidirectionalMethod::pass_multiple(const RenderJob& job) const {
  return job.visibility && !job.visibility->exact() ? samples_a_pass(job) : 1;
}

bool BidirectionalMethod::light_image(const RenderJob& job) const { return path_options(job, CameraImportance(*job.view)).light_image; }

void BidirectionalMethod::render_pass(const RenderJob& job, SampleRange range, Frame& frame, PassStatistics& statistics,
                                      const Context& context) const {
  const Pass pass(job, context);
  if (pass.options.light_image) frame.enable_light_image();
  if (job.visibility->exact()) {
    job.visibility->begin_pass({range.begin, 0}, context);
    render_tiles(pass, range, frame, statistics, context);
    return;
  }
  // Passes of the visibility lie at absolute multiples of their size, wherever those of the session begin and end.
  const std::unique_ptr<const Bake> own = job.bake ? nullptr : prepare(job, context);
  const auto& bake = dynamic_cast<const DensityBake&>(job.bake ? *job.bake : *own);
  const std::uint32_t size = samples_a_pass(job);
  for (std::uint32_t begin = range.begin; begin < range.end;) {
    const std::uint32_t first = begin / size * size;
    const SampleRange whole{first, std::min(first + size, std::max(job.total_spp, range.end))};
    const SampleRange wanted{begin, std::min(range.end, whole.end)};
    render_waves(pass, bake.density, whole, wanted, frame, statistics, context);
    begin = wanted.end;
  }
}

}  // namespace sightline
