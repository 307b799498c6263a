#include "methods/fragments/picture.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "base/core/huge_pages.h"
#include "base/core/stopwatch.h"
#include "base/math/vec3_batch.h"
#include "base/parallel/parallel.h"
#include "methods/fragments/smooth.h"
#include "methods/fragments/upsample.h"

namespace sightline {
namespace {

// More lights than this are folded into groups.
constexpr std::size_t kLights = 16;

void count_refinement(const RefinementCounts& before, const RefinementCounts& after, PassStatistics& statistics) {
  const auto count = [&](const char* name, std::uint64_t RefinementCounts::* member) {
    statistics.method_statistics[name] += static_cast<double>(after.*member) - static_cast<double>(before.*member);
  };
  count("fragments", &RefinementCounts::fragments), count("level0_fragments", &RefinementCounts::finest);
  count("test_rays", &RefinementCounts::test_rays), count("confirmation_rays", &RefinementCounts::confirm_rays);
  count("level0_rays", &RefinementCounts::finest_rays), count("penumbra_rays", &RefinementCounts::penumbra_rays);
  if (after.kept_fragments > before.kept_fragments) count("kept_fragments", &RefinementCounts::kept_fragments);
  if (after.kept_pixels > before.kept_pixels) count("kept_pixels", &RefinementCounts::kept_pixels);
  count("extra_rays", &RefinementCounts::extra_rays), count("extra_samples", &RefinementCounts::extra_samples);
}

}  // namespace

FragmentPicture::FragmentPicture(const RenderJob& job, const View& view, const FragmentsSettings& settings, const Context& context,
                                 PictureBuffers&& buffers)
    : job_(job),
      view_(view),
      context_(context),
      settings_(settings),
      options_(resolve(settings)),
      buffers_(std::move(buffers)),
      map_(settings.show) {
  const World& world = *job.world;
  if (job.light_samples > 0) {
    options_.finest.rays = options_.finest.smooth_rays = options_.finest.crowded_rays =
        static_cast<std::uint32_t>(std::max(job.light_samples, 16));
    options_.rays_by_size = false;
  }
  if (options_.refine != FragmentOptions::Refine::all) lights_ = area_lights(world.lights(), kLights);
  const bool neighbours = options_.refine == FragmentOptions::Refine::neighbours;
  const auto rays = neighbours ? NicholsRefiner::kRays : static_cast<std::uint32_t>(options_.split.rays);
  for (const AreaLight& light : lights_) {
    const PointJitter jitter = neighbours ? PointJitter::hash : options_.jitter;
    points_.push_back(light_points(world.lights(), light, rays, context.seed, jitter));
  }
  allocate();
  begin_history();
  fragments_.resize(g_.root_count()), progress_.resize(g_.root_count());
  const auto threads = static_cast<std::size_t>(context.thread_count());
  cameras_.resize(threads), refiners_.resize(threads), pyramids_.resize(threads), composers_.resize(threads);
  for (Composer& composer : composers_) composer.set_glossy_term(options_.glossy);
}

// The first touch of a picture's arrays takes as long as some of the stages: threads share it.
void FragmentPicture::allocate() {
  g_.set_size(view_.width(), view_.height());
  const std::size_t n = g_.padded_count();
  std::vector<AlignedVector<float>*> arrays = g_.arrays();
  for (AlignedVector<float>* more : {&radiance_.x, &radiance_.y, &radiance_.z, &pixels_[0]}) arrays.push_back(more);
  if (options_.smooth) arrays.push_back(&smoothed_);
  if (options_.ratio && !lights_.empty()) arrays.insert(arrays.end(), {&signal_.value[0], &signal_.extra[0]});
  parallel_for(context_, arrays.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) reserve_in_large_pages(*arrays[i], n), arrays[i]->resize(n);
  });
  for (auto* bytes : {&g_.back, &g_.flat}) reserve_in_large_pages(*bytes, n), bytes->resize(n);
  reserve_in_large_pages(g_.kind, n), g_.kind.resize(n);
  g_.glossy_index.resize(n);
}

// What the last picture knew is this one's as long as neither light, nor geometry, nor what is asked for has changed.
void FragmentPicture::begin_history() {
  signal_.rays.clear();
  if (!options_.temporal) {
    buffers_.last = {}, buffers_.next = {};
    return;
  }
  PictureHistory &last = buffers_.last, &next = buffers_.next;
  next.identity = {job_.world->shadows(), settings_, context_.seed, job_.light_samples, view_.width(), view_.height()};
  next.identity.settings.show = FragmentsSettings::Show::picture;
  next.projection = PictureProjection(view_.pinhole());
  const bool same = last.identity == next.identity;
  next.pictures = same ? last.pictures + 1 : 0;
  next.resize(g_, lights_.size());
  signal_.rays.resize(g_.element_count());
  for (std::size_t l = 0; same && l < lights_.size(); ++l) priors_.emplace_back(last, l);
}

// Runs body(tile, thread, statistics) over `count` tiles, and adds up what they counted and how long they took.
template <class Body>
void FragmentPicture::for_tiles(const char* stage, std::size_t count, PassStatistics& statistics, Body body) {
  std::mutex mutex;
  parallel_for(context_, count, 1, [&](std::size_t begin, std::size_t end) {
    const Stopwatch stopwatch;
    PassStatistics local;
    for (std::size_t tile = begin; tile < end; ++tile) body(tile, static_cast<std::size_t>(worker_index()) % cameras_.size(), local);
    local.stage_seconds[stage] += stopwatch.seconds();
    const std::lock_guard lock(mutex);
    statistics += local;
    steps_done_ = std::min(steps_done_ + static_cast<double>(end - begin), steps_);
    context_.report("render", steps_done_, steps_);
  });
}
template <class Body>
void FragmentPicture::for_roots(const char* stage, PassStatistics& statistics, Body body) {
  for_tiles(stage, g_.root_count(), statistics, body);
}

void FragmentPicture::expect(std::uint32_t samples) {
  const std::size_t stages = 2 + (lights_.empty() ? 0 : 1) +
                             lights_.size() * ((options_.smooth ? 4u : 3u) + 2u * static_cast<std::size_t>(options_.border_rounds));
  steps_ = static_cast<double>(samples) * static_cast<double>(stages * g_.root_count()), steps_done_ = 0;
}

void FragmentPicture::render(std::uint32_t sample, Frame& frame, PassStatistics& statistics) {
  const bool analytic = options_.ratio && std::ranges::all_of(lights_, [](const AreaLight& light) { return light.analytic; });
  const CameraPass::Sampling sampling = options_.refine == FragmentOptions::Refine::all ? CameraPass::Sampling::all
                                        : analytic                                      ? CameraPass::Sampling::general
                                                                                        : CameraPass::Sampling::glossy;
  for_roots("primary rays", statistics, [&](std::size_t root, std::size_t thread, PassStatistics& local) {
    std::unique_ptr<CameraPass>& camera = cameras_[thread];
    if (!camera)
      camera = std::make_unique<CameraPass>(*job_.world, view_, context_.seed, static_cast<int>(options_.finest.rays), sampling,
                                            job_.visibility);
    camera->render(root, sample, g_, radiance_, local);
  });
  if (settings_.show != FragmentsSettings::Show::picture) map_.begin(g_);
  if (!lights_.empty()) {
    for_roots("geometry", statistics, [&](std::size_t root, std::size_t thread, PassStatistics&) {
      fragments_[root].clear();
      pyramids_[thread].build(g_, g_.root(root), options_.geometry, g_.flat.data());
      if (map_.wants_curvature()) map_.set_geometry(g_, g_.root(root), pyramids_[thread], options_.geometry);
      pyramids_[thread].refine(g_, g_.root(root), options_.geometry, fragments_[root]);
    });
  }
  if (options_.edge_samples > 1) trace_edges(sample, sampling, statistics);
  // Light points of the last picture would tell nothing new of the same places.
  const std::uint32_t points = sample + (options_.temporal ? buffers_.next.pictures : 0);
  for (std::size_t l = 0; l < lights_.size(); ++l) {
    for (std::unique_ptr<Refiner>& r : refiners_) {
      if (!r) {
        r = std::make_unique<Refiner>(*job_.world, view_, *job_.visibility, options_, context_.seed);
        if (map_.watches_tests()) r->watch(map_);
      }
      r->set_light(lights_[l], points_[l], priors_.empty() ? nullptr : &priors_[l]);
    }
    render_light(lights_[l], points, statistics);
  }
  if (edges_) {
    for_roots("edges", statistics, [&](std::size_t root, std::size_t, PassStatistics&) { edges_->average(root, radiance_); });
  }
  write(sample, frame, statistics);
  if (options_.temporal) std::swap(buffers_.last, buffers_.next);
}

void FragmentPicture::trace_edges(std::uint32_t sample, CameraPass::Sampling sampling, PassStatistics& statistics) {
  if (!edges_) edges_ = std::make_unique<EdgePass>(job_, view_, options_, context_, sampling);
  edges_->begin(g_);
  for_roots("edges", statistics, [&](std::size_t root, std::size_t, PassStatistics&) { edges_->find(g_, root); });
  edges_->gather();
  for_tiles("edges", edges_->tile_count(), statistics,
            [&](std::size_t tile, std::size_t thread, PassStatistics& local) { edges_->trace(g_, tile, sample, thread, local); });
}

void FragmentPicture::render_light(const AreaLight& light, std::uint32_t sample, PassStatistics& statistics) {
  signal_.resize(g_, options_.ratio && light.analytic ? 1 : 3);
  if (options_.refine == FragmentOptions::Refine::neighbours) {
    if (!nichols_) {
      nichols_ = std::make_unique<NicholsRefiner>(view_, *job_.visibility, options_, context_);
      if (map_.watches_tests()) nichols_->watch(map_);
    }
    const LightPoints& points = points_[static_cast<std::size_t>(&light - lights_.data())];
    count_refinement({}, nichols_->refine(g_, fragments_, light, points, refiners_, signal_, statistics), statistics);
    return upsample_light(light, sample, statistics);
  }
  for_roots("visibility", statistics, [&](std::size_t root, std::size_t thread, PassStatistics& local) {
    Refiner& refiner = *refiners_[thread];
    const RefinementCounts before = refiner.counts();
    refiner.refine(g_, root, fragments_[root], sample, signal_, progress_[root], local);
    count_refinement(before, refiner.counts(), local);
  });
  refine_borders(sample, statistics);
  upsample_light(light, sample, statistics);
}

// Tiles look at each other's signals between the rounds, and never while they are written.
void FragmentPicture::refine_borders(std::uint32_t sample, PassStatistics& statistics) {
  const double expected = steps_done_ + 2.0 * options_.border_rounds * static_cast<double>(g_.root_count());
  for (int round = 1; round <= options_.border_rounds && signal_.channels == 1; ++round) {
    const auto in_turn = [&](auto step) {
      for_roots("visibility", statistics, [&](std::size_t root, std::size_t thread, PassStatistics& local) {
        Refiner& refiner = *refiners_[thread];
        const RefinementCounts before = refiner.counts();
        step(refiner, root, local);
        count_refinement(before, refiner.counts(), local);
      });
    };
    in_turn([&](Refiner& refiner, std::size_t root, PassStatistics&) { refiner.find_borders(g_, signal_, round, progress_[root]); });
    if (std::ranges::all_of(progress_, [](const TileProgress& p) { return p.children.empty(); })) break;
    in_turn([&](Refiner& refiner, std::size_t root, PassStatistics& local) {
      refiner.refine_borders(g_, root, sample, round, signal_, progress_[root], local);
    });
  }
  steps_done_ = expected;  // rounds that were not needed
}

void FragmentPicture::upsample_light(const AreaLight& light, std::uint32_t sample, PassStatistics& statistics) {
  const auto channels = static_cast<std::size_t>(signal_.channels);
  for (std::size_t c = 0; c < channels; ++c) reserve_in_large_pages(pixels_[c], g_.kind.size()), pixels_[c].resize(g_.kind.size());
  for_roots("upsampling", statistics, [&](std::size_t root, std::size_t, PassStatistics&) {
    alignas(kCacheLine) thread_local std::array<std::array<float, kRootSize * kRootSize>, 3> buffer;
    const std::array<float*, 3> out = {buffer[0].data(), buffer[1].data(), buffer[2].data()};
    const RootTile tile = g_.root(root);
    upsample(g_, signal_, options_.upsample, tile, std::span<float* const>(out.data(), channels));
    for (std::size_t c = 0; c < channels; ++c) {
      for (int y = tile.y0; y < tile.y1; ++y)
        std::copy_n(out[c] + (y - tile.y0) * kRootSize, tile.x1 - tile.x0, pixels_[c].data() + g_.at(tile.x0, y));
    }
  });
  const bool smoothed = options_.smooth && channels == 1;
  if (smoothed) {
    reserve_in_large_pages(smoothed_, g_.kind.size());
    smoothed_.resize(g_.kind.size());
    for_roots("smoothing", statistics,
              [&](std::size_t root, std::size_t, PassStatistics&) { smooth(g_, pixels_[0], signal_.level, g_.root(root), smoothed_); });
  }
  const std::array<const float*, 3> all = {smoothed ? smoothed_.data() : pixels_[0].data(), pixels_[1].data(), pixels_[2].data()};
  const std::span<const float* const> pixels(all.data(), channels);
  for_roots("shading", statistics, [&](std::size_t root, std::size_t thread, PassStatistics&) {
    composers_[thread].add(g_, g_.root(root), light, pixels, radiance_);
  });
  if (options_.temporal) {
    const auto index = static_cast<std::size_t>(&light - lights_.data());
    for_roots("history", statistics, [&](std::size_t root, std::size_t, PassStatistics&) {
      if (index == 0) buffers_.next.keep_surfaces(g_, g_.root(root));
      buffers_.next.keep_shares(g_, g_.root(root), index, signal_, pixels_[0]);
    });
  }
  if (!edges_) return;
  for_tiles("edges", edges_->tile_count(), statistics, [&](std::size_t tile, std::size_t thread, PassStatistics& local) {
    edges_->light(g_, {light, signal_, pixels}, tile, sample, thread, local);
  });
}

// Tiles of the frame that have the sample already (after a resume) are left alone.
void FragmentPicture::write(std::uint32_t sample, Frame& frame, PassStatistics& statistics) {
  static_assert(kRootSize % Frame::kTileSize == 0);
  for_roots("film", statistics, [&](std::size_t root, std::size_t, PassStatistics&) {
    const RootTile area = g_.root(root);
    const int columns = (g_.width + Frame::kTileSize - 1) / Frame::kTileSize;
    for (int y = area.y0; y < area.y1; y += Frame::kTileSize) {
      for (int x = area.x0; x < area.x1; x += Frame::kTileSize) {
        const auto row = static_cast<std::size_t>(y / Frame::kTileSize), column = static_cast<std::size_t>(x / Frame::kTileSize);
        const std::size_t index = row * static_cast<std::size_t>(columns) + column;
        if (frame.first_sample() + frame.samples_done(index) > sample) continue;
        write_tile(frame.tile(index), sample, frame);
        frame.set_samples_done(index, sample + 1 - frame.first_sample());
      }
    }
  });
}

void FragmentPicture::write_tile(const Tile& tile, std::uint32_t sample, Frame& frame) const {
  using Show = FragmentsSettings::Show;
  const bool layers = frame.aovs().bits() != AovSet().bits();
  alignas(kCacheLine) std::array<std::uint32_t, kLanes> pixel;
  std::array<std::uint8_t, kLanes> inside;
  alignas(kCacheLine) std::array<std::array<float, kLanes>, 3> map;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += static_cast<int>(kLanes)) {
      const std::size_t at = g_.at(x, y);
      for (std::size_t i = 0; i < kLanes; ++i) {
        const int px = x + static_cast<int>(i);
        inside[i] = px < tile.x1;
        pixel[i] = static_cast<std::uint32_t>(y * g_.width + std::min(px, tile.x1 - 1));
        if (layers && inside[i]) write_layers(at + i, pixel[i], frame);
      }
      PixelBlock block{pixel.data(), inside.data(), sample, 1, {radiance_.x.data() + at, radiance_.y.data() + at, radiance_.z.data() + at}};
      if (settings_.show != Show::picture) {
        for (int c = 0; c < 3; ++c) {
          std::array<float, kLanes>& values = map[static_cast<std::size_t>(c)];
          for (std::size_t i = 0; i < kLanes; ++i) values[i] = map_value(at + i, c);
          block.channel[static_cast<std::size_t>(c)] = values.data();
        }
      }
      frame.add(Aov::direct, block);
      frame.add_color(block);
    }
  }
}

// Levels and the signal are those of the last light; rays are summed over all of them.
float FragmentPicture::map_value(std::size_t at, int channel) const {
  using Show = FragmentsSettings::Show;
  const bool last_light = settings_.show == Show::levels || settings_.show == Show::signal;
  if (!last_light) return channel == 0 ? map_.first(at) : channel == 1 ? map_.second(at) : map_.third(at);
  if (lights_.empty()) return 0;
  if (settings_.show == Show::levels) return static_cast<float>(signal_.level[at]) / kRootLevel;
  return pixels_[signal_.channels == 1 ? 0u : static_cast<std::size_t>(channel)][at];
}

void FragmentPicture::write_layers(std::size_t at, std::uint32_t pixel, Frame& frame) const {
  if (g_.kind[at] == PixelKind::background) return;
  frame.add(Aov::albedo, pixel, load(g_.albedo, at));
  frame.add(Aov::normal, pixel, (g_.back[at] ? -1.f : 1.f) * load(g_.shading_normal, at));
  frame.add(Aov::position, pixel, load(g_.position, at));
  frame.add(Aov::depth, pixel, Vec3(g_.depth[at]));
  frame.add(Aov::surface, pixel, g_.kind[at] == PixelKind::emitter ? Vec3(0, 1, 0) : Vec3(1, 0, 0));
  frame.add(Aov::alpha, pixel, Vec3(1));
}

}  // namespace sightline
