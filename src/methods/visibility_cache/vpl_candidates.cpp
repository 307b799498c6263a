#include "methods/visibility_cache/vpl_candidates.h"

#include <algorithm>
#include <cmath>

#include "methods/visibility_cache/counted_chunks.h"

namespace sightline::vpl {
namespace {

constexpr std::size_t kRayBatch = 2048;  // between judges and candidates

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

void weigh(const World& world, std::span<const Judge> judges, std::size_t judge_count, const CandidateCounts& counts,
           float max_geometry_term, std::span<Candidate> candidates, const Context& context, RayCounts& rays) {
  const std::size_t grain = std::max<std::size_t>(1, kRayBatch / std::max<std::size_t>(1, judges.size()));
  for_counted_chunks(candidates.size(), grain, context, rays, [&](std::size_t begin, std::size_t end, RayCounts& counted) {
    Jury(world, judges, std::max<std::size_t>(judge_count, 1), counts, max_geometry_term)
        .hear(candidates.subspan(begin, end - begin), counted);
  });
}

}  // namespace sightline::vpl
