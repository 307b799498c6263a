#include "methods/visibility_cache/judge_paths.h"

#include <algorithm>
#include <cmath>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "base/sample/warp.h"
#include "methods/media.h"
#include "methods/visibility_cache/counted_chunks.h"

namespace sightline::vpl {
namespace {

constexpr std::size_t kJudgeBatch = 256;

// Pairs of random numbers of each surface of a path; direction: of the ray that leads there. Of kPick: light, mix.
enum JudgePathPair : std::uint32_t { kDirection, kPick, kPoint, kRoulette, kSurfacePairs };
constexpr std::uint32_t judge_pair(int surface, JudgePathPair use) { return kSurfacePairs * static_cast<std::uint32_t>(surface) + use; }

// The judge that path `path` of `count` starts from: each gets its share, and none more than one above it.
std::uint32_t judge_of(std::size_t path, std::size_t count, float offset, std::size_t judges) {
  const double place = (static_cast<double>(path) + static_cast<double>(offset)) * static_cast<double>(judges) / static_cast<double>(count);
  return static_cast<std::uint32_t>(std::min(static_cast<std::size_t>(place), judges - 1));
}

/// A path that goes on.
struct OpenPath {
  std::uint32_t index = 0;
  MediumId medium;
  Candidate candidate;   ///< on its first surface, as far as it is known
  SurfacePoint surface;  ///< that the ray left
  Vec3 wo{0, 0, 1};      ///< there, unit, towards the surface or judge before
  float arriving = 0;    ///< cosine at the surface before, of light from `surface`
  int surfaces = 0;      ///< so far
};

class JudgePathTracer {
 public:
  JudgePathTracer(const World& world, std::span<const Judge> judges, const JudgePathOptions& options)
      : world_(world), reader_(world), judges_(judges), options_(options), medium_rays_(world) {}

  void trace(std::span<const std::uint32_t> judge, std::uint32_t first, std::vector<Candidate>& candidates, RayCounts& counts) {
    start(judge, first);
    while (!paths_.empty()) {
      world_.tracer().intersect(rays_, hits_, BatchKind::bounce, counts);
      world_.surfaces(rays_, hits_, surfaces_);
      travel(counts);
      arrive();
      connect(candidates, counts);
      go_on();
    }
  }

 private:
  Vec2 random(const OpenPath& path, JudgePathPair use) const { return sobol_2d(options_.key, path.index, judge_pair(path.surfaces, use)); }
  void start(std::span<const std::uint32_t> judge, std::uint32_t first);
  void travel(RayCounts& counts);
  void arrive();
  void connect(std::vector<Candidate>& candidates, RayCounts& counts);
  void add_light(const OpenPath& path, const LightSample& light);
  void go_on();

  const World& world_;
  SurfaceReader reader_;
  std::span<const Judge> judges_;
  JudgePathOptions options_;
  std::vector<OpenPath> paths_;  // one a ray
  RayBatch rays_, shadow_;
  HitBatch hits_;
  SurfaceBatch surfaces_;
  std::vector<Candidate> found_;  // one a shadow ray
  AlignedVector<std::uint8_t> occluded_;
  MediumRays medium_rays_;
  std::vector<MediumId> medium_, shadow_medium_;
};

void JudgePathTracer::start(std::span<const std::uint32_t> judge, std::uint32_t first) {
  paths_.assign(judge.size(), OpenPath());
  rays_.resize(judge.size());
  for (std::size_t i = 0; i < judge.size(); ++i) {
    const Judge& from = judges_[judge[i]];
    OpenPath& path = paths_[i];
    path.index = first + static_cast<std::uint32_t>(i);
    path.medium = from.medium;
    path.candidate.judge = judge[i];
    path.candidate.beta = Color(1);
    path.candidate.particle_density = path.candidate.light_density = 1;
    const Vec3 direction = frame_from_normal(from.normal).to_world(sample_cosine_hemisphere(random(path, kDirection)));
    rays_.set(i, {offset_origin(from.position, from.normal, from.error, direction), 0, direction, kInfinity});
  }
}

// Beer-Lambert on the way, and on behind what only bounds a medium. The way from the judge is that of whoever looks at the candidate.
void JudgePathTracer::travel(RayCounts& counts) {
  if (!medium_rays_.media().any() && !medium_rays_.media().any_interface()) return;
  medium_.resize(paths_.size());
  for (std::size_t i = 0; i < paths_.size(); ++i) medium_[i] = paths_[i].medium;
  const std::span<const Color> left = medium_rays_.travel(rays_, hits_, surfaces_, medium_, counts);
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    if (paths_[i].surfaces > 0) paths_[i].candidate.beta *= left[i];
    paths_[i].medium = medium_[i];
  }
}

// Paths that met a surface that scatters stand on it afterwards, in the same order.
void JudgePathTracer::arrive() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    if (!hits_.hit(i)) continue;
    OpenPath& path = paths_[i];
    path.surface = reader_.read(rays_, hits_, surfaces_, i, 0, random(path, kPick).y);
    path.wo = -load(rays_.direction, i);
    if (path.surface.bsdf.is_delta()) continue;
    if (path.surfaces == 0) path.candidate.surface = path.surface;
    if (kept != i) paths_[kept] = path;
    ++kept;
  }
  paths_.resize(kept);
}

void JudgePathTracer::connect(std::vector<Candidate>& candidates, RayCounts& counts) {
  found_.clear(), shadow_medium_.clear();
  shadow_.resize(paths_.size());
  for (const OpenPath& path : paths_) {
    const LightSample light =
        world_.lights().sample(path.surface.position, path.surface.geometric_normal, random(path, kPick).x, random(path, kPoint));
    if (light.pdf > 0 && !is_black(light.radiance)) add_light(path, light);
  }
  shadow_.resize(found_.size());
  occluded_.resize(std::max(occluded_.size(), padded(found_.size())));
  world_.tracer().occluded(shadow_, occluded_, BatchKind::shadow_diffuse, counts);
  if (medium_rays_.media().any()) {
    const std::span<const Color> left = medium_rays_.attenuate(shadow_, shadow_medium_, counts);
    for (std::size_t k = 0; k < found_.size(); ++k) found_[k].beta *= left[k];
  }
  for (std::size_t k = 0; k < found_.size(); ++k) {
    if (!occluded_[k]) candidates.push_back(found_[k]);
  }
}

/// What changes in the measures of a path when light from `wi` goes on to `wo` at a surface: particles' density by area of the surface to
/// come, over solid angle there.
double particle_factor(const SurfacePoint& surface, const Vec3& wi, const Vec3& wo, float arriving) {
  const double leaving = std::fabs(static_cast<double>(glm::dot(surface.geometric_normal, wo)));
  return leaving > 0 ? static_cast<double>(light_turn_pdf(surface, wi, wo)) * static_cast<double>(arriving) / leaving : 0;
}

void JudgePathTracer::add_light(const OpenPath& path, const LightSample& light) {
  const SurfacePoint& surface = path.surface;
  const float side = glm::dot(surface.geometric_normal, light.wi), seen = glm::dot(surface.geometric_normal, path.wo);
  if (side == 0 || (side * seen <= 0 && !is_translucent(surface.bsdf))) return;
  Candidate candidate = path.candidate;
  if (path.surfaces == 0) {
    candidate.normal = side > 0 ? surface.geometric_normal : -surface.geometric_normal;
    candidate.wi = light.wi;
  } else {
    candidate.beta *= scattered(surface, path.wo, light.wi);
    candidate.particle_density *= particle_factor(surface, light.wi, path.wo, path.arriving);
  }
  candidate.beta *= light.radiance;
  candidate.light_density *= static_cast<double>(light.pdf);
  const Vec3 leaving = -light.wi;
  const EmissionPdf emission = world_.lights().emission_pdf(light.light, light.point, leaving);
  candidate.particle_density *=
      static_cast<double>(emission.start) * static_cast<double>(emission.leave) * std::fabs(static_cast<double>(side));
  const Vec3 origin = offset_origin(surface.position, surface.geometric_normal, surface.error, light.wi);
  const std::size_t at = found_.size();
  if (std::isinf(light.distance)) {
    shadow_.set(at, {origin, 0, light.wi, kInfinity});
  } else {
    const double squared = static_cast<double>(light.distance) * static_cast<double>(light.distance);
    // dA_y = dω r² / cos_y.
    candidate.particle_density /=
        light.is_delta ? squared : std::fmax(std::fabs(static_cast<double>(glm::dot(light.normal, light.wi))), 1e-30);
    shadow_.set(at, {origin, 0, offset_origin(light.point, light.normal, light.point_error, leaving) - origin, 1});
  }
  if (is_black(candidate.beta)) return;
  found_.push_back(candidate);
  shadow_medium_.push_back(Media::towards(light.wi, path.wo, surface.geometric_normal, path.medium, surface.interior));
}

void JudgePathTracer::go_on() {
  std::size_t kept = 0;
  rays_.resize(paths_.size());
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    OpenPath path = paths_[i];
    const SurfacePoint& surface = path.surface;
    // Directions are cosine-distributed on the side that is seen, so what lies behind translucent surfaces is for particles alone.
    if (path.surfaces + 1 >= options_.max_bounces || is_translucent(surface.bsdf)) continue;
    const float survival = std::clamp(max_component(surface.bsdf.albedo()), 0.05f, 0.95f);
    if (random(path, kRoulette).x >= survival) continue;
    const Vec3 normal = glm::dot(surface.geometric_normal, path.wo) < 0 ? -surface.geometric_normal : surface.geometric_normal;
    const Vec2 u = sobol_2d(options_.key, path.index, judge_pair(path.surfaces + 1, kDirection));
    const Vec3 wi = frame_from_normal(normal).to_world(sample_cosine_hemisphere(u));
    const float cosine = glm::dot(normal, wi);
    if (!(cosine > 0)) continue;
    if (path.surfaces == 0) {
      path.candidate.normal = normal, path.candidate.wi = wi;
    } else {
      path.candidate.beta *= scattered(surface, path.wo, wi);
      path.candidate.particle_density *= particle_factor(surface, wi, path.wo, path.arriving);
    }
    path.candidate.beta /= survival;
    if (is_black(path.candidate.beta)) continue;
    path.candidate.light_density *= static_cast<double>(cosine * kInvPi);
    path.arriving = cosine;
    ++path.surfaces;
    rays_.set(kept, {offset_origin(surface.position, surface.geometric_normal, surface.error, wi), 0, wi, kInfinity});
    paths_[kept++] = path;
  }
  paths_.resize(kept);
  rays_.resize(kept);
}

}  // namespace

std::vector<Candidate> trace_judge_paths(const World& world, std::span<const Judge> judges, const JudgePathOptions& options,
                                         std::uint32_t first, std::size_t count, const Context& context, RayCounts& rays) {
  if (judges.empty() || count == 0 || world.lights().size() == 0) return {};
  const float offset = sobol_2d(hash32(options.key), first / static_cast<std::uint32_t>(count), 0).x;
  std::vector<std::uint32_t> judge(count);
  for (std::size_t i = 0; i < count; ++i) judge[i] = judge_of(i, count, offset, judges.size());
  std::vector<std::vector<Candidate>> found((count + kJudgeBatch - 1) / kJudgeBatch);
  for_counted_chunks(count, kJudgeBatch, context, rays, [&](std::size_t begin, std::size_t end, RayCounts& counts) {
    JudgePathTracer(world, judges, options)
        .trace(std::span(judge).subspan(begin, end - begin), first + static_cast<std::uint32_t>(begin), found[begin / kJudgeBatch], counts);
  });
  std::vector<Candidate> candidates;
  for (const std::vector<Candidate>& some : found) candidates.insert(candidates.end(), some.begin(), some.end());
  return candidates;
}

std::size_t judge_paths_for(std::size_t wanted, std::size_t most, const World& world, std::span<const Judge> judges,
                            const JudgePathOptions& options, const Context& context, RayCounts& rays) {
  if (judges.empty()) return 0;
  return samples_for(wanted, most, [&](std::size_t first, std::size_t count) {
    return trace_judge_paths(world, judges, options, static_cast<std::uint32_t>(first), count, context, rays).size();
  });
}

}  // namespace sightline::vpl
