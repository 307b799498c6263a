// Triangle lists from glTF's topologies, and meshes that keep only the vertices they use.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/mesh.h"

namespace sightline::gltf {

enum PrimitiveMode : std::uint64_t { kPoints = 0, kLines, kLineLoop, kLineStrip, kTriangles, kTriangleStrip, kTriangleFan };

/// Number of triangles that `vertex_count` indices make; a rest that makes none is ignored.
std::size_t triangle_count(std::uint64_t mode, std::size_t vertex_count);
/// Triangles over the given indices, all with the winding of the topology.
std::vector<UVec3> assemble_triangles(std::uint64_t mode, std::span<const std::uint32_t> indices);
/// The same for vertices in order.
std::vector<UVec3> assemble_triangles(std::uint64_t mode, std::size_t vertex_count);

/// True where the triangles use but a small part of the vertices, which the mesh then shares with others.
bool uses_few_vertices(const Mesh& mesh);
/// Copies the vertices that triangles use into arrays of the mesh's own and tells which these are. Else every primitive would bring along
/// all that it shares.
std::vector<std::uint32_t> drop_unused_vertices(Mesh& mesh);
/// Gives vertices with a zero normal that of the triangles around them.
void repair_normals(Mesh& mesh);

}  // namespace sightline::gltf
