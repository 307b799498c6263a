#include "methods/visibility_cache/judges.h"

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/media.h"

namespace sightline::vpl {
namespace {

constexpr int kMaxDepth = 16;  // mirrors and panes one after the other

// Pairs of random numbers.
enum JudgePair : std::uint32_t { kPicture, kLens, kJudgeSurface };

struct JudgeSearch {
  std::uint32_t index = 0;
  Color weight{1};
  MediumId medium;
};

}  // namespace

std::vector<Judge> find_judges(const World& world, const View& view, std::uint32_t key, std::uint32_t first, std::size_t count,
                               RayCounts& rays) {
  std::vector<JudgeSearch> paths(count);
  RayBatch batch;
  HitBatch hits;
  SurfaceBatch surfaces;
  batch.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    paths[i].index = first + static_cast<std::uint32_t>(i);
    const Vec2 place = sobol_2d(key, paths[i].index, kPicture);
    Vec3 origin, direction;
    view.ray_through(place.x * static_cast<float>(view.width()), place.y * static_cast<float>(view.height()),
                     sobol_2d(key, paths[i].index, kLens), origin, direction);
    batch.set(i, {origin, 0, direction, kInfinity});
  }
  std::vector<Judge> judges;
  const SurfaceReader reader(world);
  MediumRays medium_rays(world);
  const bool travels = medium_rays.media().any() || medium_rays.media().any_interface();
  const MediumId around = medium_rays.around_camera(view);
  for (JudgeSearch& path : paths) path.medium = around;
  std::vector<MediumId> medium;
  for (int depth = 0; depth < kMaxDepth && !paths.empty(); ++depth) {
    world.tracer().intersect(batch, hits, depth == 0 ? BatchKind::primary : BatchKind::bounce, rays);
    world.surfaces(batch, hits, surfaces);
    if (travels) {
      medium.resize(paths.size());
      for (std::size_t i = 0; i < paths.size(); ++i) medium[i] = paths[i].medium;
      const std::span<const Color> left = medium_rays.travel(batch, hits, surfaces, medium, rays);
      for (std::size_t i = 0; i < paths.size(); ++i) paths[i].weight *= left[i], paths[i].medium = medium[i];
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (!hits.hit(i)) continue;
      JudgeSearch path = paths[i];
      const Vec3 direction = load(batch.direction, i);
      const std::uint32_t pair = kJudgeSurface + 2 * static_cast<std::uint32_t>(depth);
      const Vec2 lobe = sobol_2d(key, path.index, pair);
      const SurfacePoint surface = reader.read(batch, hits, surfaces, i, view.cone_width() + view.cone_spread() * hits.t[i], lobe.y);
      const Vec3 normal = glm::dot(surface.geometric_normal, direction) > 0 ? -surface.geometric_normal : surface.geometric_normal;
      if (!surface.bsdf.is_delta()) {
        judges.push_back({surface.position, normal, surface.error, path.weight * surface.bsdf.albedo() * kInvPi,
                          is_translucent(surface.bsdf), path.medium});
        continue;
      }
      const std::optional<Turn> turn = turn_eye(surface, -direction, lobe.x, sobol_2d(key, path.index, pair + 1));
      if (!turn || is_black(turn->weight)) continue;
      path.weight *= turn->weight;
      if (turn->crosses) path.medium = glm::dot(turn->direction, surface.geometric_normal) < 0 ? surface.interior : MediumId{};
      batch.set(kept,
                {offset_origin(surface.position, surface.geometric_normal, surface.error, turn->direction), 0, turn->direction, kInfinity});
      paths[kept++] = path;
    }
    paths.resize(kept);
    batch.resize(kept);
  }
  return judges;
}

}  // namespace sightline::vpl
