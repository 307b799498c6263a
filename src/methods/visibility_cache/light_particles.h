// Particles that leave the lights, and the surfaces that they meet.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/core/context.h"
#include "methods/visibility_cache/surface_point.h"
#include "world/world.h"

namespace sightline::vpl {

/// A surface that scatters, where a particle arrived.
struct ParticleVertex {
  SurfacePoint surface;
  Vec3 wi{0, 0, 1};  ///< unit, towards where the particle came from
  Color beta{0};     ///< flux of the particle, as if it were the only one, over the geometric cosine of arrival
  /// Where paths from the judges that are connected to lights might have found it, else 0: densities of particles and of such paths (over
  /// that of their first surface). Both by area of this surface, by solid angle of the directions from it and the surfaces towards the
  /// light, and, for delta lights, by the choice of light in place of the last direction.
  double particle_density = 0, light_density = 0;
};

struct ParticleOptions {
  int max_bounces = 8;  ///< surfaces a particle, mirrors and glass included
  std::uint32_t key = 0;
};

/// Traces particles [first, first + count); vertices in the order of particles' batches, the same for any number of threads. Particles go
/// through mirrors and glass.
std::vector<ParticleVertex> trace_particles(const World& world, const ParticleOptions& options, std::uint32_t first, std::size_t count,
                                            const Context& context, RayCounts& rays);

/// How many samples give about `wanted` results, at most `most`, where `found(first, count)` says how many results samples [first,
/// first + count) give. Those samples must not be used again: a count that heeded the samples that are kept would be biased.
template <class Found>
std::size_t samples_for(std::size_t wanted, std::size_t most, const Found& found) {
  constexpr std::size_t kEnough = 256;
  if (wanted == 0) return 0;
  std::size_t tried = 0, results = 0;
  for (std::size_t round = kEnough; tried < most && results < kEnough; round = tried) {
    results += found(tried, round);
    tried += round;
  }
  if (results == 0) return most;
  const double count = std::ceil(static_cast<double>(wanted) * static_cast<double>(tried) / static_cast<double>(results));
  return static_cast<std::size_t>(std::min(std::max(count, 1.0), static_cast<double>(most)));
}

/// How many particles leave about `wanted` vertices, at most `most`.
std::size_t particles_for(std::size_t wanted, std::size_t most, const World& world, const ParticleOptions& options, const Context& context,
                          RayCounts& rays);

}  // namespace sightline::vpl
