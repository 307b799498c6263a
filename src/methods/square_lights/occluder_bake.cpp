// Traces the tables of an occluder field.
#include <mutex>

#include "base/parallel/parallel.h"
#include "methods/square_lights/disk_rays.h"
#include "methods/square_lights/occluder_field.h"

namespace sightline::square_lights {
namespace {

// Tables that a worker makes at a time: some ten milliseconds.
constexpr std::size_t kTables = 32;

/// Directions of a shell's tables that may hit the bounding sphere; within it, those of the whole disk. Those into the solid ball, whose
/// radius is `solid` bounding radii, are not traced: a shell's tables all look at the centre, so that they are the same for each.
DiskRays shell_rays(const DiskGrid& grid, int shell, float zoom, float solid) {
  const float radius = apparent_radius(shell_radius(shell)), inner = solid > 0 ? apparent_radius(shell_radius(shell) / solid) : 0;
  const auto wanted = [&](const Vec2& p) { return glm::dot(p, p) <= radius * radius; };
  const auto hidden = [&](const Vec2& p) { return glm::dot(p, p) < inner * inner; };
  DiskRays rays = make_disk_rays(grid, zoom, [&](const Vec2& p) { return wanted(p) && !hidden(p); });
  for (std::uint32_t i = 0; i < grid.count(); ++i) {
    if (const Vec2 p = zoom * grid.point(i); wanted(p) && hidden(p)) rays.hidden.push_back(i);
  }
  return rays;
}

}  // namespace

std::uint64_t occluder_field_bytes() { return kFieldTables * kTableCells + kTableSlack; }

void bake_occluder_tables(const Tracer& tracer, const Vec3& center, float radius, const OccluderFieldOptions& options, std::size_t first,
                          std::span<std::int8_t> tables, RayCounts& rays, const Context& context) {
  const DiskGrid grid(options.resolution);
  const std::array<float, kShells> zoom = shell_zoom(options);
  std::vector<DiskRays> shells;
  shells.reserve(kShells);
  for (int k = 0; k < kShells; ++k) shells.push_back(shell_rays(grid, k, zoom[k], options.solid / radius));

  const std::size_t count = tables.size() / kTableCells;
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(context, count, kTables, [&](std::size_t begin, std::size_t end) {
    MapTracer map_tracer(tracer, grid.count());
    for (std::size_t i = begin; i < end; ++i) {
      const auto shell = static_cast<int>((first + i) / kShellPoints);
      const Vec3 out = shell_direction(first + i);
      const Vec3 origin = center + shell_radius(shell) * radius * out;
      const std::span<std::uint8_t> visible =
          map_tracer.trace(shells[static_cast<std::size_t>(shell)], frame_from_normal(-out), origin, nullptr, 1);
      // What lies behind is not known. Deviation: where the object may be all around it is as its rim says, as for vertices; the paper's
      // open half would make a boundary where there is none.
      if (shell_radius(shell) <= 1) fill_outside(grid, false, visible);
      make_distance_table(visible, options.resolution, tables.subspan(i * kTableCells).first<kTableCells>());
    }
    const std::scoped_lock lock(mutex);
    rays += map_tracer.counts();
    done += end - begin;
    context.report("occluder field", static_cast<double>(done), static_cast<double>(count));
  });
}

AlignedVector<std::int8_t> bake_occluder_field(const Tracer& tracer, const Vec3& center, float radius, const OccluderFieldOptions& options,
                                               RayCounts& rays, const Context& context) {
  AlignedVector<std::int8_t> tables;
  tables.reserve(occluder_field_bytes());
  tables.resize(kFieldTables * kTableCells);
  bake_occluder_tables(tracer, center, radius, options, 0, tables, rays, context);
  return tables;
}

}  // namespace sightline::square_lights
