// Texture coordinates, derivatives and frame of one hit.
#include <cmath>

#include "trace/sphere.h"
#include "trace/triangle_uv.h"
#include "world/surface_records.h"

namespace sightline {
namespace {

struct Derivatives {
  Vec3 dp_du{0}, dp_dv{0};
};

// Solves edge = dp_du * du + dp_dv * dv for both edges; a frame around the normal where texture coordinates are degenerate.
Derivatives derivatives_from_uv(const std::array<Vec3, 3>& p, const std::array<Vec2, 3>& uv, const Vec3& normal) {
  const Vec3 edge1 = p[1] - p[0], edge2 = p[2] - p[0];
  const Vec2 duv1 = uv[1] - uv[0], duv2 = uv[2] - uv[0];
  const float determinant = duv1.x * duv2.y - duv1.y * duv2.x;
  const float size = glm::length(duv1) * glm::length(duv2);
  if (std::fabs(determinant) > 1e-6f * size && std::isfinite(size)) {
    const Derivatives d{(duv2.y * edge1 - duv1.y * edge2) / determinant, (duv1.x * edge2 - duv2.x * edge1) / determinant};
    if (is_finite(d.dp_du) && is_finite(d.dp_dv) && length_squared(glm::cross(d.dp_du, d.dp_dv)) > 0) return d;
  }
  const Frame3 frame = frame_from_normal(normal);
  return {frame.tangent, frame.bitangent};
}

// Barycentrics that a step in the triangle's plane passes, by least squares on the edges. In double: slivers lose half the digits.
Vec2 barycentric_step(const Vec3& edge1, const Vec3& edge2, const Vec3& step) {
  const Vec3d e1(edge1), e2(edge2), s(step);
  const double g11 = glm::dot(e1, e1), g12 = glm::dot(e1, e2), g22 = glm::dot(e2, e2), a = glm::dot(s, e1), b = glm::dot(s, e2);
  const double determinant = g11 * g22 - g12 * g12;
  return Vec2(static_cast<float>((g22 * a - g12 * b) / determinant), static_cast<float>((g11 * b - g12 * a) / determinant));
}

// How the interpolated normal turns along dp_du and dp_dv.
void set_normal_derivatives(const InstanceRecord& record, std::uint32_t primitive, float u, float v, const WorldTriangle& triangle,
                            SurfaceDetail& detail) {
  const NormalDerivatives d = normal_derivatives(record, primitive, u, v, triangle.geometric_normal);
  const Vec3 edge1 = triangle.vertices[1] - triangle.vertices[0], edge2 = triangle.vertices[2] - triangle.vertices[0];
  const Vec2 along_u = barycentric_step(edge1, edge2, detail.dp_du), along_v = barycentric_step(edge1, edge2, detail.dp_dv);
  const Vec3 dn_du = along_u.x * d.du + along_u.y * d.dv, dn_dv = along_v.x * d.du + along_v.y * d.dv;
  if (is_finite(dn_du) && is_finite(dn_dv)) detail.dn_du = dn_du, detail.dn_dv = dn_dv;
}

// Footprint of a cone of diameter `width` that meets the surface: a circle across the ray, stretched along the surface where it grazes.
// Both axes lie in the tangent plane; each is expressed in uv by least squares on dp/du, dp/dv.
TexturePoint footprint(const Vec2& uv, const Derivatives& d, const Vec3& normal, const Vec3& ray_direction, float width) {
  TexturePoint point{uv, {}, {}};
  const float uu = glm::dot(d.dp_du, d.dp_du), uv_product = glm::dot(d.dp_du, d.dp_dv), vv = glm::dot(d.dp_dv, d.dp_dv);
  const float determinant = uu * vv - uv_product * uv_product;
  if (!(width > 0) || !(determinant > 0)) return point;
  const Vec3 direction = normalize_or(ray_direction, normal);
  const float cosine = std::fmax(std::fabs(glm::dot(direction, normal)), 0.01f);
  const Vec3 along = direction - glm::dot(direction, normal) * normal;
  const Frame3 frame = frame_from_normal_tangent(normal, along);
  const auto to_uv = [&](const Vec3& step) {
    const float a = glm::dot(step, d.dp_du), b = glm::dot(step, d.dp_dv);
    const Vec2 result = Vec2(vv * a - uv_product * b, uu * b - uv_product * a) / determinant;
    return std::isfinite(result.x) && std::isfinite(result.y) ? result : Vec2(0);
  };
  point.duv_dx = to_uv(width / cosine * frame.tangent);
  point.duv_dy = to_uv(width * frame.bitangent);
  return point;
}

SurfaceDetail sphere_detail(const Sphere& sphere, const Ray& ray, float t, float cone_width) {
  // pbrt: dp/du runs along circles of latitude, dp/dv along meridians; v grows downwards from +z here, because textures were flipped.
  const Vec3 local = sphere_local_direction(sphere, ray.origin + t * ray.direction);
  const Mat3 rotation{glm::normalize(Vec3(sphere.world_from_object[0])), glm::normalize(Vec3(sphere.world_from_object[1])),
                      glm::normalize(Vec3(sphere.world_from_object[2]))};
  const float sine = std::sqrt(local.x * local.x + local.y * local.y);
  const float cos_phi = sine > 0 ? local.x / sine : 1, sin_phi = sine > 0 ? local.y / sine : 0;
  SurfaceDetail detail;
  detail.uv = sphere_uv(local);
  Derivatives d;
  // At the poles the circle has no length, but a direction all the same.
  d.dp_du = 2 * kPi * sphere.radius * std::fmax(sine, 1e-6f) * (rotation * Vec3{-sin_phi, cos_phi, 0});
  d.dp_dv = kPi * sphere.radius * (rotation * Vec3{local.z * cos_phi, local.z * sin_phi, -sine});
  detail.dp_du = d.dp_du, detail.dp_dv = d.dp_dv;
  const Vec3 outward = rotation * local;
  const Vec3 normal = sphere.reverse_orientation ? -outward : outward;
  const float curvature = (sphere.reverse_orientation ? -1.f : 1.f) / sphere.radius;
  detail.dn_du = curvature * d.dp_du, detail.dn_dv = curvature * d.dp_dv;
  detail.frame = frame_from_normal_tangent(normal, d.dp_du);
  detail.texture = footprint(detail.uv, d, normal, ray.direction, cone_width);
  return detail;
}

}  // namespace

SurfaceDetail reconstruct_detail(const Scene& scene, const SurfaceTables& tables, const RayBatch& rays, const HitBatch& hits, std::size_t i,
                                 float cone_width) {
  const std::uint32_t instance = hits.instance[i];
  if (instance == kNoHit) return {};
  if (instance & kSphereBit) return sphere_detail(tables.spheres[instance & ~kSphereBit], rays.get(i), hits.t[i], cone_width);

  const InstanceRecord& record = tables.instances[instance];
  const Mesh& mesh = scene.meshes[scene.instances[instance].mesh.index];
  const std::uint32_t primitive = hits.primitive[i];
  const UVec3 t = record.triangles[primitive];
  const float u = hits.u[i], v = hits.v[i];
  const WorldTriangle triangle = world_triangle(record, primitive);
  const Vec3 normal = record.normals ? interpolated_normal(record, primitive, u, v, triangle.geometric_normal) : triangle.geometric_normal;

  SurfaceDetail detail;
  const std::array<Vec2, 3> uvs = corner_uvs(mesh.uvs, t);
  detail.uv = interpolate_uv(uvs, u, v);
  Derivatives d = derivatives_from_uv(triangle.vertices, uvs, triangle.geometric_normal);
  detail.texture = footprint(detail.uv, d, triangle.geometric_normal, rays.get(i).direction, cone_width);
  Vec3 tangent = d.dp_du;
  if (mesh.tangents.size() > std::max(t.x, std::max(t.y, t.z))) {
    // The file's tangent decides the direction, its w the hand: glTF's bitangent runs against v, which grows downwards.
    const Vec4 file = (1 - u - v) * mesh.tangents[t.x] + u * mesh.tangents[t.y] + v * mesh.tangents[t.z];
    const Vec3 world = Mat3(scene.instances[instance].world_from_object) * Vec3(file);
    if (is_finite(world) && length_squared(world) > 0) {
      tangent = world;
      const float hand = (file.w < 0 ? -1.f : 1.f) * record.winding;
      if (glm::dot(d.dp_dv, hand * glm::cross(normal, world)) > 0) d.dp_dv = -d.dp_dv;
    }
  }
  detail.dp_du = d.dp_du, detail.dp_dv = d.dp_dv;
  if (record.normals) set_normal_derivatives(record, primitive, u, v, triangle, detail);
  detail.frame = frame_from_normal_tangent(normal, tangent);
  return detail;
}

}  // namespace sightline
