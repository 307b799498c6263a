#include "methods/visibility_cache/light_particles.h"

#include <algorithm>
#include <cmath>

#include "base/math/vec3_batch.h"
#include "base/parallel/parallel.h"
#include "base/sample/sobol.h"
#include "methods/media.h"

namespace sightline::vpl {
namespace {

constexpr std::size_t kParticleBatch = 256;
constexpr int kRouletteStart = 2;  ///< surfaces that particles reach unharmed

// Pairs of random numbers of a particle.
enum ParticlePair : std::uint32_t { kEmitter, kEmission, kEmitted, kParticleSurface };
enum ParticleSurfacePair : std::uint32_t { kMix, kLobe, kTurn, kParticleSurfacePairs };  // of kLobe: lobe, roulette
constexpr std::uint32_t particle_pair(int surface, ParticleSurfacePair use) {
  return kParticleSurface + kParticleSurfacePairs * static_cast<std::uint32_t>(surface) + use;
}

struct Particle {
  std::uint32_t index = 0;
  EmissionSample emission;
  Color beta{0};
  float scale = 1;                                 ///< makes throughputs comparable for Russian roulette
  double particle_density = 0, light_density = 0;  ///< of ParticleVertex, at the surface before
  double turn_density = 0;                         ///< of the direction, over the cosine there; 0: delta
  MediumId medium;
};

/// Traces one batch after the other; one a chunk of work.
class ParticleTracer {
 public:
  ParticleTracer(const World& world, const ParticleOptions& options)
      : world_(world), reader_(world), options_(options), medium_rays_(world) {
    for (const Material& material : world.scene().materials) has_mix_ |= std::holds_alternative<MixMaterial>(material.model);
  }

  void trace(std::uint32_t first, std::size_t count, std::vector<ParticleVertex>& vertices, RayCounts& counts) {
    emit(first, count, counts);
    for (int surface = 0; surface < options_.max_bounces && !particles_.empty(); ++surface) {
      world_.tracer().intersect(rays_, hits_, BatchKind::bounce, counts);
      world_.surfaces(rays_, hits_, surfaces_);
      travel(counts);
      arrive_and_scatter(surface, vertices);
    }
  }

 private:
  Vec2 random(std::uint32_t index, std::uint32_t pair) const { return sobol_2d(options_.key, index, pair); }
  void emit(std::uint32_t first, std::size_t count, RayCounts& counts);
  void travel(RayCounts& counts);
  void arrive_and_scatter(int surface, std::vector<ParticleVertex>& vertices);
  void set_densities(const Vec3& direction, const ParticleVertex& vertex, Particle& particle) const;

  const World& world_;
  SurfaceReader reader_;
  ParticleOptions options_;
  bool has_mix_ = false;
  MediumRays medium_rays_;
  std::vector<MediumId> medium_;
  std::vector<Particle> particles_;  // one a ray
  RayBatch rays_;
  HitBatch hits_;
  SurfaceBatch surfaces_;
};

void ParticleTracer::emit(std::uint32_t first, std::size_t count, RayCounts& counts) {
  particles_.resize(count);
  rays_.resize(count);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Particle particle;
    particle.index = first + static_cast<std::uint32_t>(i);
    particle.emission = world_.lights().sample_emission(random(particle.index, kEmitter).x, random(particle.index, kEmission),
                                                        random(particle.index, kEmitted));
    const EmissionSample& s = particle.emission;
    if (!(s.pdf.start > 0) || !(s.pdf.leave > 0)) continue;
    const bool is_surface = !is_black(s.normal);
    const float cosine = is_surface ? std::fabs(glm::dot(s.normal, s.direction)) : 1.f;
    particle.beta = s.radiance * (cosine / (s.pdf.start * s.pdf.leave));
    if (!is_finite(particle.beta) || is_black(particle.beta)) continue;
    particle.scale = 1 / max_component(particle.beta);
    const Vec3 origin = is_surface ? offset_origin(s.point, s.normal, s.point_error, s.direction) : s.point;
    rays_.set(kept, {origin, 0, s.direction, kInfinity});
    particles_[kept++] = particle;
  }
  particles_.resize(kept);
  rays_.resize(kept);
  if (!medium_rays_.media().any()) return;
  medium_.resize(kept);
  medium_rays_.find(rays_, medium_, counts);
  for (std::size_t i = 0; i < kept; ++i) {
    if (!particles_[i].emission.is_infinite) particles_[i].medium = medium_[i];
  }
}

// Beer-Lambert on the way, and on behind what only bounds a medium.
void ParticleTracer::travel(RayCounts& counts) {
  if (!medium_rays_.media().any() && !medium_rays_.media().any_interface()) return;
  medium_.resize(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) medium_[i] = particles_[i].medium;
  const std::span<const Color> left = medium_rays_.travel(rays_, hits_, surfaces_, medium_, counts);
  for (std::size_t i = 0; i < particles_.size(); ++i) particles_[i].beta *= left[i], particles_[i].medium = medium_[i];
}

// Densities of the pair of light point and first surface.
void ParticleTracer::set_densities(const Vec3& direction, const ParticleVertex& vertex, Particle& particle) const {
  const EmissionSample& s = particle.emission;
  const Vec3 &position = vertex.surface.position, &normal = vertex.surface.geometric_normal;
  const double cosine = std::fabs(static_cast<double>(glm::dot(normal, direction)));
  const double leaving = static_cast<double>(s.pdf.start) * static_cast<double>(s.pdf.leave) * cosine;
  if (s.is_infinite) {
    particle.particle_density = leaving;
    particle.light_density = s.is_delta ? s.pdf.start : world_.lights().environment_pdf(position, normal, -direction);
  } else if (s.is_delta) {
    particle.particle_density = leaving / static_cast<double>(length_squared(position - s.point));
    particle.light_density = s.pdf.start;
  } else {
    // dA_y = dω r² / cos_y.
    particle.particle_density = leaving / std::fabs(static_cast<double>(glm::dot(s.normal, direction)));
    particle.light_density = world_.lights().pdf(position, normal, s.light, s.point, s.normal, -direction);
  }
}

void ParticleTracer::arrive_and_scatter(int surface, std::vector<ParticleVertex>& vertices) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    if (!hits_.hit(i)) continue;
    Particle particle = particles_[i];
    const Vec3 direction = load(rays_.direction, i);
    const float cosine = std::fabs(glm::dot(load(surfaces_.geometric_normal, i), direction));
    particle.beta /= cosine;
    if (!is_finite(particle.beta) || is_black(particle.beta)) continue;

    ParticleVertex vertex;
    vertex.surface = reader_.read(rays_, hits_, surfaces_, i, 0, has_mix_ ? random(particle.index, particle_pair(surface, kMix)).x : 0.f);
    vertex.wi = -direction;
    vertex.beta = particle.beta;
    if (!vertex.surface.bsdf.is_delta()) {
      if (surface == 0) {
        set_densities(direction, vertex, particle);
      } else {
        // Paths from the judges do not go on at translucent surfaces.
        particle.particle_density *= particle.turn_density * static_cast<double>(cosine);
        particle.light_density *= is_translucent(vertex.surface.bsdf) ? 0 : static_cast<double>(cosine * kInvPi);
      }
      if (!(particle.particle_density > 0) || !(particle.light_density > 0)) particle.particle_density = particle.light_density = 0;
      vertex.particle_density = particle.particle_density, vertex.light_density = particle.light_density;
      vertices.push_back(vertex);
    }
    if (surface + 1 == options_.max_bounces) continue;

    const Vec2 lobe = random(particle.index, particle_pair(surface, kLobe));
    const std::optional<Turn> turn = turn_light(vertex.surface, vertex.wi, lobe.x, random(particle.index, particle_pair(surface, kTurn)));
    if (!turn) continue;
    particle.beta *= turn->weight;
    const float leaving = std::fabs(glm::dot(turn->direction, vertex.surface.geometric_normal));
    particle.turn_density = turn->is_delta || !(leaving > 0) ? 0 : static_cast<double>(turn->pdf) / static_cast<double>(leaving);
    if (turn->is_delta) particle.particle_density = particle.light_density = 0;
    if (is_black(particle.beta) || !is_finite(particle.beta)) continue;
    if (surface + 1 >= kRouletteStart) {
      const float survival = std::min(1.f, max_component(particle.beta) * particle.scale);
      if (lobe.y >= survival) continue;
      particle.beta /= survival;
    }
    if (turn->crosses)
      particle.medium = glm::dot(turn->direction, vertex.surface.geometric_normal) < 0 ? vertex.surface.interior : MediumId{};
    rays_.set(kept, {offset_origin(vertex.surface.position, vertex.surface.geometric_normal, vertex.surface.error, turn->direction), 0,
                     turn->direction, kInfinity});
    particles_[kept++] = particle;
  }
  particles_.resize(kept);
  rays_.resize(kept);
}

}  // namespace

std::vector<ParticleVertex> trace_particles(const World& world, const ParticleOptions& options, std::uint32_t first, std::size_t count,
                                            const Context& context, RayCounts& rays) {
  const std::size_t batches = (count + kParticleBatch - 1) / kParticleBatch;
  std::vector<std::vector<ParticleVertex>> found(batches);
  std::vector<RayCounts> counts(batches);
  parallel_for(context, batches, 1, [&](std::size_t begin, std::size_t end) {
    ParticleTracer tracer(world, options);
    for (std::size_t b = begin; b < end; ++b)
      tracer.trace(first + static_cast<std::uint32_t>(b * kParticleBatch), std::min(kParticleBatch, count - b * kParticleBatch), found[b],
                   counts[b]);
  });
  std::vector<ParticleVertex> vertices;
  for (std::size_t b = 0; b < batches; ++b) {
    vertices.insert(vertices.end(), found[b].begin(), found[b].end());
    rays += counts[b];
  }
  return vertices;
}

std::size_t particles_for(std::size_t wanted, std::size_t most, const World& world, const ParticleOptions& options, const Context& context,
                          RayCounts& rays) {
  return samples_for(wanted, most, [&](std::size_t first, std::size_t count) {
    return trace_particles(world, options, static_cast<std::uint32_t>(first), count, context, rays).size();
  });
}

}  // namespace sightline::vpl
