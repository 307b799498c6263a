#include "methods/bidirectional/kernel.h"

#include <array>

namespace sightline::bidirectional {

Kernel::Kernel(const World& world, const View& view, const CameraImportance& camera, const PathOptions& options,
               const VertexDensity* density, std::uint64_t seed)
    : view_(view), paths_(world, view, camera, options), connector_(world, camera, options, density), seed_(seed) {}

void Kernel::trace(const BatchRange& range, bool guides, SampleBatch& batch, Connections& connections, PassStatistics& statistics) {
  start_batch(range, view_.width(), seed_, guides, batch);
  paths_.trace_light_paths(batch, statistics.rays);
  paths_.trace_eye_paths(batch, statistics.rays);
  const std::uint64_t before = statistics.visibility.traced;
  connector_.connect_camera(batch, paths_, statistics.rays, statistics.visibility);
  statistics.method_statistics["light_image_rays"] += static_cast<double>(statistics.visibility.traced - before);
  connector_.connect_light_samples(batch, paths_, connections.light_samples);
  connector_.connect_vertices(batch, paths_, connections.vertices);
  auto& numbers = statistics.method_statistics;
  numbers["eye_vertices"] += static_cast<double>(paths_.eye_vertices().size());
  numbers["light_vertices"] += static_cast<double>(paths_.light_vertices().size());
  numbers["light_sample_queries"] += static_cast<double>(connections.light_samples.queries.size);
  numbers["connection_queries"] += static_cast<double>(connections.vertices.queries.size);
}

void Kernel::add_answers(std::span<const float> weights, ConnectionQueries& queries, SampleBatch& batch, RayCounts& rays) {
  connector_.absorb(weights, queries, rays);
  queries.add_answers(weights, batch);
}

void Kernel::trace_subpaths(const BatchRange& range, SampleBatch& batch, RayCounts& rays) {
  start_batch(range, view_.width(), seed_, false, batch);
  paths_.trace_light_paths(batch, rays);
  paths_.trace_eye_paths(batch, rays);
}

void commit(const SampleBatch& batch, const CameraImportance& camera, Frame& frame, SampleRange wanted) {
  const auto is_wanted = [&](std::uint32_t sample) { return sample >= wanted.begin && sample < wanted.end; };
  for (std::size_t path = 0; path < batch.count; ++path) {
    if (!batch.in_picture[path] || !is_wanted(batch.sample[path])) continue;
    const std::uint32_t pixel = batch.pixel[path];
    frame.add_color(pixel, batch.sample[path], batch.direct[path] + batch.indirect[path]);
    frame.add(Aov::direct, pixel, batch.direct[path]);
    frame.add(Aov::indirect, pixel, batch.indirect[path]);
    if (batch.guides.empty() || !batch.guides[path].hit) continue;
    const Guide& guide = batch.guides[path];
    frame.add(Aov::albedo, pixel, guide.albedo);
    frame.add(Aov::normal, pixel, guide.normal);
    frame.add(Aov::position, pixel, guide.position);
    frame.add(Aov::depth, pixel, Vec3(guide.depth));
    frame.add(Aov::surface, pixel, guide.emits ? Vec3(0, 1, 0) : Vec3(1, 0, 0));
    frame.add(Aov::alpha, pixel, Vec3(1));
  }
  std::array<CameraImportance::Share, CameraImportance::kMaxShares> shares;
  for (const Splat& splat : batch.splats) {
    if (!is_wanted(splat.sample)) continue;
    const int count = camera.shares(splat.film, shares.data());
    for (int i = 0; i < count; ++i) {
      const CameraImportance::Share& share = shares[static_cast<std::size_t>(i)];
      frame.splat(share.pixel, splat.sample, share.weight * splat.value, splat.direct);
    }
  }
}

}  // namespace sightline::bidirectional
