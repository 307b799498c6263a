#include "methods/square_lights/frame_shading.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "methods/square_lights/haar.h"
#include "methods/square_lights/hemisphere_disk.h"
#include "methods/square_lights/summed_visibility.h"

namespace sightline::square_lights {
namespace {

Coverage coverage_of(SquareLightsSettings::Coverage c) {
  switch (c) {
    case SquareLightsSettings::Coverage::average:
      return Coverage::average;
    case SquareLightsSettings::Coverage::gradient:
      return Coverage::gradient;
    default:
      return Coverage::parallel;
  }
}

/// Every texel as a square of its own.
std::vector<SquareLight> texel_lights(const LightCube& cube) {
  std::vector<SquareLight> lights(cube.count());
  for (std::size_t i = 0; i < lights.size(); ++i) lights[i] = {cube.center(i), std::sqrt(0.5f * cube.solid_angle(i)), cube.texels[i]};
  return lights;
}

/// Whether an occluder's sphere may come between a receiver's sphere and a light: the light's directions make a cone of half
/// angle `a` about c, and the occluder has to reach into the volume that it sweeps from the receiver.
bool may_hide(const Vec3& receiver_center, float receiver_radius, const Vec3& occluder_center, float occluder_radius,
              const SquareLight& light) {
  const float a = 2 * std::asin(std::min(1.f, 0.5f * light.radius));
  if (a >= 80 * kPi / 180) return true;
  const Vec3 between = occluder_center - receiver_center;
  const float t = glm::dot(between, light.center), axis = std::sqrt(std::max(0.f, length_squared(between) - t * t));
  return axis * std::cos(a) - t * std::sin(a) <= occluder_radius + receiver_radius;
}

float scale_of(const Mat4& m) { return glm::length(Vec3(m[0])); }

Coverage without_gradient(Coverage coverage) { return coverage == Coverage::gradient ? Coverage::average : coverage; }

void make_room(std::size_t lights, FrameShading::Scratch& scratch) {
  if (scratch.visible.size() >= lights) return;
  for (AlignedVector<float>* values : {&scratch.visible, &scratch.distance, &scratch.other}) values->resize(padded(lights));
}

/// The least distance of all; with that of another occluder goes the gradient of the receiver's own, whose boundary it is no longer.
void take_nearer(FrameShading::Scratch& scratch, std::uint32_t i, float distance) {
  if (distance >= scratch.distance[i]) return;
  scratch.distance[i] = distance;
  if (i < scratch.gradient_x.size()) scratch.gradient_x[i] = scratch.gradient_y[i] = 0;
}

void take_nearer(std::span<const float> found, std::size_t count, std::span<float> distance) {
  for (std::size_t i = 0; i < count; ++i) distance[i] = found[i] < distance[i] ? found[i] : distance[i];
}

// Lights that splitting may make of one.
constexpr std::size_t kMostSplit = 8;

// Light that grazes a vertex of a silhouette: its BRDF is looked up as nearly from the side.
constexpr float kLeastViewCosine = 1e-3f;

Vec3 above_surface(Vec3 wo) {
  if (wo.z < kLeastViewCosine) wo = normalize_or({wo.x, wo.y, 0}, {1, 0, 0}), wo.z = kLeastViewCosine;
  return wo;
}

}  // namespace

FrameShading::FrameShading(const SquareBake& bake, const SquareLightsSettings& settings, const View& view)
    : bake_(bake), settings_(settings), coverage_(coverage_of(settings.coverage)) {
  const Camera& camera = view.camera();
  orthographic_ = camera.projection == Camera::Projection::orthographic;
  const Vec3 eye = orthographic_ ? glm::normalize(Vec3(camera.world_from_camera[2])) : Vec3(camera.world_from_camera[3]);
  if (settings.paper_radius) plane_scale_ = 1;

  const LightChoice choice = parse_lights(settings.lights);
  const bool traced = !bake.texel_masks().empty();
  if (traced) {
    directions_ = texel_directions(bake.cube().size, bake.world_from_environment());
    if (settings.basis == SquareLightsSettings::Basis::haar) {
      const WaveletLight light =
          wavelet_light(bake.cube(), choice.kind == LightChoice::Kind::count ? choice.count : 0, settings.area_weighted);
      for (std::size_t c = 0; c < 3; ++c)
        for (const WaveletLight::Term& term : light.channel[c]) terms_[c].emplace_back(term.index, term.value);
    }
    for (std::size_t i = 0; i < bake.cube().count(); ++i) texel_solid_angle_.push_back(bake.cube().solid_angle(i));
  } else if (!bake.cube().texels.empty()) {
    LightSet own;
    const std::vector<SquareLight> texels =
        choice.kind == LightChoice::Kind::all_tables ? texel_lights(bake.cube()) : std::vector<SquareLight>();
    const std::span<const SquareLight> lights = texels.empty() ? bake.squares() : std::span(texels);
    own.reserve(lights.size());
    for (const SquareLight& light : lights) {
      if (!is_black(light.radiance)) own.add(light);
    }
    if (settings.split > 0 && choice.kind == LightChoice::Kind::count) cut_ = bake.tree().cut(choice.count);
    own.finish();
    world_lights_.turned_from(own, bake.world_from_environment());
  }

  const std::vector<ShadingObject>& objects = bake.scene().objects();
  receivers_.resize(objects.size());
  for (std::size_t o = 0; o < objects.size(); ++o) {
    Receiver& receiver = receivers_[o];
    const ShadingObject& object = objects[o];
    object_of_vertex_.push_back(object.first);
    receiver.world_from_object = object.world_from_object;
    receiver.object_from_world = glm::inverse(object.world_from_object);
    receiver.lights.turned_from(world_lights_, Mat3(receiver.object_from_world));
    receiver.eye = orthographic_ ? glm::normalize(transform_vector(receiver.object_from_world, eye))
                                 : transform_point(receiver.object_from_world, eye);
    if (object.deformable) continue;
    receiver.planes = object.moving && !bake.planes().empty();
    const Vec3 center = transform_point(object.world_from_object, object.center);
    const float radius = object.radius * scale_of(object.world_from_object);
    for (const Occluder& occluder : bake.occluders()) {
      // Nothing hides light from itself this way, and what stands still knows itself from its own tables.
      if (occluder.object == o) continue;
      Use use;
      use.occluder = &occluder;
      const Vec3 occluder_center = transform_point(occluder.world_from_field, occluder.field.center());
      const float occluder_radius = occluder.field.radius() * scale_of(occluder.world_from_field);
      bool any = false;
      for (std::size_t i = 0; i < world_lights_.count; ++i) {
        const bool may = may_hide(center, radius, occluder_center, occluder_radius, world_lights_.light(i));
        use.may.push_back(may ? 1.f : 0.f);
        any |= may;
      }
      if (!any) continue;
      use.may.resize(padded(use.may.size()), 0.f);
      const Mat4 field_from_world = glm::inverse(occluder.world_from_field);
      const Mat4 field_from_receiver = field_from_world * object.world_from_object;
      use.turn = Mat3(field_from_receiver) / scale_of(field_from_receiver);
      receiver.around.add(transform_point(receiver.object_from_world, occluder_center),
                          occluder_radius * scale_of(receiver.object_from_world), use.turn);
      receiver.occluders.push_back(std::move(use));
    }
    receiver.around.finish();
  }
  // What a light reaches around its centre, as the fields have it.
  for (const float r : world_lights_.r) {
    const float sine = std::min(0.55f * r, 1.f);
    reach_.cosine.push_back(1 - 2 * sine * sine), reach_.sine.push_back(2 * sine * std::sqrt(1 - sine * sine));
  }
}

Vec3 FrameShading::towards_eye(const Receiver& receiver, const Vec3& position) const {
  return orthographic_ ? receiver.eye : normalize_or(receiver.eye - position, Vec3(0, 0, 1));
}

void FrameShading::tables_of(std::uint32_t object, const VertexHit& hit, int count, ReceiverTables& tables, Scratch& scratch) const {
  const VertexTables& stored = bake_.tables(object);
  if (stored.empty()) return;
  const ShadingVertices& vertices = bake_.scene().vertices();
  const std::uint32_t first = bake_.scene().objects()[object].first;
  tables.count = count;
  for (int j = 0; j < count; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const std::uint32_t v = hit.vertex[k];
    tables.weight[j] = hit.weight[k];
    tables.frame[j] = vertex_frame(vertices.normal[v], vertices.tangent[v]);
    if (!stored.compressed) {
      tables.table[j] = stored.raw.data() + (v - first) * kTableCells;
      continue;
    }
    AlignedVector<std::int8_t>& expanded = scratch.expanded[j];
    if (expanded.empty()) expanded.resize(kTableCells + 64);
    if (scratch.expanded_vertex[j] != v)
      stored.compressed->expand(v - first, std::span<std::int8_t, kTableCells>(expanded.data(), kTableCells));
    scratch.expanded_vertex[j] = v;
    tables.table[j] = expanded.data();
  }
}

void FrameShading::hide(const Receiver& receiver, const Vec3& position, const Vec3& normal, Scratch& scratch) const {
  const bool combine = settings_.combine == SquareLightsSettings::Combine::distance;
  if (receiver.occluders.empty() && !receiver.planes) return;
  if (combine)
    find_active(receiver.lights, normal, plane_scale_, scratch.distance, -0.70710678f, scratch.active);
  else
    find_active(receiver.lights, normal, plane_scale_, scratch.visible, 0, scratch.active);
  // Choosing tables of all occluders first gives memory the time to fetch them.
  if (scratch.meetings.size() < receiver.occluders.size()) scratch.meetings.resize(receiver.occluders.size());
  occluder_places(receiver.around, position, scratch.places);
  for (std::size_t o = 0; o < receiver.occluders.size(); ++o) {
    const Use& use = receiver.occluders[o];
    Meeting& meeting = scratch.meetings[o];
    find_near(receiver.lights, scratch.active, use.may, reach_, scratch.places.cone(o), use.turn, meeting.near);
    if (meeting.near.count == 0) continue;
    const std::array<std::int32_t, 8> before = meeting.samples.table;
    meeting.samples = use.occluder->field.samples(scratch.places.place(o));
    for (std::size_t k = 0; k < 8; ++k) {
      if (meeting.samples.table[k] != before[k]) use.occluder->field.prefetch(meeting.samples.table[k]);
    }
  }
  for (std::size_t o = 0; o < receiver.occluders.size(); ++o) {
    const NearLights& near = scratch.meetings[o].near;
    if (near.count == 0) continue;
    occluder_distances(receiver.occluders[o].occluder->field, scratch.meetings[o].samples, near.lanes(), scratch.other);
    scratch.counts.occluder_tests += near.count;
    for (std::size_t k = 0; k < near.count; ++k) {
      const std::uint32_t i = near.index[k];
      if (combine)
        take_nearer(scratch, i, scratch.other[k]);
      else if (const float d = scratch.other[k], r_p = near.r[k] * plane_scale_; d < r_p)
        scratch.visible[i] *= coverage_ == Coverage::parallel ? covered_parallel(d, r_p) : covered_average(d, r_p);
    }
  }
  if (!receiver.planes) return;
  const Vec3 world = transform_point(receiver.world_from_object, position);
  for (const PlanarOccluder& plane : bake_.planes()) {
    plane.see(world, scratch.plane);
    if (scratch.plane.is_edge_on()) continue;
    scratch.plane.distances(world_lights_, plane_scale_, scratch.other);
    if (combine && scratch.gradient_x.empty()) {
      take_nearer(scratch.other, world_lights_.x.size(), scratch.distance);
      continue;
    }
    for (const std::uint32_t i : scratch.active.indices()) {
      const float r_p = world_lights_.r[i] * plane_scale_, d = scratch.other[i];
      if (d >= r_p) continue;
      if (combine)
        take_nearer(scratch, i, d);
      else
        scratch.visible[i] *= coverage_ == Coverage::parallel ? covered_parallel(d, r_p) : covered_average(d, r_p);
    }
  }
}

Color FrameShading::lit(const Receiver& receiver, const ReceiverTables& tables, const Vec3& position, const Frame3& frame, const Vec3& wo,
                        const Reflection& reflection, Scratch& scratch) const {
  const LightSet& lights = receiver.lights;
  const std::size_t n = lights.x.size();
  ++scratch.counts.receivers;
  if (n == 0) return Color(0);
  make_room(n, scratch);
  const bool combine = settings_.combine == SquareLightsSettings::Combine::distance;
  const bool gradients = coverage_ == Coverage::gradient;
  if (gradients && scratch.gradient_x.size() < n) scratch.gradient_x.resize(n), scratch.gradient_y.resize(n);
  const std::span<float> gx = gradients ? std::span<float>(scratch.gradient_x) : std::span<float>(),
                         gy = gradients ? std::span<float>(scratch.gradient_y) : std::span<float>();
  std::fill_n(scratch.visible.begin(), n, 1.f);
  if (settings_.tables == SquareLightsSettings::Tables::summed && tables.count > 0) {
    summed_visibility(tables, lights, plane_scale_, scratch.visible);
    std::fill_n(scratch.distance.begin(), n, kNoOccluder);
    std::fill(gx.begin(), gx.end(), 0.f), std::fill(gy.begin(), gy.end(), 0.f);
  } else {
    self_distances(tables, lights, std::span(scratch.distance).first(n), gx, gy);
  }
  if (combine) {
    hide(receiver, position, frame.normal, scratch);
    multiply_coverage(scratch.distance, gx, gy, lights, plane_scale_, coverage_, scratch.visible);
  } else {
    if (tables.count > 0 && settings_.tables == SquareLightsSettings::Tables::distance)
      multiply_coverage(scratch.distance, gx, gy, lights, plane_scale_, coverage_, scratch.visible);
    hide(receiver, position, frame.normal, scratch);
  }
  return reflect(frame, wo, reflection, lights, scratch);
}

Color FrameShading::reflect(const Frame3& frame, const Vec3& wo, const Reflection& reflection, const LightSet& lights,
                            Scratch& scratch) const {
  const Vec3 local = above_surface(frame.to_local(wo));
  std::size_t lit = 0;
  const Color radiance = shade(frame, reflection.table.slices(local), lights, scratch.visible, plane_scale_, lit);
  scratch.counts.lights += lit;
  if (reflection.lobe.empty()) return radiance;
  return radiance + shade_lobe(reflection.lobe.view(local), frame, lights, scratch.visible);
}

void FrameShading::see_listed(std::uint32_t o, const ReceiverTables& tables, Scratch& scratch) const {
  const std::size_t n = scratch.local.x.size();
  make_room(n, scratch);
  std::fill_n(scratch.visible.begin(), n, 1.f);
  if (tables.count > 0) {
    scratch.turned.turned_from(scratch.local, Mat3(receivers_[o].object_from_world));
    self_distances(tables, scratch.turned, std::span(scratch.distance).first(n), {}, {});
    multiply_coverage(scratch.distance, {}, {}, scratch.turned, plane_scale_, without_gradient(coverage_), scratch.visible);
  }
}

Color FrameShading::shade_listed(std::uint32_t o, const Frame3& frame, const Vec3& wo, const Reflection& reflection,
                                 Scratch& scratch) const {
  scratch.turned.turned_from(scratch.local, Mat3(receivers_[o].object_from_world));
  return reflect(frame, wo, reflection, scratch.turned, scratch);
}

Color FrameShading::lit_locally(std::uint32_t o, const VertexHit& hit, const ReceiverTables& tables, const Vec3& position,
                                const Frame3& frame, const Vec3& wo, const Reflection& reflection, Scratch& scratch) const {
  if (bake_.sources().empty()) return Color(0);
  const ShadingObject& object = bake_.scene().objects()[o];
  const Vec3 world = transform_point(receivers_[o].world_from_object, position);
  scratch.local.clear(), scratch.patch_distance.clear();
  for (const Source& source : bake_.sources()) {
    scratch.patches.resize(source.light.count());
    if (source.field)
      source.field->lights_at(world - source.origin, scratch.patches);
    else
      source.light.lights_at(world, scratch.patches);
    for (const PatchLight& patch : scratch.patches) scratch.local.add(patch.light), scratch.patch_distance.push_back(patch.distance);
  }
  scratch.local.finish();
  const bool still = !object.moving && !object.deformable && !bake_.patch_coverage().empty();
  see_listed(o, still ? ReceiverTables() : tables, scratch);
  if (still) {
    const std::size_t count = scratch.local.count;
    std::fill_n(scratch.visible.begin(), count, 0.f);
    for (std::size_t j = 0; j < 3; ++j) {
      if (hit.weight[j] == 0) continue;
      const std::uint8_t* coverage = bake_.patch_coverage().data() + (hit.vertex[j] - object.first) * count;
      for (std::size_t k = 0; k < count; ++k) scratch.visible[k] += hit.weight[j] * static_cast<float>(coverage[k]) / 255;
    }
  }
  if (!object.deformable) hide_listed(o, world, scratch);
  return shade_listed(o, frame, wo, reflection, scratch);
}

Color FrameShading::lit_split(std::uint32_t o, const ReceiverTables& tables, const Vec3& position, const Frame3& frame, const Vec3& wo,
                              const Reflection& reflection, Scratch& scratch) const {
  const Mat3 object_from_environment = Mat3(receivers_[o].object_from_world) * bake_.world_from_environment();
  const Vec3 world = transform_point(receivers_[o].world_from_object, position);
  const BrdfTable::Slices slices = reflection.table.slices(above_surface(frame.to_local(wo)));
  const auto list = [&](std::span<const std::int32_t> nodes) {
    scratch.local.clear();
    scratch.patch_distance.assign(nodes.size(), std::numeric_limits<float>::infinity());
    for (const std::int32_t node : nodes) {
      SquareLight light = bake_.tree().nodes()[static_cast<std::size_t>(node)].light;
      light.center = bake_.world_from_environment() * light.center;
      scratch.local.add(light);
    }
    scratch.local.finish();
    see_listed(o, tables, scratch);
    hide_listed(o, world, scratch);
  };
  const std::span<const std::int32_t> nodes = scratch.refiner.refine(
      bake_.tree(), cut_, settings_.split, kMostSplit * cut_.size(), [&](std::span<const std::int32_t> asked, std::span<NodeTerm> terms) {
        list(asked);
        for (std::size_t k = 0; k < asked.size(); ++k) {
          const MergeNode& node = bake_.tree().nodes()[static_cast<std::size_t>(asked[k])];
          const Vec3 c = normalize_or(object_from_environment * node.light.center, Vec3(0, 0, 1));
          const Vec2 p = disk_from_direction(frame.to_local(c));
          terms[k] = node_term(node, scratch.visible[k], reflection.table.moments(slices, p, node.light.radius * plane_scale_));
        }
      });
  list(nodes);
  ++scratch.counts.receivers;
  return shade_listed(o, frame, wo, reflection, scratch);
}

void FrameShading::hide_listed(std::uint32_t o, const Vec3& world, Scratch& scratch) const {
  const LightSet& lights = scratch.local;
  for (const Occluder& occluder : bake_.occluders()) {
    if (occluder.object == o) continue;
    const Mat4 field_from_world = glm::inverse(occluder.world_from_field);
    const float scale = scale_of(occluder.world_from_field);
    const Vec3 center = transform_point(occluder.world_from_field, occluder.field.center());
    // What lies beyond a light hides nothing of it.
    const float nearest = glm::length(center - world) - occluder.field.radius() * scale;
    if (std::none_of(scratch.patch_distance.begin(), scratch.patch_distance.end(), [&](float d) { return nearest < d; })) continue;
    scratch.turned.turned_from(lights, Mat3(field_from_world));
    occluder_distances(occluder.field, occluder.field.samples(transform_point(field_from_world, world)), scratch.turned.lanes(),
                       scratch.other);
    scratch.counts.occluder_tests += lights.count;
    for (std::size_t k = 0; k < lights.count; ++k) {
      const float d = scratch.other[k], r_p = lights.r[k] * plane_scale_;
      if (nearest >= scratch.patch_distance[k] || d >= 0.70710678f * r_p) continue;
      scratch.visible[k] *= coverage_ == Coverage::parallel ? covered_parallel(d, r_p) : covered_average(d, r_p);
    }
  }
  if (!receivers_[o].planes) return;
  for (const PlanarOccluder& plane : bake_.planes()) {
    plane.see(world, scratch.plane);
    for (std::size_t k = 0; k < lights.count; ++k) {
      const Vec3 c(lights.x[k], lights.y[k], lights.z[k]);
      if (!(scratch.visible[k] > 0) || plane.along(world, c) >= scratch.patch_distance[k] * (1 - 1e-3f)) continue;
      const float r_p = lights.r[k] * plane_scale_, d = scratch.plane.distance(c, r_p);
      if (d < r_p) scratch.visible[k] *= coverage_ == Coverage::parallel ? covered_parallel(d, r_p) : covered_average(d, r_p);
    }
  }
}

Color FrameShading::lit_from_afar(std::uint32_t o, const ReceiverTables& tables, const Vec3& position, const Frame3& frame, const Vec3& wo,
                                  const Reflection& reflection, Scratch& scratch) const {
  return cut_.empty() ? lit(receivers_[o], tables, position, frame, wo, reflection, scratch)
                      : lit_split(o, tables, position, frame, wo, reflection, scratch);
}

Color FrameShading::by_texels(std::uint32_t i, std::uint32_t object, Scratch& scratch) const {
  const Receiver& receiver = receivers_[object];
  const ShadingVertices& vertices = bake_.scene().vertices();
  const std::size_t texels = directions_.texels;
  const Vec3 wo = normalize_or(transform_vector(receiver.world_from_object, towards_eye(receiver, vertices.position[i])), Vec3(0, 0, 1));
  const Mat3 normal_matrix = glm::transpose(Mat3(receiver.object_from_world));
  const Frame3 frame = frame_from_normal_tangent(normalize_or(normal_matrix * vertices.normal[i], Vec3(0, 0, 1)),
                                                 transform_vector(receiver.world_from_object, vertices.tangent[i]));
  scratch.transport.resize(texels);
  Vec3 wo_up = frame.to_world(above_surface(frame.to_local(wo)));
  texel_transport(bake_.texel_masks().subspan(i * texels, texels), directions_, bake_.bsdf(vertices.material[i]), frame, wo_up,
                  scratch.transport);
  ++scratch.counts.receivers;
  Color sum(0);
  if (settings_.basis == SquareLightsSettings::Basis::squares) {
    for (std::size_t k = 0; k < texels; ++k) sum += texel_solid_angle_[k] * bake_.cube().texels[k] * scratch.transport[k];
    return sum;
  }
  scratch.wavelets.resize(texels);
  for (int c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < texels; ++k) scratch.wavelets[k] = scratch.transport[k][c];
    wavelet_transport(scratch.wavelets, bake_.cube().size);
    for (const auto& [index, value] : terms_[static_cast<std::size_t>(c)]) sum[c] += value * scratch.wavelets[index];
  }
  return sum;
}

std::uint32_t FrameShading::object_of(std::uint32_t vertex) const {
  const auto next = std::upper_bound(object_of_vertex_.begin(), object_of_vertex_.end(), vertex);
  return static_cast<std::uint32_t>(next - object_of_vertex_.begin()) - 1;
}

void FrameShading::prefetch_vertex(std::uint32_t i) const {
  const std::uint32_t object = object_of(i);
  const VertexTables* tables = directions_.texels == 0 ? &bake_.tables(object) : nullptr;
  if (tables == nullptr || tables->raw.empty()) return;
  const std::int8_t* table = tables->raw.data() + std::size_t{i - bake_.scene().objects()[object].first} * kTableCells;
  for (std::size_t line = 0; line < kTableCells; line += kCacheLine) hwy::Prefetch(table + line);
}

Color FrameShading::shade_vertex(std::uint32_t i, Scratch& scratch) const {
  const std::uint32_t object = object_of(i);
  if (directions_.texels > 0) return by_texels(i, object, scratch);
  const ShadingVertices& vertices = bake_.scene().vertices();
  const Receiver& receiver = receivers_[object];
  const BrdfTable* brdf = bake_.brdf(vertices.material[i]);
  if (brdf == nullptr) return Color(0);
  ReceiverTables tables;
  const VertexHit own{{i, i, i}, {1, 0, 0}};
  tables_of(object, own, 1, tables, scratch);
  const Frame3 frame = tables.count > 0 ? tables.frame[0] : vertex_frame(vertices.normal[i], vertices.tangent[i]);
  const Vec3 wo = towards_eye(receiver, vertices.position[i]);
  return lit_from_afar(object, tables, vertices.position[i], frame, wo, {*brdf, bake_.lobe(vertices.material[i])}, scratch) +
         lit_locally(object, own, tables, vertices.position[i], frame, wo, {*brdf, bake_.lobe(vertices.material[i])}, scratch);
}

Color FrameShading::shade_point(const VertexHit& hit, std::uint32_t object, std::uint32_t material, const Vec3& position,
                                const Frame3& frame, const Vec3& wo, Scratch& scratch) const {
  const Receiver& receiver = receivers_[object];
  const BrdfTable* brdf = bake_.brdf(material);
  if (brdf == nullptr) return Color(0);
  ReceiverTables tables;
  tables_of(object, hit, 3, tables, scratch);
  const auto turn = [&](const Vec3& v) { return normalize_or(transform_vector(receiver.object_from_world, v), v); };
  const Frame3 local = frame_from_normal_tangent(turn(frame.normal), turn(frame.tangent));
  const Vec3 here = transform_point(receiver.object_from_world, position);
  return lit_from_afar(object, tables, here, local, turn(wo), {*brdf, bake_.lobe(material)}, scratch) +
         lit_locally(object, hit, tables, here, local, turn(wo), {*brdf, bake_.lobe(material)}, scratch);
}

}  // namespace sightline::square_lights
