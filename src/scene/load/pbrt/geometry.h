// Triangle data on its way from the file into the scene.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/math/vec.h"
#include "scene/load/pbrt/state.h"
#include "scene/mesh.h"

namespace sightline::pbrt {

/// Triangles in the space of the shape, texture coordinates as pbrt has them (v = 0 at the bottom).
struct MeshArrays {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uvs;
  std::vector<UVec3> triangles;
};

/// Transforms into a Mesh whose winding gives pbrt's surface normal: the side of the shading normals where there are any, else that of
/// the vertex order, turned by `reverse_orientation`. Flips v. Adds bad triangles to `dropped`.
Mesh bake(MeshArrays arrays, const Mat4d& world_from_object, bool reverse_orientation, std::uint64_t& dropped);
/// The same for a mesh that another loader read, whose v is flipped already. Shares its arrays where nothing changes.
Mesh bake(const Mesh& mesh, const Mat4d& world_from_object, bool reverse_orientation);

/// Area of a mesh, and the share by which the largest and the smallest triangle differ from the mean.
struct AreaStatistics {
  double total = 0, smallest = 0, largest = 0;
};
AreaStatistics triangle_areas(const Mesh& mesh, const Mat4d& world_from_object);

// Tessellated shapes, in the space of the shape.

/// A point of the curve that is turned about the z axis.
struct ProfilePoint {
  float z, radius;
  float normal_z, normal_radius;
  float v;
};
/// Surface of revolution over `phi_max_rad` with the normals pointing where the profile says.
MeshArrays revolve(const std::vector<ProfilePoint>& profile, float phi_max_rad, int segments);
/// `fineness` = segments of a full circle.
MeshArrays sphere_mesh(float radius, float z_min, float z_max, float phi_max_rad, int fineness);
MeshArrays disk_mesh(float height, float radius, float inner_radius, float phi_max_rad, int fineness);
MeshArrays cylinder_mesh(float radius, float z_min, float z_max, float phi_max_rad, int fineness);

/// Quadrilaterals, four vertices each in pbrt's order (0,0), (1,0), (0,1), (1,1); bent ones become `steps`² smaller quadrilaterals.
MeshArrays bilinear_patches(const MeshArrays& vertices, const std::vector<std::array<std::uint32_t, 4>>& patches, int steps);

}  // namespace sightline::pbrt
