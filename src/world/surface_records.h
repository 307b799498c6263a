// Flat tables from which hits are reconstructed: one record an instance, one a material.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "scene/scene.h"
#include "shade/light_table.h"
#include "trace/placement.h"
#include "world/surface.h"

namespace sightline {

/// What a hit's material contributes to a SurfaceBatch.
struct MaterialRecord {
  Color albedo{0};
  std::uint32_t material = kDefaultMaterial;
  std::uint8_t plain = 0;
  bool emits = false;
};

/// All about one instance that a hit needs, without a detour through the Scene. Pointers are into arrays that the Scene or the Placement
/// keeps alive.
struct InstanceRecord {
  const Vec3* positions = nullptr;
  const UVec3* triangles = nullptr;
  const Vec3* normals = nullptr;                      ///< null: flat
  const std::uint16_t* triangle_materials = nullptr;  ///< null: palette[0] throughout
  const std::uint32_t* palette = nullptr;             ///< into SurfaceTables::materials
  bool transforms = false;                            ///< positions are in object space
  bool transforms_normals = false;
  bool emits = false;
  bool gathers = false;  ///< vector code may gather its vertices: in world space, offsets of 31 bits
  float winding = 1;     ///< -1 where the transform mirrors
  std::uint32_t palette_size = 1;
  Mat3 linear{1};  ///< of world_from_object, if `transforms`
  Vec3 translation{0};
  Mat3 normal_matrix{1};  ///< inverse transpose, up to scale
  /// Error bound of a point: local_scale * (error in its own space) + world_scale * |point| + constant.
  float local_scale = 1, world_scale = 0, constant = 0;
};

struct SurfaceTables {
  std::vector<InstanceRecord> instances;
  std::vector<MaterialRecord> materials;  ///< Scene::materials, then the default material
  std::vector<std::uint32_t> palettes;
  std::vector<Sphere> spheres;
  bool shadow_terminator = false;
};

SurfaceTables make_surface_tables(const Scene& scene, const Placement& placement, bool shadow_terminator);

/// Fills `surfaces` for all hits; `lights` may be null (no emitters).
void reconstruct(const SurfaceTables& tables, const LightTable& lights, const RayBatch& rays, const HitBatch& hits, SurfaceBatch& surfaces);

/// World::detail.
SurfaceDetail reconstruct_detail(const Scene& scene, const SurfaceTables& tables, const RayBatch& rays, const HitBatch& hits, std::size_t i,
                                 float cone_width);

/// Barycentrics moved, where need be, so that the point lies at least `margin` from each edge of the triangle, or at its centre if it is
/// too small for that. A hit within its error bound of an edge may otherwise be rounded onto or behind a neighbouring wall, from where a
/// ray leaves the room; the offset along the own normal cannot mend that. `double_area` is |edge1 x edge2|.
struct Barycentrics {
  float u, v;
};
Barycentrics inside_by(float margin, float u, float v, const Vec3& edge1, const Vec3& edge2, float double_area);

/// Corners of a hit triangle in world space, and its interpolated unit normal (`fallback` where there is none).
struct WorldTriangle {
  std::array<Vec3, 3> vertices;
  Vec3 geometric_normal{0, 0, 1};
};
WorldTriangle world_triangle(const InstanceRecord& record, std::uint32_t primitive);
Vec3 interpolated_normal(const InstanceRecord& record, std::uint32_t primitive, float u, float v, const Vec3& geometric_normal);
/// Its change with the barycentrics u and v; 0 where it is not interpolated.
struct NormalDerivatives {
  Vec3 du{0}, dv{0};
};
NormalDerivatives normal_derivatives(const InstanceRecord& record, std::uint32_t primitive, float u, float v, const Vec3& geometric_normal);
/// Unit normal of a triangle with these edges, with care for edges whose products leave the range of floats.
Vec3 unit_normal(const Vec3& edge1, const Vec3& edge2);

/// Half a unit in the last place, relative: the error of one rounding.
inline constexpr float kRounding = 0x1p-24f;
/// Roundings of a point's coordinates that count: reconstructing it, offsetting it, and one to spare.
inline constexpr float kPointRoundings = 3;
/// Roundings relative to a triangle's size: edges, barycentric sum, the tracer's plane equation.
inline constexpr float kEdgeRoundings = 16;
/// The same for spheres, relative to the radius: the tracer's discriminant loses more.
inline constexpr float kRadiusRoundings = 32;
/// Distance that hits keep from the edges of their triangle, in units of the error bound.
inline constexpr float kEdgeMargin = 2;

}  // namespace sightline
