// Positions, normals, errors and materials of hits, in batches.
#include <algorithm>
#include <bit>
#include <cmath>

#include "trace/sphere.h"
#include "world/surface_records.h"
#include "world/triangle_lanes.h"

namespace sightline {
namespace {

constexpr std::size_t kBlock = 64;  // hits whose memory is requested ahead

void set(Vec3Batch& batch, std::size_t i, const Vec3& v) { batch.x[i] = v.x, batch.y[i] = v.y, batch.z[i] = v.z; }
float max_abs(const Vec3& v) { return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z))); }

Vec3 unit_normal_in_double(const Vec3& edge1, const Vec3& edge2) {
  const Vec3d n = glm::cross(Vec3d(edge1), Vec3d(edge2));
  const double length = glm::length(n);
  return length > 0 && std::isfinite(length) ? Vec3(n / length) : Vec3{0, 0, 1};
}

struct Corners {
  Vec3 p0, edge1, edge2;
};

Corners corners_of(const InstanceRecord& record, std::uint32_t primitive) {
  const UVec3 t = record.triangles[primitive];
  const Vec3 p0 = record.positions[t.x];
  return {p0, record.positions[t.y] - p0, record.positions[t.z] - p0};
}

// The batches hold more than one cache line a hit, so memory is asked for in two steps before the arithmetic: indices, then vertices.
void prefetch(const SurfaceTables& tables, const HitBatch& hits, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t instance = hits.instance[i];
    if (!(instance & kSphereBit)) __builtin_prefetch(tables.instances[instance].triangles + hits.primitive[i]);
  }
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t instance = hits.instance[i];
    if (instance & kSphereBit) continue;
    const InstanceRecord& record = tables.instances[instance];
    const UVec3 t = record.triangles[hits.primitive[i]];
    for (const std::uint32_t vertex : {t.x, t.y, t.z}) {
      __builtin_prefetch(record.positions + vertex);
      if (record.normals) __builtin_prefetch(record.normals + vertex);
    }
  }
}

void set_material(const MaterialRecord& material, SurfaceBatch& surfaces, std::size_t i) {
  surfaces.material[i] = material.material;
  surfaces.plain[i] = material.plain;
  set(surfaces.albedo, i, material.albedo);
}

void reconstruct_miss(SurfaceBatch& surfaces, std::size_t i) {
  set(surfaces.position, i, Vec3(0));
  set(surfaces.geometric_normal, i, Vec3(0));
  set(surfaces.shading_normal, i, Vec3(0));
  set(surfaces.albedo, i, Vec3(0));
  surfaces.error[i] = 0;
  surfaces.material[i] = kNoHit;
  surfaces.light[i] = kNoLight;
  surfaces.plain[i] = 0;
}

void reconstruct_sphere(const SurfaceTables& tables, const LightTable& lights, const RayBatch& rays, const HitBatch& hits, std::size_t i,
                        SurfaceBatch& surfaces) {
  const Sphere& sphere = tables.spheres[hits.instance[i] & ~kSphereBit];
  const Ray ray = rays.get(i);
  // Pushed back onto the sphere: the error is then that of the radius and the centre, however far the ray came.
  const Vec3 outward = normalize_or(ray.origin + hits.t[i] * ray.direction - sphere.center, {0, 0, 1});
  const Vec3 position = sphere.center + sphere.radius * outward;
  const Vec3 normal = sphere.reverse_orientation ? -outward : outward;
  set(surfaces.position, i, position);
  set(surfaces.geometric_normal, i, normal);
  set(surfaces.shading_normal, i, normal);
  surfaces.error[i] =
      kRounding * (kPointRoundings * std::max(max_abs(position), max_abs(sphere.center)) + kRadiusRoundings * sphere.radius);
  const std::size_t index = sphere.material.valid() ? sphere.material.index : tables.materials.size() - 1;
  const MaterialRecord& material = tables.materials[std::min(index, tables.materials.size() - 1)];
  set_material(material, surfaces, i);
  surfaces.light[i] = material.emits ? lights.light_of(hits.instance[i], 0) : kNoLight;
}

// The scalar definition.
void reconstruct_triangle(const SurfaceTables& tables, const HitBatch& hits, std::size_t i, SurfaceBatch& surfaces) {
  const InstanceRecord& record = tables.instances[hits.instance[i]];
  const std::uint32_t primitive = hits.primitive[i];
  const float u = hits.u[i], v = hits.v[i];
  auto [p0, edge1, edge2] = corners_of(record, primitive);

  // From the first vertex along the edges: far from the origin only the last addition rounds coarsely.
  Vec3 position = p0 + (u * edge1 + v * edge2);
  const float size = std::max(max_abs(edge1), max_abs(edge2));
  float error = kRounding * (kPointRoundings * max_abs(position) + kEdgeRoundings * size);
  if (record.transforms) {
    error = record.local_scale * (error + 4 * kRounding * max_abs(position));
    position = record.linear * position + record.translation;
    edge1 = record.linear * edge1;
    edge2 = record.linear * edge2;
    error += (record.world_scale + kPointRoundings * kRounding) * max_abs(position) + record.constant;
  }
  const Vec3 geometric = record.winding * unit_normal(edge1, edge2);
  const Barycentrics inside = inside_by(kEdgeMargin * error, u, v, edge1, edge2, glm::length(glm::cross(edge1, edge2)));
  position = position + ((inside.u - u) * edge1 + (inside.v - v) * edge2);
  set(surfaces.position, i, position);
  set(surfaces.geometric_normal, i, geometric);
  set(surfaces.shading_normal, i, record.normals ? interpolated_normal(record, primitive, u, v, geometric) : geometric);
  surfaces.error[i] = error;
}

void set_triangle_material(const SurfaceTables& tables, const LightTable& lights, const HitBatch& hits, std::size_t i,
                           SurfaceBatch& surfaces) {
  const InstanceRecord& record = tables.instances[hits.instance[i]];
  const std::uint32_t primitive = hits.primitive[i];
  const std::uint32_t entry = record.triangle_materials ? record.triangle_materials[primitive] : 0;
  const MaterialRecord& material = tables.materials[record.palette[std::min(entry, record.palette_size - 1)]];
  set_material(material, surfaces, i);
  surfaces.light[i] = material.emits ? lights.light_of(hits.instance[i], primitive) : kNoLight;
}

// One triangle of a world-space mesh into its lane.
void gather(const InstanceRecord& record, std::uint32_t primitive, std::size_t lane, TriangleLanes& lanes) {
  const UVec3 t = record.triangles[primitive];
  for (int corner = 0; corner < 3; ++corner) {
    const Vec3& p = record.positions[t[corner]];
    lanes.p[corner][0][lane] = p.x, lanes.p[corner][1][lane] = p.y, lanes.p[corner][2][lane] = p.z;
  }
  lanes.winding[lane] = record.winding;
  const auto bit = static_cast<std::uint16_t>(1u << lane);
  lanes.active = static_cast<std::uint16_t>(lanes.active | bit);
  if (!record.normals) return;
  lanes.smooth = static_cast<std::uint16_t>(lanes.smooth | bit);
  for (int corner = 0; corner < 3; ++corner) {
    const Vec3 n = record.transforms_normals ? record.normal_matrix * record.normals[t[corner]] : record.normals[t[corner]];
    lanes.n[corner][0][lane] = n.x, lanes.n[corner][1][lane] = n.y, lanes.n[corner][2][lane] = n.z;
  }
}

// Lanes from `first` on that hit the same instance as lane `first`.
std::uint16_t same_instance(const std::uint32_t* instance, std::size_t first, std::size_t count) {
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < kLanes; ++i) mask |= static_cast<std::uint32_t>(instance[i] == instance[first]) << i;
  return static_cast<std::uint16_t>(mask & ((1u << count) - 1u));
}

// All lanes of one world-space mesh at once. Fewer than four are quicker one by one.
bool take_together(const SurfaceTables& tables, const LightTable& lights, const HitBatch& hits, std::size_t begin, std::uint16_t mask,
                   TriangleLanes& lanes, SurfaceBatch& surfaces) {
  const InstanceRecord& record = tables.instances[hits.instance[begin + static_cast<std::size_t>(std::countr_zero(mask))]];
  if (!record.gathers || std::popcount(mask) < 4) return false;
  gather_lanes(record, hits.primitive.data() + begin, mask, lanes);
  const bool uniform = record.triangle_materials == nullptr && !tables.materials[record.palette[0]].emits;
  if (uniform) {
    set_material_lanes(tables.materials[record.palette[0]], mask, begin, surfaces);
  } else {
    for (unsigned left = mask; left != 0; left &= left - 1)
      set_triangle_material(tables, lights, hits, begin + static_cast<std::size_t>(std::countr_zero(left)), surfaces);
  }
  return true;
}

// At most 16 hits: triangles of world-space meshes together, the rest one by one.
void reconstruct_block(const SurfaceTables& tables, const LightTable& lights, const RayBatch& rays, const HitBatch& hits, std::size_t begin,
                       std::size_t end, SurfaceBatch& surfaces) {
  TriangleLanes lanes;
  std::uint32_t done = 0;
  for (std::size_t i = begin; i < end; ++i) {
    if ((done >> (i - begin)) & 1u) continue;
    const std::uint32_t instance = hits.instance[i];
    if (!(instance & kSphereBit)) {
      const std::uint16_t mask = same_instance(hits.instance.data() + begin, i - begin, end - begin);
      if (take_together(tables, lights, hits, begin, mask, lanes, surfaces)) {
        done |= mask;
        continue;
      }
    }
    if (instance == kNoHit) {
      reconstruct_miss(surfaces, i);
    } else if (instance & kSphereBit) {
      reconstruct_sphere(tables, lights, rays, hits, i, surfaces);
    } else {
      const InstanceRecord& record = tables.instances[instance];
      if (record.transforms)
        reconstruct_triangle(tables, hits, i, surfaces);
      else
        gather(record, hits.primitive[i], i - begin, lanes);
      set_triangle_material(tables, lights, hits, i, surfaces);
    }
  }
  if (lanes.active == 0) return;
  unsigned left = reconstruct_lanes(lanes, hits.u.data(), hits.v.data(), begin, surfaces);
  for (; left != 0; left &= left - 1)
    reconstruct_triangle(tables, hits, begin + static_cast<std::size_t>(std::countr_zero(left)), surfaces);
}

// Zero where the shading normal is the facet's own.
Vec3 shadow_offset_of(const SurfaceTables& tables, const RayBatch& rays, const HitBatch& hits, std::size_t i) {
  if (hits.instance[i] & kSphereBit) return Vec3(0);
  const InstanceRecord& record = tables.instances[hits.instance[i]];
  if (!record.normals) return Vec3(0);
  const WorldTriangle triangle = world_triangle(record, hits.primitive[i]);
  const float side = glm::dot(rays.get(i).direction, triangle.geometric_normal) > 0 ? -1.f : 1.f;
  std::array<Vec3, 3> normals;
  for (int corner = 0; corner < 3; ++corner) {
    const float u = corner == 1 ? 1.f : 0.f, v = corner == 2 ? 1.f : 0.f;
    normals[corner] = side * interpolated_normal(record, hits.primitive[i], u, v, triangle.geometric_normal);
  }
  const float u = hits.u[i], v = hits.v[i];
  return terminator_offset(triangle.vertices, normals, {1 - u - v, u, v});
}

}  // namespace

Barycentrics inside_by(float margin, float u, float v, const Vec3& edge1, const Vec3& edge2, float double_area) {
  if (!(double_area > 0 && double_area < 1e30f)) return {u, v};
  // Barycentric coordinate of a point at distance `margin` from an edge: margin over the height above it.
  const Vec3 edge3 = edge2 - edge1;
  const float scale = margin / double_area, third = 1.f / 3;
  const float least_u = std::min(third, scale * std::sqrt(length_squared(edge2)));
  const float least_v = std::min(third, scale * std::sqrt(length_squared(edge1)));
  const float least_w = std::min(third, scale * std::sqrt(length_squared(edge3)));
  const float w = (1 - u) - v;
  if (u >= least_u && v >= least_v && w >= least_w) return {u, v};
  const float clamped_u = std::max(u, least_u), clamped_v = std::max(v, least_v), clamped_w = std::max(w, least_w);
  // What the clamped ones gained is taken from the others in proportion to what they can give.
  const float spare_u = clamped_u - least_u, spare_v = clamped_v - least_v, spare_w = clamped_w - least_w;
  const float excess = ((clamped_u + clamped_v) + clamped_w) - 1, spare = (spare_u + spare_v) + spare_w;
  const float share = spare > 0 ? std::min(1.f, excess / spare) : 0.f;
  return {clamped_u - share * spare_u, clamped_v - share * spare_v};
}

Vec3 unit_normal(const Vec3& edge1, const Vec3& edge2) {
  const Vec3 n = glm::cross(edge1, edge2);
  const float length2 = length_squared(n);
  if (!(length2 > 1e-30f && length2 < 1e30f)) return unit_normal_in_double(edge1, edge2);
  return n * (1 / std::sqrt(length2));
}

Vec3 interpolated_normal(const InstanceRecord& record, std::uint32_t primitive, float u, float v, const Vec3& geometric_normal) {
  const UVec3 t = record.triangles[primitive];
  Vec3 n = (1 - u - v) * record.normals[t.x] + u * record.normals[t.y] + v * record.normals[t.z];
  if (record.transforms_normals) n = record.normal_matrix * n;
  const float length2 = length_squared(n);
  if (!(length2 > 1e-30f && length2 < 1e30f)) return geometric_normal;
  const float side = glm::dot(n, geometric_normal) < 0 ? -1.f : 1.f;
  return n * (side / std::sqrt(length2));
}

NormalDerivatives normal_derivatives(const InstanceRecord& record, std::uint32_t primitive, float u, float v,
                                     const Vec3& geometric_normal) {
  const UVec3 t = record.triangles[primitive];
  const Vec3 n0 = record.normals[t.x];
  Vec3 n = (1 - u - v) * n0 + u * record.normals[t.y] + v * record.normals[t.z];
  Vec3 along_u = record.normals[t.y] - n0, along_v = record.normals[t.z] - n0;
  if (record.transforms_normals)
    n = record.normal_matrix * n, along_u = record.normal_matrix * along_u, along_v = record.normal_matrix * along_v;
  const float length2 = length_squared(n);
  if (!(length2 > 1e-30f && length2 < 1e30f)) return {};
  // Of n / |n|: what lies along n does not turn it.
  const float scale = (glm::dot(n, geometric_normal) < 0 ? -1.f : 1.f) / std::sqrt(length2);
  return {scale * (along_u - n * (glm::dot(n, along_u) / length2)), scale * (along_v - n * (glm::dot(n, along_v) / length2))};
}

WorldTriangle world_triangle(const InstanceRecord& record, std::uint32_t primitive) {
  const UVec3 t = record.triangles[primitive];
  WorldTriangle result{{record.positions[t.x], record.positions[t.y], record.positions[t.z]}, {}};
  if (record.transforms) {
    for (Vec3& p : result.vertices) p = record.linear * p + record.translation;
  }
  auto [p0, edge1, edge2] = corners_of(record, primitive);
  if (record.transforms) edge1 = record.linear * edge1, edge2 = record.linear * edge2;
  result.geometric_normal = record.winding * unit_normal(edge1, edge2);
  return result;
}

void SurfaceBatch::resize(std::size_t n) {
  size = n;
  for (Vec3Batch* batch : {&position, &geometric_normal, &shading_normal, &albedo}) batch->resize(n);
  error.resize(padded(n));
  material.resize(padded(n));
  light.resize(padded(n));
  plain.resize(padded(n));
}

void reconstruct(const SurfaceTables& tables, const LightTable& lights, const RayBatch& rays, const HitBatch& hits,
                 SurfaceBatch& surfaces) {
  surfaces.resize(hits.size);
  for (std::size_t begin = 0; begin < hits.size; begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, hits.size);
    prefetch(tables, hits, begin, end);
    for (std::size_t first = begin; first < end; first += kLanes)
      reconstruct_block(tables, lights, rays, hits, first, std::min(first + kLanes, end), surfaces);
  }
  if (!tables.shadow_terminator) {
    surfaces.shadow_offset = {};
    return;
  }
  surfaces.shadow_offset.resize(hits.size);
  for (std::size_t i = 0; i < hits.size; ++i) {
    set(surfaces.shadow_offset, i, hits.hit(i) ? shadow_offset_of(tables, rays, hits, i) : Vec3(0));
  }
}

}  // namespace sightline
