// Candidates for virtual point lights, from the lights and from the eye, and what each is worth to the picture.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/core/context.h"
#include "methods/visibility_cache/judges.h"
#include "methods/visibility_cache/light_particles.h"
#include "methods/visibility_cache/surface_point.h"
#include "world/world.h"

namespace sightline::vpl {

struct Candidate {
  SurfacePoint surface;
  Vec3 normal{0, 0, 1};  ///< unit geometric, on the side that the light arrived from
  Vec3 wi{0, 0, 1};      ///< unit, towards where the light came from
  Color beta{0};         ///< flux over the geometric cosine of arrival, divisions by counts and probabilities done
  float importance = 0;  ///< luminance that it sends to the judges, on average
  /// For weighting, sample densities of both ways to make it: that of particles, and that of paths from the judges over that of their
  /// first surface; in one measure (ParticleVertex). Both 0: there is but one way.
  double particle_density = 0, light_density = 0;
  std::uint32_t judge = kNoJudge;  ///< from which it was made
  static constexpr std::uint32_t kNoJudge = 0xffffffffu;

  /// Radiance sent towards unit `w`: what arrives from a distance r is that times cos / r².
  Color sent(const Vec3& w) const { return scattered(surface, w, wi) * beta; }
  /// Luminance of the power that it sends out.
  float power() const { return luminance(beta * surface.bsdf.albedo()) * std::fabs(glm::dot(normal, wi)); }
  bool is_lambert() const { return surface.bsdf.lambert() != nullptr; }
};

/// How many samples both techniques take: their densities are weighted by the balance heuristic [Veach1995].
struct CandidateCounts {
  std::size_t particles = 0, from_judges = 0;
};

/// Particles' vertices, each with the flux of its share of `particles`.
std::vector<Candidate> candidates_of(std::span<const ParticleVertex> vertices, std::size_t particles);

/// Traces the rays between judges and candidates; weights what both techniques make by the densities of both, and finds the
/// importance of all. `judge_count`: camera rays that were sent out to find judges. `max_geometry_term` clamps cos cos / r².
void weigh(const World& world, std::span<const Judge> judges, std::size_t judge_count, const CandidateCounts& counts,
           float max_geometry_term, std::span<Candidate> candidates, const Context& context, RayCounts& rays);

}  // namespace sightline::vpl
