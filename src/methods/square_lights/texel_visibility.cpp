#include "methods/square_lights/texel_visibility.h"

#include <bit>
#include <limits>
#include <mutex>

#include "base/parallel/parallel.h"
#include "world/surface.h"

namespace sightline::square_lights {
namespace {

// Rays of one vertex that go to the tracer together.
constexpr std::size_t kBatch = 4096;

}  // namespace

TexelDirections texel_directions(int size, const Mat3& world_from_environment) {
  TexelDirections result;
  result.texels = static_cast<std::size_t>(kCubeFaces) * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  const std::size_t points = result.texels * kTexelPoints;
  result.direction.resize(points), result.solid_angle.resize(points);
  const int fine = size * kSubTexels;
  std::size_t at = 0;
  for (int face = 0; face < kCubeFaces; ++face) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        for (int point = 0; point < kTexelPoints; ++point, ++at) {
          const int fx = x * kSubTexels + point % kSubTexels, fy = y * kSubTexels + point / kSubTexels;
          const Vec3 d =
              glm::normalize(world_from_environment * cube_direction(face, cube_coordinate(fx, fine), cube_coordinate(fy, fine)));
          result.direction.x[at] = d.x, result.direction.y[at] = d.y, result.direction.z[at] = d.z;
          result.solid_angle[at] = cube_texel_solid_angle(fx, fy, fine);
        }
      }
    }
  }
  return result;
}

AlignedVector<std::uint16_t> trace_texels(const Tracer& tracer, std::span<const Vec3> position, std::span<const Vec3> normal,
                                          std::span<const Vec3> geometric_normal, std::span<const float> error,
                                          const TexelDirections& directions, RayCounts& rays, const Context& context) {
  AlignedVector<std::uint16_t> masks(position.size() * directions.texels);
  struct Worker {
    RayBatch rays;
    std::vector<std::uint32_t> point;
    AlignedVector<std::uint8_t> occluded;
    RayCounts counts;
  };
  std::vector<Worker> workers(static_cast<std::size_t>(context.thread_count()));
  for (Worker& worker : workers) worker.rays.resize(kBatch), worker.occluded.resize(padded(kBatch));
  std::mutex mutex;
  std::size_t done = 0;
  const std::size_t points = directions.texels * kTexelPoints;
  parallel_for(context, position.size(), 64, [&](std::size_t begin, std::size_t end) {
    Worker& worker = workers[static_cast<std::size_t>(worker_index())];
    const auto flush = [&](std::uint16_t* mask) {
      if (worker.point.empty()) return;
      worker.rays.size = worker.point.size();
      tracer.occluded(worker.rays, worker.occluded, BatchKind::shadow, worker.counts);
      for (std::size_t i = 0; i < worker.point.size(); ++i) {
        if (worker.occluded[i]) continue;
        mask[worker.point[i] / kTexelPoints] |= static_cast<std::uint16_t>(1u << worker.point[i] % kTexelPoints);
      }
      worker.point.clear();
    };
    for (std::size_t v = begin; v < end; ++v) {
      std::uint16_t* mask = masks.data() + v * directions.texels;
      const Vec3 origin = offset_origin(position[v], geometric_normal[v], error[v], geometric_normal[v]);
      for (std::size_t k = 0; k < points; ++k) {
        const Vec3 d(directions.direction.x[k], directions.direction.y[k], directions.direction.z[k]);
        if (!(glm::dot(d, normal[v]) > 0 && glm::dot(d, geometric_normal[v]) > 0)) continue;
        worker.rays.set(worker.point.size(), {origin, 0, d, std::numeric_limits<float>::infinity()});
        worker.point.push_back(static_cast<std::uint32_t>(k));
        if (worker.point.size() == kBatch) flush(mask);
      }
      flush(mask);
    }
    const std::scoped_lock lock(mutex);
    done += end - begin;
    context.report("texel visibility", static_cast<double>(done), static_cast<double>(position.size()));
  });
  for (const Worker& worker : workers) rays += worker.counts;
  return masks;
}

void texel_transport(std::span<const std::uint16_t> masks, const TexelDirections& directions, const Bsdf& bsdf, const Frame3& frame,
                     const Vec3& wo, std::span<Color> transport) {
  const Vec3 wo_local = frame.to_local(wo);
  Bsdf prepared = bsdf;
  prepared.prepare(wo_local);
  for (std::size_t texel = 0; texel < directions.texels; ++texel) {
    Color sum(0);
    float all = 0;
    const std::size_t first = texel * kTexelPoints;
    for (int k = 0; k < kTexelPoints; ++k) all += directions.solid_angle[first + static_cast<std::size_t>(k)];
    for (unsigned left = masks[texel]; left != 0; left &= left - 1) {
      const std::size_t at = first + static_cast<std::size_t>(std::countr_zero(left));
      const Vec3 wi = frame.to_local({directions.direction.x[at], directions.direction.y[at], directions.direction.z[at]});
      sum += directions.solid_angle[at] * prepared.evaluate(wo_local, wi).f_cos;
    }
    transport[texel] = sum / all;
  }
}

}  // namespace sightline::square_lights
