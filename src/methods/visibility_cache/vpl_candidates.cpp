#include "methods/visibility_cache/vpl_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel/parallel.h"
#include "base/sample/sobol.h"
#include "base/sample/warp.h"

namespace sightline::vpl {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kBatch = 256;      // candidates from judges
constexpr std::size_t kRayBatch = 2048;  // between judges and candidates

// Pairs of random numbers of a candidate from a judge.
enum Pair : std::uint32_t { kDirection, kLightPick, kLightPoint };  // of kLightPick: light, mix

Vec3 load(const Vec3Batch& batch, std::size_t i) { return {batch.x[i], batch.y[i], batch.z[i]}; }

// The judge that sample `index` of `count` starts from: each gets its share, and none more than one above it.
std::uint32_t judge_of(std::size_t sample, std::size_t count, float offset, std::size_t judges) {
  const double place =
      (static_cast<double>(sample) + static_cast<double>(offset)) * static_cast<double>(judges) / static_cast<double>(count);
  return static_cast<std::uint32_t>(std::min(static_cast<std::size_t>(place), judges - 1));
}

class JudgeBounces {
 public:
  explicit JudgeBounces(const World& world) : world_(world), reader_(world) {}

  void trace(std::span<const Judge> judges, std::span<const std::uint32_t> judge, std::uint32_t key, std::uint32_t first,
             std::vector<Candidate>& candidates, RayCounts& counts) {
    rays_.resize(judge.size());
    for (std::size_t i = 0; i < judge.size(); ++i) {
      const Judge& from = judges[judge[i]];
      const Vec2 u = sobol_2d(key, first + static_cast<std::uint32_t>(i), kDirection);
      const Vec3 direction = frame_from_normal(from.normal).to_world(sample_cosine_hemisphere(u));
      rays_.set(i, {offset_origin(from.position, from.normal, from.error, direction), 0, direction, kInfinity});
    }
    world_.tracer().intersect(rays_, hits_, BatchKind::bounce, counts);
    world_.surfaces(rays_, hits_, surfaces_);
    connect_lights(judges, judge, key, first);
    occluded_.resize(padded(found_.size()));
    world_.tracer().occluded(shadow_, occluded_, BatchKind::shadow_diffuse, counts);
    for (std::size_t k = 0; k < found_.size(); ++k) {
      if (!occluded_[k]) candidates.push_back(found_[k]);
    }
  }

 private:
  void connect_lights(std::span<const Judge> judges, std::span<const std::uint32_t> judge, std::uint32_t key, std::uint32_t first);

  const World& world_;
  SurfaceReader reader_;
  RayBatch rays_, shadow_;
  HitBatch hits_;
  SurfaceBatch surfaces_;
  std::vector<Candidate> found_;
  AlignedVector<std::uint8_t> occluded_;
};

void JudgeBounces::connect_lights(std::span<const Judge> judges, std::span<const std::uint32_t> judge, std::uint32_t key,
                                  std::uint32_t first) {
  const LightTable& lights = world_.lights();
  found_.clear();
  shadow_.resize(judge.size());
  for (std::size_t i = 0; i < judge.size(); ++i) {
    if (!hits_.hit(i)) continue;
    const std::uint32_t index = first + static_cast<std::uint32_t>(i);
    const Vec2 pick = sobol_2d(key, index, kLightPick);
    Candidate candidate;
    candidate.judge = judge[i];
    candidate.surface = reader_.read(rays_, hits_, surfaces_, i, 0, pick.y);
    const SurfacePoint& surface = candidate.surface;
    if (surface.bsdf.is_delta()) continue;
    const LightSample light = lights.sample(surface.position, surface.geometric_normal, pick.x, sobol_2d(key, index, kLightPoint));
    if (!(light.pdf > 0) || is_black(light.radiance)) continue;
    const float side = glm::dot(surface.geometric_normal, light.wi);
    const float seen = -glm::dot(surface.geometric_normal, load(rays_.direction, i));
    if (side == 0 || (side * seen <= 0 && !is_translucent(surface.bsdf))) continue;
    candidate.normal = side > 0 ? surface.geometric_normal : -surface.geometric_normal;
    candidate.wi = light.wi;
    candidate.beta = light.radiance;
    candidate.light_density = light.pdf;
    // The density of particles that make the same pair of points.
    const bool infinite = std::isinf(light.distance);
    const Vec3 leaving = -light.wi;
    const EmissionPdf emission = lights.emission_pdf(light.light, light.point, leaving);
    candidate.particle_density =
        static_cast<double>(emission.start) * static_cast<double>(emission.leave) * std::fabs(static_cast<double>(side));
    const MediumId medium = side * seen > 0 ? judges[judge[i]].medium : side < 0 ? surface.interior : MediumId{};
    const Vec3 origin = offset_origin(surface.position, surface.geometric_normal, surface.error, light.wi);
    if (infinite) {
      shadow_.set(found_.size(), {origin, 0, light.wi, kInfinity});
    } else {
      const double squared = static_cast<double>(light.distance) * static_cast<double>(light.distance);
      candidate.particle_density /=
          light.is_delta ? squared : std::fmax(std::fabs(static_cast<double>(glm::dot(light.normal, light.wi))), 1e-30);
      if (medium.valid()) candidate.beta *= glm::exp(-world_.scene().media[medium.index].sigma_a * light.distance);
      shadow_.set(found_.size(), {origin, 0, offset_origin(light.point, light.normal, light.point_error, leaving) - origin, 1});
    }
    found_.push_back(candidate);
  }
  shadow_.resize(found_.size());
}

/// Rays between candidates and judges that may exchange light, and what comes of them.
class Jury {
 public:
  Jury(const World& world, std::span<const Judge> judges, std::size_t judge_count, const CandidateCounts& counts, float max_geometry_term)
      : world_(world), judges_(judges), judge_count_(judge_count), counts_(counts), max_geometry_term_(max_geometry_term) {}

  void hear(std::span<Candidate> candidates, RayCounts& rays) {
    rays_.resize(candidates.size() * judges_.size());
    std::size_t count = 0;
    pairs_.clear();
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      for (std::size_t j = 0; j < judges_.size(); ++j) {
        if (add_ray(candidates[c], judges_[j], count)) pairs_.push_back({c, j}), ++count;
      }
    }
    rays_.resize(count);
    occluded_.resize(padded(count));
    world_.tracer().occluded(rays_, occluded_, BatchKind::shadow_diffuse, rays);
    std::size_t r = 0;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const std::size_t begin = r;
      while (r < count && pairs_[r].candidate == c) ++r;
      decide(candidates[c], begin, r);
    }
  }

 private:
  struct Pair {
    std::size_t candidate, judge;
  };

  bool add_ray(const Candidate& candidate, const Judge& judge, std::size_t at) {
    const SurfacePoint& surface = candidate.surface;
    const Vec3 towards = judge.position - surface.position;
    const float cos_judge = -glm::dot(judge.normal, towards), cos_light = glm::dot(candidate.normal, towards);
    if (!(cos_judge > 0) && !(judge.translucent && cos_judge < 0)) return false;
    if (!(cos_light > 0) && !(cos_light < 0 && is_translucent(surface.bsdf))) return false;
    const Vec3 origin = offset_origin(surface.position, surface.geometric_normal, surface.error, towards);
    const Vec3 target = offset_origin(judge.position, judge.normal, judge.error, -towards);
    rays_.set(at, {origin, 0, target - origin, 1});
    return true;
  }

  void decide(Candidate& candidate, std::size_t begin, std::size_t end) const;

  const World& world_;
  std::span<const Judge> judges_;
  std::size_t judge_count_;
  CandidateCounts counts_;
  float max_geometry_term_;
  RayBatch rays_;
  std::vector<Pair> pairs_;
  AlignedVector<std::uint8_t> occluded_;
};

void Jury::decide(Candidate& candidate, std::size_t begin, std::size_t end) const {
  double density = 0;
  bool own = false;
  Color sum(0);
  for (std::size_t r = begin; r < end; ++r) {
    if (occluded_[r]) continue;
    const Judge& judge = judges_[pairs_[r].judge];
    const Vec3 towards = judge.position - candidate.surface.position;
    const float squared = length_squared(towards);
    if (!(squared > 0)) continue;
    const Vec3 w = towards / std::sqrt(squared);
    const float cos_judge = -glm::dot(judge.normal, w), cos_light = std::fabs(glm::dot(candidate.normal, w));
    // Cosine-distributed bounces leave a judge on the side of its normal; all judges together make one density by area [Segovia2006].
    if (cos_judge > 0) {
      density += static_cast<double>(cos_judge * kInvPi * cos_light) / static_cast<double>(squared);
      own |= pairs_[r].judge == candidate.judge;
    }
    sum += judge.weight * candidate.sent(w) * std::min(std::fabs(cos_judge) * cos_light / squared, max_geometry_term_);
  }
  if (candidate.judge != Candidate::kNoJudge && !own) {
    // The bounce and the ray back disagree by a rounding error: where the density is none, neither is the candidate.
    candidate.beta = Color(0), candidate.importance = 0;
    return;
  }
  double factor = 1;
  if (candidate.light_density > 0) {
    const double from_judges = judges_.empty() ? 0
                                               : density / static_cast<double>(judges_.size()) * static_cast<double>(counts_.from_judges) *
                                                     candidate.light_density;
    const double from_light = candidate.particle_density * static_cast<double>(counts_.particles);
    const double all = from_judges + from_light;
    factor = candidate.judge == Candidate::kNoJudge ? (all > 0 ? from_light / all : 1.0) : 1 / all;
  }
  candidate.beta *= static_cast<float>(factor);
  if (!is_finite(candidate.beta)) candidate.beta = Color(0);
  candidate.importance = luminance(sum) * static_cast<float>(factor) / static_cast<float>(judge_count_);
  if (!(candidate.importance > 0) || !std::isfinite(candidate.importance)) candidate.importance = 0;
}

/// Calls work(begin, end, rays) on chunks and adds up the rays.
template <class Work>
void count_in_chunks(std::size_t count, std::size_t grain, const Context& context, RayCounts& rays, Work&& work) {
  std::vector<RayCounts> counts((count + grain - 1) / grain);
  parallel_for(context, count, grain, [&](std::size_t begin, std::size_t end) { work(begin, end, counts[begin / grain]); });
  for (const RayCounts& c : counts) rays += c;
}

}  // namespace

std::vector<Candidate> candidates_of(std::span<const ParticleVertex> vertices, std::size_t particles) {
  std::vector<Candidate> candidates;
  candidates.reserve(vertices.size());
  for (const ParticleVertex& vertex : vertices) {
    Candidate candidate;
    candidate.surface = vertex.surface;
    const Vec3& normal = vertex.surface.geometric_normal;
    candidate.normal = glm::dot(normal, vertex.wi) < 0 ? -normal : normal;
    candidate.wi = vertex.wi;
    candidate.beta = vertex.beta / static_cast<float>(particles);
    candidate.particle_density = vertex.particle_density;
    candidate.light_density = vertex.light_density;
    candidates.push_back(candidate);
  }
  return candidates;
}

std::vector<Candidate> candidates_from_judges(const World& world, std::span<const Judge> judges, std::uint32_t key, std::uint32_t first,
                                              std::size_t count, const Context& context, RayCounts& rays) {
  if (judges.empty() || count == 0 || world.lights().size() == 0) return {};
  const float offset = sobol_2d(hash32(key), first / static_cast<std::uint32_t>(count), 0).x;
  std::vector<std::uint32_t> judge(count);
  for (std::size_t i = 0; i < count; ++i) judge[i] = judge_of(i, count, offset, judges.size());
  std::vector<std::vector<Candidate>> found((count + kBatch - 1) / kBatch);
  count_in_chunks(count, kBatch, context, rays, [&](std::size_t begin, std::size_t end, RayCounts& counts) {
    JudgeBounces bounces(world);
    bounces.trace(judges, std::span(judge).subspan(begin, end - begin), key, first + static_cast<std::uint32_t>(begin),
                  found[begin / kBatch], counts);
  });
  std::vector<Candidate> candidates;
  for (const std::vector<Candidate>& some : found) candidates.insert(candidates.end(), some.begin(), some.end());
  return candidates;
}

std::size_t samples_from_judges_for(std::size_t wanted, std::size_t most, const World& world, std::span<const Judge> judges,
                                    std::uint32_t key, const Context& context, RayCounts& rays) {
  if (judges.empty()) return 0;
  return samples_for(wanted, most, [&](std::size_t first, std::size_t count) {
    return candidates_from_judges(world, judges, key, static_cast<std::uint32_t>(first), count, context, rays).size();
  });
}

void weigh(const World& world, std::span<const Judge> judges, std::size_t judge_count, const CandidateCounts& counts,
           float max_geometry_term, std::span<Candidate> candidates, const Context& context, RayCounts& rays) {
  const std::size_t grain = std::max<std::size_t>(1, kRayBatch / std::max<std::size_t>(1, judges.size()));
  count_in_chunks(candidates.size(), grain, context, rays, [&](std::size_t begin, std::size_t end, RayCounts& counted) {
    Jury(world, judges, std::max<std::size_t>(judge_count, 1), counts, max_geometry_term)
        .hear(candidates.subspan(begin, end - begin), counted);
  });
}

}  // namespace sightline::vpl
