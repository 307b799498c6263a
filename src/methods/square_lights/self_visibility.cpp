#include "methods/square_lights/self_visibility.h"

#include <mutex>

#include "base/parallel/parallel.h"
#include "methods/square_lights/disk_rays.h"
#include "world/surface.h"

namespace sightline::square_lights {
namespace {

// Vertices that a worker takes at a time: some ten milliseconds, after which it looks whether it is to stop.
constexpr std::size_t kVertices = 32;

}  // namespace

std::uint64_t self_visibility_bytes(std::size_t vertices) { return vertices * kTableCells + kTableSlack; }

AlignedVector<std::int8_t> bake_self_visibility(const Tracer& tracer, const VertexSpans& vertices, const SelfVisibilityOptions& options,
                                                RayCounts& rays, const Context& context) {
  const std::size_t count = vertices.position.size();
  const DiskGrid grid(options.resolution);
  const DiskRays disk = make_disk_rays(grid, 1, [](const Vec2& p) { return p.x * p.x + p.y * p.y <= 1; });
  AlignedVector<std::int8_t> tables;
  tables.reserve(count * kTableCells + kTableSlack);
  tables.resize(count * kTableCells);

  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(context, count, kVertices, [&](std::size_t begin, std::size_t end) {
    MapTracer map_tracer(tracer, grid.count());
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3& side = vertices.geometric_normal[v];
      const Frame3 frame = vertex_frame(vertices.normal[v], vertices.tangent[v]);
      const Vec3 origin = offset_origin(vertices.position[v], side, vertices.error[v], side);
      const std::span<std::uint8_t> visible = map_tracer.trace(disk, frame, origin, &side, 0);
      fill_outside(grid, options.count_horizon, visible);
      make_distance_table(visible, options.resolution, std::span(tables).subspan(v * kTableCells).first<kTableCells>());
    }
    const std::scoped_lock lock(mutex);
    rays += map_tracer.counts();
    done += end - begin;
    context.report("self-visibility", static_cast<double>(done), static_cast<double>(count));
  });
  return tables;
}

}  // namespace sightline::square_lights
