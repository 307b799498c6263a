#include "methods/bidirectional/connections.h"

#include <algorithm>
#include <cmath>

#include "base/math/vec3_batch.h"
#include "methods/bidirectional/dimensions.h"
#include "methods/bidirectional/vertex_density.h"
#include "visibility/query_rays.h"

namespace sightline::bidirectional {
namespace {

using dimension::pair_of;

double abs_cosine(const Vec3& normal, const Vec3& direction) { return std::fabs(static_cast<double>(glm::dot(normal, direction))); }

/// The normal on the side that the path arrived from.
Vec3 facing_normal(const PathVertex& vertex) {
  const Vec3& n = vertex.surface.side_normal();
  return glm::dot(n, vertex.to_previous) < 0 ? -n : n;
}

std::uint32_t vertex_id(const SampleBatch& batch, const PathVertex& vertex, std::uint32_t side) {
  return hash_combine(hash_combine(batch.key[vertex.path], batch.sample[vertex.path]), 2 * vertex.depth + side);
}

/// Ends and queries grow as connections are found; what is not used is cut off at the end.
class QueryWriter {
 public:
  QueryWriter(ConnectionQueries& out, std::size_t eyes, std::size_t lights, std::size_t queries) : out_(out) {
    out.clear();
    out.queries.eye.resize(eyes);
    out.queries.resize_lights(lights);
    out.queries.resize_queries(queries);
    out.contribution.reserve(queries), out.path.reserve(queries), out.direct.reserve(queries);
  }
  void add(std::size_t eye, std::size_t light, const Color& contribution, std::uint32_t path, bool direct) {
    const std::size_t at = out_.contribution.size();
    if (at == out_.queries.size) out_.queries.resize_queries(2 * at + kLanes);
    out_.queries.eye_of[at] = static_cast<std::uint32_t>(eye);
    out_.queries.light_of[at] = static_cast<std::uint32_t>(light);
    out_.contribution.push_back(contribution), out_.path.push_back(path), out_.direct.push_back(direct);
  }
  void finish(std::size_t eyes, std::size_t lights) {
    out_.queries.eye.resize(eyes);
    out_.queries.resize_lights(lights);
    out_.queries.resize_queries(out_.contribution.size());
  }

 private:
  ConnectionQueries& out_;
};

}  // namespace

void ConnectionQueries::clear() {
  queries.eye.resize(0), queries.resize_lights(0), queries.resize_queries(0);
  queries.kind = BatchKind::shadow_diffuse;
  contribution.clear(), path.clear(), direct.clear(), medium.clear();
}

void ConnectionQueries::add_answers(std::span<const float> weights, SampleBatch& batch) const {
  for (std::size_t i = 0; i < queries.size; ++i) {
    if (weights[i] != 0) batch.add(path[i], direct[i] != 0, weights[i] * contribution[i]);
  }
}

Connector::Connector(const World& world, const CameraImportance& camera, const PathOptions& options, const VertexDensity* density)
    : world_(world), camera_(camera), options_(options), density_(density), medium_rays_(world) {}

void Connector::absorb(std::span<const float> weights, ConnectionQueries& queries, RayCounts& rays) {
  if (queries.medium.empty()) return;
  arriving_.resize(queries.queries.size);
  medium_.clear(), connection_.clear();
  for (std::uint32_t i = 0; i < queries.queries.size; ++i) {
    if (weights[i] == 0 || (!queries.medium[i].valid() && !medium_rays_.media().any_interface())) continue;
    arriving_.set(connection_.size(), query_ray(queries.queries, i));
    medium_.push_back(queries.medium[i]), connection_.push_back(i);
  }
  arriving_.resize(connection_.size());
  const std::span<const Color> left = medium_rays_.attenuate(arriving_, medium_, rays);
  for (std::size_t k = 0; k < connection_.size(); ++k) queries.contribution[connection_[k]] *= left[k];
}

// A point on a light for each eye vertex [Veach1997, §10.3.4], with the densities of paths that begin there.
void Connector::connect_light_samples(const SampleBatch& batch, const SubpathTracer& paths, ConnectionQueries& out) {
  const std::span<const PathVertex> eyes = paths.eye_vertices();
  QueryWriter writer(out, eyes.size(), eyes.size(), eyes.size());
  out.queries.split = QuerySplit::eye;
  out.queries.surface_ends = SurfaceEnds::area_light;
  std::size_t ends = 0;
  const LightTable& lights = world_.lights();
  for (std::size_t begin = 0; begin < eyes.size() && lights.size() > 0;) {
    // Vertices of one depth stand together and share their dimensions.
    const std::uint32_t depth = eyes[begin].depth;
    vertex_of_.clear();
    std::size_t end = begin;
    for (; end < eyes.size() && eyes[end].depth == depth; ++end) {
      if (eyes[end].connectible) vertex_of_.push_back(static_cast<std::uint32_t>(end));
    }
    begin = end;
    if (depth > static_cast<std::uint32_t>(options_.max_bounces) + 1) break;
    const std::size_t count = vertex_of_.size();
    position_.resize(count), normal_.resize(count);
    for (auto* array : {&key_, &index_}) array->resize(padded(count));
    for (auto* array : {&u_pick_, &u0_, &u1_}) array->resize(padded(count));
    for (std::size_t i = 0; i < count; ++i) {
      const PathVertex& eye = eyes[vertex_of_[i]];
      const Vec3 &p = eye.surface.position, &n = eye.surface.geometric_normal;
      position_.x[i] = p.x, position_.y[i] = p.y, position_.z[i] = p.z;
      normal_.x[i] = n.x, normal_.y[i] = n.y, normal_.z[i] = n.z;
      key_[i] = batch.key[eye.path], index_[i] = batch.sample[eye.path];
    }
    if (lights.size() > 1) sobol_1d(key_.data(), index_.data(), pair_of(depth - 1, dimension::kLightPick), count, u_pick_.data());
    sobol_2d(key_.data(), index_.data(), pair_of(depth - 1, dimension::kLightPoint), count, u0_.data(), u1_.data());
    lights.sample(position_, normal_, u_pick_, u0_, u1_, count, samples_);
    for (std::size_t i = 0; i < count; ++i) {
      const PathVertex& eye = eyes[vertex_of_[i]];
      Color contribution;
      if (!batch.in_picture[eye.path] || !connect_sample(eye, i, contribution)) continue;
      const bool infinite = std::isinf(samples_.distance[i]);
      const Vec3 n = load(samples_.normal, i), wi = load(samples_.wi, i);
      QuerySemantic semantic = QuerySemantic::surface;
      if (samples_.is_delta[i]) semantic = infinite ? QuerySemantic::direction : QuerySemantic::point;
      if (!samples_.is_delta[i] && infinite) semantic = QuerySemantic::solid_angle;
      // Area (or solid angle) of the light that one sample stands for: 1 / P [Popov2013, Eq. 7 with one light sample an eye path].
      float area = 1 / samples_.pdf[i];
      if (semantic == QuerySemantic::surface)
        area *= samples_.distance[i] * samples_.distance[i] / std::max(1e-6f, std::fabs(glm::dot(n, wi)));
      out.queries.eye.set(ends, eye.surface.leaving_position(), facing_normal(eye), eye.surface.error,
                          density_ ? density_->eye_cell_area(eye) : 0.f, vertex_id(batch, eye, 0));
      out.queries.light.set(ends, infinite ? wi : load(samples_.point, i), glm::dot(n, wi) > 0 ? -n : n, samples_.point_error[i],
                            density_ ? area : 0.f, vertex_id(batch, eye, 1));
      out.queries.semantic[ends] = static_cast<std::uint8_t>(semantic);
      writer.add(ends, ends, contribution, eye.path, depth == 1);
      if (medium_rays_.media().any()) out.medium.push_back(medium_towards(eye, load(samples_.wi, i)));
      ++ends;
    }
  }
  writer.finish(ends, ends);
}

bool Connector::connect_sample(const PathVertex& eye, std::size_t lane, Color& contribution) const {
  if (!(samples_.pdf[lane] > 0)) return false;
  const Vec3 wi = load(samples_.wi, lane);
  const ScatterEval eval = evaluate_scatter(eye.surface, eye.to_previous, wi);
  if (is_black(eval.f_cos)) return false;
  const bool infinite = std::isinf(samples_.distance[lane]), delta = samples_.is_delta[lane] != 0;
  const float distance = samples_.distance[lane];
  contribution = eye.beta * eval.f_cos * load(samples_.radiance, lane) / samples_.pdf[lane];
  if (is_black(contribution)) return false;

  const double squared = infinite ? 1.0 : static_cast<double>(distance) * static_cast<double>(distance);
  const double at_light = delta || infinite ? 1.0 : abs_cosine(load(samples_.normal, lane), wi) / squared;
  const EmissionPdf emission = world_.lights().emission_pdf(samples_.light[lane], load(samples_.point, lane), -wi);
  LightDensities densities;
  densities.direct = static_cast<double>(samples_.pdf[lane]) * at_light;
  densities.start = emission.start;
  densities.leave = static_cast<double>(emission.leave) * abs_cosine(eye.surface.geometric_normal, wi) / squared;
  const bool findable = !delta && (samples_.is_mesh[lane] || infinite);
  const double eye_sum = eye.mis.sum(options_.heuristic, static_cast<double>(eval.pdf_light), false);
  const double weight =
      light_sample_weight(options_.heuristic, densities, findable ? static_cast<double>(eval.pdf_eye) * at_light : 0.0, eye.mis, eye_sum);
  contribution *= static_cast<float>(weight);
  return !is_black(contribution);
}

void Connector::connect_vertices(const SampleBatch& batch, const SubpathTracer& paths, ConnectionQueries& out) {
  const std::span<const PathVertex> eyes = paths.eye_vertices(), lights = paths.light_vertices();
  QueryWriter writer(out, eyes.size(), lights.size(), 2 * eyes.size());
  out.queries.split = QuerySplit::symmetric;
  out.queries.surface_ends = SurfaceEnds::path_vertex;
  light_end_of_.assign(lights.size(), kNoQuery);
  std::size_t eye_ends = 0, light_ends = 0;
  const std::uint32_t longest = static_cast<std::uint32_t>(options_.max_bounces) + 1;  // surfaces between light and camera
  for (const PathVertex& eye : eyes) {
    if (!eye.connectible || !batch.in_picture[eye.path]) continue;
    bool used = false;
    for (std::uint32_t y = paths.last_light_vertex()[eye.path]; y != kNoVertex; y = lights[y].previous) {
      const PathVertex& light = lights[y];
      Color contribution;
      if (!light.connectible || eye.depth + light.depth > longest || !connect_pair(eye, light, contribution)) continue;
      if (light_end_of_[y] == kNoQuery) {
        light_end_of_[y] = static_cast<std::uint32_t>(light_ends);
        out.queries.light.set(light_ends, light.surface.leaving_position(), facing_normal(light), light.surface.error,
                              density_ ? density_->light_cell_area(light) : 0.f, vertex_id(batch, light, 1));
        out.queries.semantic[light_ends++] = static_cast<std::uint8_t>(QuerySemantic::surface);
      }
      writer.add(eye_ends, light_end_of_[y], contribution, eye.path, false);
      if (medium_rays_.media().any()) out.medium.push_back(medium_towards(eye, light.surface.position - eye.surface.position));
      used = true;
    }
    if (!used) continue;
    out.queries.eye.set(eye_ends++, eye.surface.leaving_position(), facing_normal(eye), eye.surface.error,
                        density_ ? density_->eye_cell_area(eye) : 0.f, vertex_id(batch, eye, 0));
  }
  writer.finish(eye_ends, light_ends);
}

bool Connector::connect_pair(const PathVertex& eye, const PathVertex& light, Color& contribution) const {
  const Vec3 edge = light.surface.position - eye.surface.position;
  const double squared = static_cast<double>(length_squared(edge));
  if (!(squared > 0)) return false;
  const float distance = static_cast<float>(std::sqrt(squared));
  const Vec3 towards_light = edge / distance;
  const ScatterEval at_eye = evaluate_scatter(eye.surface, eye.to_previous, towards_light);
  if (is_black(at_eye.f_cos)) return false;
  const ScatterEval at_light = evaluate_scatter(light.surface, -towards_light, light.to_previous);
  if (is_black(at_light.f_cos)) return false;
  const double eye_area = abs_cosine(eye.surface.geometric_normal, towards_light) / squared;
  const double light_area = abs_cosine(light.surface.geometric_normal, towards_light) / squared;
  // The eye's cosine is in f_cos, by the shading normal; the light's is the geometric one, as on every edge of an eye path.
  contribution = eye.beta * at_eye.f_cos * at_light.f_cos * light.beta * static_cast<float>(light_area);
  if (is_black(contribution)) return false;
  const Heuristic h = options_.heuristic;
  const double weight = connection_weight(
      h, static_cast<double>(at_eye.pdf_eye) * light_area, light.mis.pdf, light.mis.sum(h, static_cast<double>(at_light.pdf_eye), false),
      static_cast<double>(at_light.pdf_light) * eye_area, eye.mis.pdf, eye.mis.sum(h, static_cast<double>(at_eye.pdf_light), false));
  contribution *= static_cast<float>(weight);
  return !is_black(contribution);
}

// The light image: every vertex of a light subpath, the light's own point included, as the camera sees it.
void Connector::connect_camera(SampleBatch& batch, const SubpathTracer& paths, RayCounts& rays, VisibilityCounts& counts) {
  if (!options_.light_image) return;
  candidates_.clear(), candidate_rays_.clear(), medium_.clear();
  const auto lens = [&](std::uint32_t path, std::uint32_t pair) { return sobol_2d(batch.key[path], batch.sample[path], pair); };
  const std::span<const LightEnd> ends = paths.light_ends();
  for (std::uint32_t path = 0; path < ends.size(); ++path) {
    const EmissionSample& s = ends[path].sample;
    // Points are not seen, nor is what rays pass through; what lies at infinity is found by camera rays alone.
    if (ends[path].valid && s.is_mesh && !s.is_infinite && batch.in_picture[path]) splat(nullptr, ends[path], path, lens(path, kLightLens));
  }
  for (const PathVertex& light : paths.light_vertices()) {
    if (light.connectible) splat(&light, ends[light.path], light.path, lens(light.path, light_pair(light.depth - 1, kLensPoint)));
  }
  rays_.resize(candidates_.size());
  for (std::size_t i = 0; i < candidates_.size(); ++i) rays_.set(i, candidate_rays_[i]);
  occluded_.resize(padded(candidates_.size()));
  world_.tracer().occluded(rays_, occluded_, BatchKind::shadow_diffuse, rays);
  counts.queries += candidates_.size(), counts.traced += candidates_.size();
  std::span<const Color> left;
  if (medium_rays_.media().any()) {
    for (std::size_t i = 0; i < candidates_.size(); ++i) rays_.t_far[i] = occluded_[i] ? -1.f : 1.f;
    left = medium_rays_.attenuate(rays_, medium_, rays);
  }
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    Splat& splat = candidates_[i];
    if (occluded_[i]) continue;
    const std::uint32_t path = splat.sample;
    splat.sample = batch.sample[path];
    if (!left.empty()) splat.value *= left[i];
    batch.splats.push_back(splat);
  }
}

void Connector::splat(const PathVertex* light, const LightEnd& end, std::uint32_t path, const Vec2& lens) {
  const EmissionSample& s = end.sample;
  const Vec3 position = light ? light->surface.position : s.point, normal = light ? light->surface.geometric_normal : s.normal;
  const auto projection = camera_.project(camera_.lens_point(lens), position);
  if (!projection || !(projection->pdf > 0)) return;
  const Vec3 towards_camera = -projection->direction;
  const double squared =
      camera_.is_orthographic() ? 1.0 : static_cast<double>(projection->distance) * static_cast<double>(projection->distance);
  const double area = abs_cosine(normal, towards_camera) / squared;
  const double camera_pdf = projection->pdf * area;  // of the vertex, by area
  Color value;
  double weight = 0;
  const Heuristic h = options_.heuristic;
  if (light) {
    const ScatterEval eval = evaluate_scatter(light->surface, towards_camera, light->to_previous);
    if (is_black(eval.f_cos)) return;
    value = light->beta * eval.f_cos * static_cast<float>(camera_pdf);
    weight = connection_weight(h, camera_pdf, light->mis.pdf, light->mis.sum(h, static_cast<double>(eval.pdf_eye), false), 0, 1, 0);
  } else {
    if (!s.is_two_sided && !(glm::dot(normal, towards_camera) > 0)) return;
    value = s.radiance * static_cast<float>(camera_pdf / static_cast<double>(s.pdf.start));
    weight = connection_weight(h, camera_pdf, s.pdf.start, 1, 0, 1, 0);
  }
  value *= static_cast<float>(weight);
  if (is_black(value)) return;
  const Vec3 start =
      light ? offset_origin(light->surface.leaving_position(), light->surface.side_normal(), light->surface.error, towards_camera)
            : offset_origin(position, normal, s.point_error, towards_camera);
  candidate_rays_.push_back({start, 0, projection->origin - start, 1});
  // The path's number stands in for its sample until the ray has been traced.
  if (medium_rays_.media().any()) medium_.push_back(light ? medium_towards(*light, towards_camera) : end.medium);
  candidates_.push_back({projection->film, value, !light || light->depth == 1, path});
}

}  // namespace sightline::bidirectional
