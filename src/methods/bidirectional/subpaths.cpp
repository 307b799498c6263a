#include "methods/bidirectional/subpaths.h"

#include <algorithm>
#include <cmath>

#include "base/math/vec3_batch.h"
#include "methods/bidirectional/dimensions.h"
#include "shade/material_eval.h"

namespace sightline::bidirectional {
namespace {

using dimension::pair_of;

}  // namespace

SubpathTracer::SubpathTracer(const World& world, const View& view, const CameraImportance& camera, const PathOptions& options)
    : world_(world),
      view_(view),
      camera_(camera),
      options_(options),
      has_mix_(false),
      medium_rays_(world),
      camera_medium_(medium_rays_.around_camera(view)),
      terminator_(world) {
  for (const Material& material : world.scene().materials) has_mix_ |= std::holds_alternative<MixMaterial>(material.model);
}

void SubpathTracer::random_numbers(const SampleBatch& batch, std::uint32_t pair, AlignedVector<float>& u, AlignedVector<float>& v) {
  const std::size_t count = walks_.size();
  for (auto* array : {&key_, &index_}) array->resize(padded(count));
  for (std::size_t i = 0; i < count; ++i) key_[i] = batch.key[walks_[i].path], index_[i] = batch.sample[walks_[i].path];
  u.resize(padded(count)), v.resize(padded(count));
  sobol_2d(key_.data(), index_.data(), pair, count, u.data(), v.data());
}

void SubpathTracer::trace(BatchKind kind, RayCounts& counts) {
  world_.tracer().intersect(rays_, hits_, kind, counts);
  world_.surfaces(rays_, hits_, surfaces_);
  const Media& media = medium_rays_.media();
  if (!media.any() && !media.any_interface()) return;
  // Beer-Lambert on the way, and on behind what only bounds a medium: that is no vertex.
  medium_.resize(walks_.size());
  for (std::size_t i = 0; i < walks_.size(); ++i) medium_[i] = walks_[i].medium;
  const std::span<const Color> left = medium_rays_.travel(rays_, hits_, surfaces_, medium_, counts);
  for (std::size_t i = 0; i < walks_.size(); ++i) walks_[i].beta *= left[i], walks_[i].medium = medium_[i];
}

void SubpathTracer::trace_light_paths(const SampleBatch& batch, RayCounts& counts) {
  light_.clear();
  last_light_.assign(batch.count, kNoVertex);
  ends_.assign(batch.count, {});
  const LightTable& lights = world_.lights();
  if (lights.size() == 0) return;
  walks_.resize(batch.count);
  for (std::size_t i = 0; i < batch.count; ++i) walks_[i] = Walk{.path = static_cast<std::uint32_t>(i)};
  random_numbers(batch, kEmissionPick, u0_, u1_);
  random_numbers(batch, kEmissionPoint, u1_, u2_);
  random_numbers(batch, kEmissionDirection, u3_, u4_);

  rays_.resize(batch.count);
  std::size_t kept = 0;
  for (std::uint32_t path = 0; path < batch.count; ++path) {
    if (!batch.in_picture[path]) continue;
    LightEnd& end = ends_[path];
    end.sample = lights.sample_emission(u0_[path], {u1_[path], u2_[path]}, {u3_[path], u4_[path]});
    const EmissionSample& s = end.sample;
    end.valid = s.pdf.start > 0 && !is_black(s.radiance);
    if (!end.valid || !(s.pdf.leave > 0) || options_.max_bounces < 0) continue;
    const bool is_surface = !is_black(s.normal);
    Walk walk;
    walk.path = path;
    walk.from = s.point, walk.normal = s.normal;
    walk.from_infinity = s.is_infinite;
    const float cosine = is_surface ? std::fabs(glm::dot(s.normal, s.direction)) : 1.f;
    walk.beta = s.radiance * (cosine / (s.pdf.start * s.pdf.leave));
    if (!is_finite(walk.beta) || is_black(walk.beta)) continue;
    walk.scale = 1 / max_component(walk.beta);
    walk.pdf = s.pdf.leave;
    // Rays find geometry that glows and the environment: the strategy without light vertices.
    walk.mis.previous_sum = !s.is_delta && (s.is_mesh || s.is_infinite) ? 1 : 0;
    walk.mis.previous_pdf = s.pdf.start;
    walk.cone_spread = 0;
    walks_[kept] = walk;
    const Vec3 origin = is_surface ? offset_origin(s.point, s.normal, s.point_error, s.direction) : s.point;
    rays_.set(kept, {origin, 0, s.direction, kInfinity});
    ++kept;
  }
  walks_.resize(kept);
  rays_.resize(kept);
  if (medium_rays_.media().any()) {
    medium_.resize(kept);
    medium_rays_.find(rays_, medium_, counts);
    for (std::size_t i = 0; i < kept; ++i) {
      if (!walks_[i].from_infinity) ends_[walks_[i].path].medium = walks_[i].medium = medium_[i];
    }
  }

  // A light subpath of this many surfaces, connected to the camera, is as long as paths may be.
  for (int bounce = 0; bounce <= options_.max_bounces && !walks_.empty(); ++bounce) {
    trace(BatchKind::bounce, counts);
    if (has_mix_) random_numbers(batch, light_pair(static_cast<std::uint32_t>(bounce), kMix), u4_, u5_);
    const std::size_t first = light_.size();
    make_vertices<Side::light>(nullptr, has_mix_ ? std::span<const float>(u4_) : std::span<const float>(), light_);
    for (std::size_t v = first; v < light_.size(); ++v) last_light_[light_[v].path] = static_cast<std::uint32_t>(v);
    if (bounce == options_.max_bounces) break;
    random_numbers(batch, light_pair(static_cast<std::uint32_t>(bounce), kLightLobe), u0_, u1_);
    random_numbers(batch, light_pair(static_cast<std::uint32_t>(bounce), kLightTurn), u2_, u3_);
    scatter<Side::light>(light_, first, bounce >= options_.roulette_start);
  }
}

void SubpathTracer::trace_eye_paths(SampleBatch& batch, RayCounts& counts) {
  eye_.clear();
  walks_.resize(batch.count);
  for (std::size_t i = 0; i < batch.count; ++i) walks_[i] = Walk{.path = static_cast<std::uint32_t>(i)};
  random_numbers(batch, dimension::kPixel, u0_, u1_);
  u2_.resize(u0_.size()), u3_.resize(u0_.size());
  if (view_.has_lens()) random_numbers(batch, dimension::kLens, u2_, u3_);
  rays_.resize(batch.count);
  view_.primary_rays(batch.pixel.data(), u0_.data(), u1_.data(), u2_.data(), u3_.data(), batch.count,
                     {rays_.origin.x.data(), rays_.origin.y.data(), rays_.origin.z.data(), rays_.direction.x.data(),
                      rays_.direction.y.data(), rays_.direction.z.data()});
  for (std::size_t i = 0; i < batch.count; ++i) {
    rays_.t_near[i] = 0, rays_.t_far[i] = batch.in_picture[i] ? kInfinity : -1.f;
    Walk& walk = walks_[i];
    walk.from = load(rays_.origin, i);
    walk.from_infinity = camera_.is_orthographic();
    walk.pdf = camera_.pdf(walk.from, load(rays_.direction, i));
    walk.mis.connect = options_.light_image ? 1 : 0;
    walk.medium = camera_medium_;
    walk.cone_width = view_.cone_width(), walk.cone_spread = view_.cone_spread();
  }
  for (int bounce = 0; bounce <= options_.max_bounces + 1 && !walks_.empty(); ++bounce) {
    trace(bounce == 0 ? BatchKind::primary : BatchKind::bounce, counts);
    if (has_mix_) random_numbers(batch, pair_of(static_cast<std::uint32_t>(bounce), dimension::kLightPick), u5_, u4_);
    const std::size_t first = eye_.size();
    make_vertices<Side::eye>(&batch, has_mix_ ? std::span<const float>(u4_) : std::span<const float>(), eye_);
    if (bounce == options_.max_bounces + 1) {
      // Only good for light that they found themselves: no path goes on from there.
      if (bounce > 0) eye_.resize(first);
      break;
    }
    random_numbers(batch, pair_of(static_cast<std::uint32_t>(bounce), dimension::kLobe), u0_, u1_);
    random_numbers(batch, pair_of(static_cast<std::uint32_t>(bounce), dimension::kDirection), u2_, u3_);
    scatter<Side::eye>(eye_, first, bounce >= options_.roulette_start);
  }
}

// Surfaces at the ends of the rays become vertices; walks are compacted to those that have one, in the same order.
template <SubpathTracer::Side side>
void SubpathTracer::make_vertices(SampleBatch* batch, std::span<const float> u_mix, std::vector<PathVertex>& vertices) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < walks_.size(); ++i) {
    Walk& walk = walks_[i];
    const Vec3 direction = load(rays_.direction, i);
    if (!hits_.hit(i)) {
      if (side == Side::eye && batch->in_picture[walk.path]) add_environment(*batch, i);
      continue;
    }
    const Vec3 position = load(surfaces_.position, i), normal = load(surfaces_.geometric_normal, i);
    const Vec3 edge = position - walk.from;
    const double squared = walk.from_infinity ? 1.0 : static_cast<double>(length_squared(edge));
    const double cosine = std::fabs(static_cast<double>(glm::dot(normal, direction)));
    if (!(squared > 0) || !(cosine > 0)) continue;
    // Densities become densities by area of this vertex, and those of the other side by area of the one before.
    const double previous_cosine = is_black(walk.normal) ? 1 : std::fabs(static_cast<double>(glm::dot(walk.normal, direction)));
    arrive(walk.mis, walk.pdf, cosine, previous_cosine, squared);
    if (side == Side::light) {
      walk.beta /= static_cast<float>(cosine);
      if (walk.depth == 0) {
        // Light sampling may choose points by other densities than paths that begin there.
        const EmissionSample& s = ends_[walk.path].sample;
        walk.mis.connect = 1;
        if (!s.is_delta) {
          const double direct = s.is_infinite
                                    ? static_cast<double>(world_.lights().environment_pdf(position, normal, -direction))
                                    : static_cast<double>(world_.lights().pdf(position, normal, s.light, s.point, s.normal, -direction)) *
                                          walk.mis.to_previous;
          walk.mis.connect = options_.heuristic(direct / static_cast<double>(s.pdf.start));
        }
      }
    }
    if (!std::isfinite(walk.mis.pdf) || !(walk.mis.pdf > 0)) continue;
    if (side == Side::eye && surfaces_.light[i] != kNoLight) add_emission(*batch, i);

    PathVertex vertex;
    start_vertex(i, u_mix.empty() ? 0.f : u_mix[i], vertex);
    vertex.to_previous = -direction;
    if (side == Side::eye && walk.depth == 0 && !batch->guides.empty()) {
      batch->guides[walk.path] = {vertex.surface.bsdf.albedo(),
                                  frame_seen_from(vertex.surface, -direction).normal,
                                  position,
                                  glm::length(position - load(rays_.origin, i)),
                                  true,
                                  surfaces_.light[i] != kNoLight};
    }
    vertices.push_back(vertex);
    // What the next ray needs stays with the walk; rays are made anew.
    walk.cone_width += walk.cone_spread * hits_.t[i];
    walk.vertex = static_cast<std::uint32_t>(vertices.size() - 1);
    walks_[kept] = walk;
    ++kept;
  }
  walks_.resize(kept);
}

void SubpathTracer::start_vertex(std::size_t i, float u_mix, PathVertex& vertex) const {
  const Walk& walk = walks_[i];
  Surface& surface = vertex.surface;
  surface.position = load(surfaces_.position, i);
  surface.geometric_normal = load(surfaces_.geometric_normal, i);
  surface.error = surfaces_.error[i];
  surface.plain = surfaces_.plain[i] != 0;
  if (ShadowTerminator::is_on(surfaces_) && terminator_.applies(rays_, surfaces_, i)) {
    surface.is_lifted = true;
    surface.lifted_position = ShadowTerminator::lifted(rays_, surfaces_, i);
    surface.lifted_normal = load(surfaces_.shading_normal, i);
  }
  const std::uint32_t index = surfaces_.material[i];
  MaterialId material = index == kDefaultMaterial ? MaterialId{} : MaterialId{index};
  if (surface.plain) {
    surface.frame = frame_from_normal(load(surfaces_.shading_normal, i));
    surface.bsdf = Bsdf(Lambert{load(surfaces_.albedo, i)});
  } else {
    const Scene& scene = world_.scene();
    const SurfaceDetail detail = world_.detail(rays_, hits_, i, walk.cone_width + walk.cone_spread * hits_.t[i]);
    material = resolve_mix(scene, world_.textures(), material, detail.texture, u_mix);
    surface.tangent = detail.frame.tangent;
    surface.frame = perturb_frame(scene, world_.textures(), material, detail.texture, detail.frame, detail.dp_du, detail.dp_dv,
                                  detail.dn_du, detail.dn_dv, surface.geometric_normal, Vec3(0));
    surface.bsdf = make_bsdf(scene, world_.textures(), material, detail.texture, u_mix);
  }
  if (medium_rays_.media().any() && material.valid() && material.index < world_.scene().materials.size())
    surface.interior = world_.scene().materials[material.index].interior;
  vertex.connectible = !surface.bsdf.is_delta();
  vertex.beta = walk.beta;
  vertex.mis = walk.mis;
  vertex.medium = walk.medium;
  vertex.path = walk.path;
  vertex.previous = walk.vertex;
  vertex.depth = walk.depth + 1;
}

template <SubpathTracer::Side side>
void SubpathTracer::scatter(std::vector<PathVertex>& vertices, std::size_t first, bool roulette) {
  std::size_t kept = 0;
  rays_.resize(walks_.size());
  for (std::size_t i = 0; i < walks_.size(); ++i) {
    const PathVertex& vertex = vertices[first + i];
    const Surface& surface = vertex.surface;
    const std::optional<ScatterSample> sample = side == Side::eye
                                                    ? sample_from_eye(surface, vertex.to_previous, u0_[i], {u2_[i], u3_[i]})
                                                    : sample_from_light(surface, vertex.to_previous, u0_[i], {u2_[i], u3_[i]});
    if (!sample || !(sample->pdf > 0)) continue;
    Walk walk = walks_[i];
    walk.beta *= sample->weight;
    if (is_black(walk.beta) || !is_finite(walk.beta)) continue;
    // Radiance that refraction compresses comes back when the path leaves the glass: roulette must not take it for dark.
    if (side == Side::eye && sample->crosses) walk.scale *= sample->eta * sample->eta;
    if (roulette) {
      const float survival = std::min(0.95f, max_component(walk.beta) * walk.scale);
      if (u1_[i] >= survival) continue;
      walk.beta /= survival;
    }
    walk.depth = vertex.depth;
    walk.from = surface.position, walk.normal = surface.geometric_normal;
    walk.from_infinity = false;
    walk.pdf = sample->pdf;
    walk.mis = after(vertex.mis, options_.heuristic, static_cast<double>(sample->pdf_reverse), sample->is_delta);
    if (sample->crosses) walk.medium = glm::dot(sample->direction, surface.side_normal()) < 0 ? surface.interior : MediumId{};
    // A rough bounce blurs what lies behind it: a wider cone, coarser texture levels.
    if (side == Side::eye && !sample->is_delta) walk.cone_spread = std::max(walk.cone_spread, 0.25f);
    rays_.set(kept, {offset_origin(surface.leaving_position(), surface.side_normal(), surface.error, sample->direction), 0,
                     sample->direction, kInfinity});
    walks_[kept++] = walk;
  }
  walks_.resize(kept);
  rays_.resize(kept);
}

void SubpathTracer::add_emission(SampleBatch& batch, std::size_t i) {
  const Walk& walk = walks_[i];
  const LightTable& lights = world_.lights();
  const std::uint32_t light = surfaces_.light[i];
  const Vec3 direction = load(rays_.direction, i);
  const Vec3 position = load(surfaces_.position, i), normal = load(surfaces_.geometric_normal, i);
  TexturePoint texture;
  if (!surfaces_.plain[i]) texture = world_.detail(rays_, hits_, i, walk.cone_width + walk.cone_spread * hits_.t[i]).texture;
  const Color emission = lights.emission(light, texture, glm::dot(normal, direction) < 0);
  if (is_black(emission)) return;
  const EmissionPdf pdf = lights.emission_pdf(light, position, -direction);
  LightDensities densities{0, pdf.start, pdf.leave};
  const bool seen_by_camera = walk.depth == 0;
  if (!seen_by_camera) {
    const double cosine = std::fabs(static_cast<double>(glm::dot(normal, direction)));
    densities.direct = static_cast<double>(lights.pdf(walk.from, walk.normal, light, position, normal, direction)) * cosine /
                       static_cast<double>(length_squared(position - walk.from));
  }
  const double weight = emission_weight(options_.heuristic, densities, walk.mis, seen_by_camera);
  batch.add(walk.path, walk.depth <= 1, walk.beta * emission * static_cast<float>(weight));
}

void SubpathTracer::add_environment(SampleBatch& batch, std::size_t i) {
  const LightTable& lights = world_.lights();
  if (!lights.has_environment()) return;
  const Walk& walk = walks_[i];
  const Vec3 direction = load(rays_.direction, i);
  double weight = 1;
  if (walk.depth > 0) {
    const EmissionPdf pdf = lights.emission_pdf(lights.environment_entry(), walk.from, -direction);
    MisVertex hit = walk.mis;
    hit.pdf = walk.pdf;
    hit.to_previous = std::fabs(static_cast<double>(glm::dot(walk.normal, direction)));
    const LightDensities densities{lights.environment_pdf(walk.from, walk.normal, direction), pdf.start, pdf.leave};
    weight = emission_weight(options_.heuristic, densities, hit, false);
  }
  batch.add(walk.path, walk.depth <= 1, walk.beta * lights.environment(direction) * static_cast<float>(weight));
}

}  // namespace sightline::bidirectional
