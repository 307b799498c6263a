#include "methods/visibility_cache/virtual_point_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/visibility_cache/judge_paths.h"
#include "methods/visibility_cache/vpl_candidates.h"
#include "methods/visibility_cache/vpl_density.h"

namespace sightline {
namespace {

using vpl::Candidate;

constexpr std::uint32_t kKey = 0x56504c73u;  // light paths of their own, whatever pixels draw
constexpr std::size_t kNeighbours = 8;
constexpr std::size_t kMostTries = 32;  // for each candidate that is wanted: where light hardly gets in

enum Stream : std::uint32_t { kJudges, kParticleTrial, kParticles, kJudgePathTrial, kJudgePaths, kChoice };

/// A candidate that was chosen, and how often over how often was expected.
struct Survivor {
  std::uint32_t candidate;
  float scale;
};

std::uint64_t spread_bits(std::uint32_t x) {
  std::uint64_t v = x & 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffull;
  v = (v | v << 16) & 0x1f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

// Neighbours in space beside each other: a systematic choice along the list is then stratified over the surfaces.
void sort_in_space(const Bounds& bounds, std::vector<Candidate>& candidates) {
  const Vec3 extent = glm::max(bounds.extent(), Vec3(std::numeric_limits<float>::min()));
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(candidates.size());
  for (std::uint32_t i = 0; i < candidates.size(); ++i) {
    const Vec3 cell = glm::clamp((candidates[i].surface.position - bounds.lower) / extent, 0.f, 1.f) * 1023.f;
    order[i] = {spread_bits(static_cast<std::uint32_t>(cell.x)) | spread_bits(static_cast<std::uint32_t>(cell.y)) << 1 |
                    spread_bits(static_cast<std::uint32_t>(cell.z)) << 2,
                i};
  }
  std::sort(order.begin(), order.end(), [&](const auto& a, const auto& b) {
    if (a.first != b.first) return a.first < b.first;
    const Vec3 &p = candidates[a.second].surface.position, &q = candidates[b.second].surface.position;
    if (p != q) return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
    return a.second < b.second;
  });
  std::vector<Candidate> sorted;
  sorted.reserve(candidates.size());
  for (const auto& [code, i] : order) sorted.push_back(candidates[i]);
  candidates.swap(sorted);
}

// Paths from the eye end at the same place with light of one bounce, of two, ... Where that goes on alike, they are one light. Sorted.
void merge_coincident(std::vector<Candidate>& candidates) {
  const auto cosine = [](const Candidate& c) {
    return std::fabs(glm::dot(c.wi, vpl::frame_towards(c.surface.frame, c.surface.geometric_normal, c.wi, c.surface.plain).normal));
  };
  std::size_t kept = 0;
  for (Candidate& c : candidates) {
    if (kept > 0) {
      Candidate& last = candidates[kept - 1];
      if (last.surface.position == c.surface.position && last.normal == c.normal && last.is_lambert() && c.is_lambert()) {
        const float mine = cosine(last), others = cosine(c);
        // The one with the greater cosine stands for both.
        if (others > mine) {
          last.beta = c.beta + last.beta * (mine / others);
          last.wi = c.wi;
        } else if (mine > 0) {
          last.beta += c.beta * (others / mine);
        }
        last.importance += c.importance;
        continue;
      }
    }
    candidates[kept++] = c;
  }
  candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(kept), candidates.end());
}

/// Of candidates with their importances `count` by systematic resampling [Segovia2006]; all where there are no more than that.
std::vector<Survivor> resample(std::span<const Candidate> candidates, std::size_t count, float u) {
  std::vector<Survivor> survivors;
  double sum = 0, power = 0;
  for (const Candidate& candidate : candidates)
    sum += static_cast<double>(candidate.importance), power += static_cast<double>(candidate.power());
  // What the judges do not see may still light what others see. Deviation: besides a constant, a share goes by power, so that no light
  // can be brighter than all of them together divided by that share of the count.
  const double least = 0.01 * sum / static_cast<double>(candidates.size()), of_power = power > 0 ? 0.05 * sum / power : 0;
  const auto weight = [&](const Candidate& c) {
    if (!(sum > 0)) return static_cast<double>(c.power());
    return static_cast<double>(c.importance) + least + of_power * static_cast<double>(c.power());
  };
  double total = 0;
  for (const Candidate& candidate : candidates) total += weight(candidate);
  if (candidates.size() <= count || !(total > 0) || !std::isfinite(total)) {
    for (std::uint32_t i = 0; i < candidates.size(); ++i) survivors.push_back({i, 1});
    return survivors;
  }
  const double step = total / static_cast<double>(count);
  double next = static_cast<double>(u) * step, reached = 0;
  for (std::uint32_t i = 0; i < candidates.size(); ++i) {
    const double share = weight(candidates[i]);
    reached += share;
    std::size_t hits = 0;
    for (; next < reached; next += step) ++hits;
    if (hits > 0) survivors.push_back({i, static_cast<float>(static_cast<double>(hits) * step / share)});
  }
  return survivors;
}

VirtualPointLights lights_of(std::span<const Candidate> candidates, std::span<const Survivor> survivors) {
  VirtualPointLights lights;
  lights.size = survivors.size();
  for (Vec3Batch* batch : {&lights.position, &lights.normal, &lights.flux, &lights.radiosity}) batch->resize(lights.size);
  lights.error.resize(padded(lights.size)), lights.cell_area.resize(padded(lights.size)), lights.lambert.resize(padded(lights.size));
  lights.wi.resize(lights.size), lights.frame.resize(lights.size), lights.bsdf.resize(lights.size);
  lights.lobes.resize(lights.size);
  for (std::size_t i = 0; i < lights.size; ++i) {
    const Candidate& candidate = candidates[survivors[i].candidate];
    const Color beta = candidate.beta * survivors[i].scale;
    store(lights.position, i, candidate.surface.position);
    store(lights.normal, i, candidate.normal);
    store(lights.flux, i, beta * std::fabs(glm::dot(candidate.normal, candidate.wi)));
    lights.error[i] = candidate.surface.error;
    lights.lambert[i] = candidate.is_lambert();
    if (candidate.is_lambert()) store(lights.radiosity, i, candidate.sent(candidate.wi) * survivors[i].scale);
    lights.wi[i] = candidate.wi;
    lights.frame[i] = candidate.surface.frame;
    lights.bsdf[i] = candidate.surface.bsdf;
    lights.lobes[i] = lights.bsdf[i].lobes(lights.frame[i].to_local(lights.wi[i]));
  }
  return lights;
}

}  // namespace

Color radiance_towards(const VirtualPointLights& lights, std::size_t i, const Vec3& w) {
  const Vec3 normal = load(lights.normal, i);
  if (lights.lambert[i]) return glm::dot(normal, w) > 0 ? load(lights.radiosity, i) : Color(0);
  const Vec3& wi = lights.wi[i];
  // Frames keep the side of the winding, by which glass knows its inside.
  const Vec3 geometric = glm::dot(normal, lights.frame[i].normal) < 0 ? -normal : normal;
  return vpl::scattered(lights.bsdf[i], lights.frame[i], geometric, false, w, wi) * load(lights.flux, i) / glm::dot(normal, wi);
}

VirtualPointLights make_virtual_point_lights(const World& world, const View& view, const VirtualPointLightOptions& options,
                                             const Context& context, RayCounts& rays) {
  const float radius = world.bounds().half_diagonal();
  const float nearest = options.clamp_distance * radius;
  const float max_geometry_term = nearest > 0 ? 1 / (nearest * nearest) : std::numeric_limits<float>::infinity();
  std::vector<Candidate> candidates;
  const auto wanted = static_cast<std::size_t>(std::max(options.count, 0));
  const auto stream = [&](Stream s) { return hash_combine(pixel_key(options.seed, kKey), s); };

  if (wanted > 0 && options.max_bounces > 0 && world.lights().size() > 0) {
    const auto judge_count = static_cast<std::size_t>(std::max(options.eye_samples, 0));
    const std::vector<vpl::Judge> judges =
        vpl::find_judges(world, view, stream(kJudges), options.pass * static_cast<std::uint32_t>(judge_count), judge_count, rays);
    context.check_cancelled();

    const std::size_t total = wanted * static_cast<std::size_t>(std::max(options.candidates, 1));
    const float share = std::clamp(options.backward_share, 0.f, 1.f);
    vpl::CandidateCounts counts;
    const auto backward_wanted =
        judges.empty() ? std::size_t{0} : static_cast<std::size_t>(std::lround(static_cast<double>(total) * static_cast<double>(share)));
    const vpl::JudgePathOptions path_trial{options.max_bounces, stream(kJudgePathTrial)}, paths{options.max_bounces, stream(kJudgePaths)};
    counts.from_judges = vpl::judge_paths_for(backward_wanted, backward_wanted * kMostTries, world, judges, path_trial, context, rays);
    const std::size_t vertices = total - backward_wanted;
    const vpl::ParticleOptions trial{options.max_bounces, stream(kParticleTrial)}, particles{options.max_bounces, stream(kParticles)};
    counts.particles = vpl::particles_for(vertices, vertices * kMostTries, world, trial, context, rays);

    candidates = vpl::candidates_of(vpl::trace_particles(world, particles, options.pass * static_cast<std::uint32_t>(counts.particles),
                                                         counts.particles, context, rays),
                                    counts.particles);
    const std::vector<Candidate> backward = vpl::trace_judge_paths(
        world, judges, paths, options.pass * static_cast<std::uint32_t>(counts.from_judges), counts.from_judges, context, rays);
    candidates.insert(candidates.end(), backward.begin(), backward.end());
    vpl::weigh(world, judges, judge_count, counts, max_geometry_term, candidates, context, rays);
    std::erase_if(candidates, [](const Candidate& c) { return !(c.power() > 0) && !(c.importance > 0); });
    sort_in_space(world.bounds(), candidates);
    merge_coincident(candidates);
  }

  const float u = sobol_2d(stream(kChoice), options.pass, 0).x;
  VirtualPointLights lights = lights_of(candidates, resample(candidates, wanted, u));
  lights.max_geometry_term = max_geometry_term;
  std::vector<Vec3> positions(lights.size);
  for (std::size_t i = 0; i < lights.size; ++i) positions[i] = load(lights.position, i);
  // Densities above 1e4 M / B_R² are those of caustics and corners: finer cells than the shadows need.
  const float squared = radius * radius;
  const std::vector<float> areas = vpl::neighbour_areas(
      positions, kNeighbours, squared * 1e-4f / static_cast<float>(std::max<std::size_t>(wanted, 1)), kPi * squared, context);
  std::copy(areas.begin(), areas.end(), lights.cell_area.begin());
  return lights;
}

}  // namespace sightline
