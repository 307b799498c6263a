#include "methods/square_lights/shading_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>
#include <unordered_map>

#include "bake/bake_file.h"
#include "base/core/error.h"
#include "world/surface.h"

namespace sightline::square_lights {
namespace {

// Vertices of the net that stands for an analytic sphere: rings from pole to pole, and points along each.
constexpr std::uint32_t kRings = 48, kMeridians = 96;
constexpr std::uint32_t kNone = ~0u;
// Normals that differ by less, as unit vectors, are of one plane.
constexpr float kSameNormal = 1e-3f;

/// Node that carries an instance through time: the nearest animated one at or above it; invalid if it stands still.
NodeId carrier(const Scene& scene, NodeId node) {
  while (node.index < scene.nodes.size()) {
    if (scene.nodes[node.index].is_animated()) return node;
    node = scene.nodes[node.index].parent;
  }
  return {};
}

/// Matrix from an instance's space to that of its carrier: the same at all times, to the last bit.
Mat4 carrier_from_node(const Scene& scene, NodeId node, NodeId carrier) {
  Mat4 matrix(1);
  for (; node != carrier && node.index < scene.nodes.size(); node = scene.nodes[node.index].parent)
    matrix = node_matrix(scene.nodes[node.index], 0) * matrix;
  return matrix;
}

bool scales_uniformly(const Mat4& m) {
  const float x = glm::length(Vec3(m[0])), y = glm::length(Vec3(m[1])), z = glm::length(Vec3(m[2]));
  const float most = std::max({x, y, z});
  const Mat3 linear(m);
  const float skew = std::max(
      {std::fabs(glm::dot(linear[0], linear[1])), std::fabs(glm::dot(linear[1], linear[2])), std::fabs(glm::dot(linear[0], linear[2]))});
  return std::min({x, y, z}) > 0.999f * most && skew < 2e-3f * most * most;
}

/// Mean dp/du at each vertex of a mesh that has texture coordinates but no tangents.
std::vector<Vec3> tangents_of(const Mesh& mesh) {
  std::vector<Vec3> tangents(mesh.positions.size(), Vec3(0));
  if (!mesh.tangents.empty()) {
    for (std::size_t i = 0; i < tangents.size(); ++i) tangents[i] = Vec3(mesh.tangents[i]);
    return tangents;
  }
  if (mesh.uvs.empty()) return tangents;
  for (const UVec3& t : mesh.triangles) {
    const Vec2 a = mesh.uvs[t.y] - mesh.uvs[t.x], b = mesh.uvs[t.z] - mesh.uvs[t.x];
    const float determinant = a.x * b.y - a.y * b.x;
    if (determinant == 0) continue;
    const Vec3 e1 = mesh.positions[t.y] - mesh.positions[t.x], e2 = mesh.positions[t.z] - mesh.positions[t.x];
    const Vec3 dp_du = normalize_or((b.y * e1 - a.y * e2) / determinant, Vec3(0)) * glm::length(glm::cross(e1, e2));
    for (int k = 0; k < 3; ++k) tangents[t[k]] += dp_du;
  }
  return tangents;
}

float largest(const Vec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

}  // namespace

VertexSpans ShadingVertices::spans(const ShadingObject& object) const {
  const auto part = [&](const auto& all) { return std::span(all).subspan(object.first, object.count); };
  return {part(position), part(normal), part(tangent), part(geometric_normal), part(error)};
}

std::vector<ShadingObject> collect_objects(const World& world) {
  std::vector<ShadingObject> objects;
  const Scene& scene = world.scene();
  const Placement& placement = world.tracer().placement();

  // Members by what carries them; what stands still comes first.
  ShadingObject still;
  still.name = "static";
  std::map<std::uint32_t, ShadingObject> moving;
  std::vector<ShadingObject> bending;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (placement.instances[i].kind == PlacedMesh::Kind::absent) continue;
    if (scene.meshes[instance.mesh.index].is_deformable()) {
      ShadingObject& object = bending.emplace_back();
      object.name = instance.name, object.deformable = true;
      object.members = {i}, object.object_from_member = {instance.world_from_object};
      continue;
    }
    const NodeId by = carrier(scene, instance.node);
    if (!by.valid()) {
      still.members.push_back(i), still.object_from_member.push_back(instance.world_from_object);
      continue;
    }
    ShadingObject& object = moving[by.index];
    const Mat4 object_from_member = carrier_from_node(scene, instance.node, by);
    if (object.members.empty()) {
      object.name = scene.nodes[by.index].name.empty() ? fmt::format("node {}", by.index) : scene.nodes[by.index].name;
      object.moving = true;
      object.world_from_object = instance.world_from_object * glm::inverse(object_from_member);
      if (!scales_uniformly(object.world_from_object))
        throw usage_error(fmt::format("square-lights: '{}' moves and is scaled differently along its axes", object.name))
            .remedy("apply the scale to the mesh, or use --method reference");
    }
    object.members.push_back(i), object.object_from_member.push_back(object_from_member);
  }
  for (std::uint32_t i = 0; i < scene.spheres.size(); ++i)
    still.members.push_back(i | kSphereBit), still.object_from_member.push_back(Mat4(1));
  if (!still.members.empty()) objects.push_back(std::move(still));
  for (auto& [node, object] : moving) objects.push_back(std::move(object));
  std::move(bending.begin(), bending.end(), std::back_inserter(objects));
  return objects;
}

std::array<std::uint64_t, 2> geometry_key(const World& world, const std::vector<ShadingObject>& objects) {
  const Scene& scene = world.scene();
  BakeHash hash;
  const auto add_array = [&](const auto& array) { hash.add(std::bit_cast<std::uintptr_t>(array.data())).add(array.size()); };
  const auto add_id = [&](MaterialId id) { hash.add(id.valid() ? id.index : kDefaultMaterial); };
  hash.add(scene.instances.size()).add(scene.spheres.size());
  for (const ShadingObject& object : objects) {
    hash.add(object.moving).add(object.deformable).add(std::span<const std::uint32_t>(object.members));
    hash.add(std::span<const Mat4>(object.object_from_member));
    for (const std::uint32_t index : object.members) {
      if (index & kSphereBit) {
        const Sphere& sphere = scene.spheres[index & ~kSphereBit];
        hash.add(sphere.center.x).add(sphere.center.y).add(sphere.center.z).add(sphere.radius).add(sphere.reverse_orientation);
        add_id(sphere.material);
        continue;
      }
      const Instance& instance = scene.instances[index];
      const Mesh& mesh = scene.meshes[instance.mesh.index];
      add_array(mesh.positions), add_array(mesh.normals), add_array(mesh.uvs), add_array(mesh.tangents), add_array(mesh.triangles);
      add_array(mesh.triangle_materials);
      hash.add(mesh.materials.size());
      for (const MaterialId id : mesh.materials) add_id(id);
      add_id(instance.material_override);
    }
  }
  return hash.key();
}

ShadingGeometry::ShadingGeometry(const World& world, const std::vector<ShadingObject>& objects) {
  const Scene& scene = world.scene();
  instances_.resize(scene.instances.size());
  spheres_.resize(scene.spheres.size());
  sphere_shapes_ = scene.spheres;
  meshes_ = scene.meshes;
  for (std::uint32_t o = 0; o < objects.size(); ++o) {
    const ShadingObject& object = objects[o];
    Part& part = parts_.emplace_back();
    part.first = static_cast<std::uint32_t>(vertices_.size());
    for (std::size_t m = 0; m < object.members.size(); ++m) {
      const std::uint32_t index = object.members[m];
      Member& member = index & kSphereBit ? spheres_[index & ~kSphereBit] : instances_[index];
      member.object = o;
      if (index & kSphereBit)
        add_sphere(scene.spheres[index & ~kSphereBit], member);
      else
        add_mesh(world, index, object.object_from_member[m], member);
    }
    part.count = static_cast<std::uint32_t>(vertices_.size()) - part.first;
    bound(part);
    if (object.moving)
      put_in_order(part);
    else
      for (std::uint32_t i = 0; i < part.count; ++i) order_.push_back(part.first + i);
  }
}

void ShadingGeometry::add_mesh(const World& world, std::uint32_t index, const Mat4& object_from_member, Member& member) {
  const Scene& scene = world.scene();
  const Instance& instance = scene.instances[index];
  const Mesh& mesh = scene.meshes[instance.mesh.index];
  const Mat3 normal_matrix = glm::transpose(glm::inverse(Mat3(object_from_member)));
  const Mat3 member_from_object = glm::transpose(Mat3(object_from_member));  // of normals, up to scale
  const float winding = glm::determinant(Mat3(object_from_member)) < 0 ? -1.f : 1.f;
  const std::vector<Vec3> tangents = tangents_of(mesh);
  const auto material_of = [&](std::size_t triangle) {
    const MaterialId id = instance.material_override.valid() ? instance.material_override : mesh.material_of(triangle);
    return id.valid() ? id.index : kDefaultMaterial;
  };
  std::vector<Vec3> positions(mesh.positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = transform_point(object_from_member, mesh.positions[i]);

  const auto base = static_cast<std::uint32_t>(vertices_.size());
  std::vector<Vec3> geometric;  // area-weighted, by shading vertex from `base`
  const auto add = [&](std::uint32_t vertex, const Vec3& normal, std::uint32_t material) {
    vertices_.position.push_back(positions[vertex]);
    vertices_.normal.push_back(normal);
    // Where nothing else says how a vertex's frame is turned, its mesh does: squares then lie the same way wherever the instance is turned.
    Vec3 tangent = tangents[vertex];
    if (length_squared(tangent) == 0) tangent = frame_from_normal(normalize_or(member_from_object * normal, Vec3(0, 0, 1))).tangent;
    vertices_.tangent.push_back(transform_vector(object_from_member, tangent));
    vertices_.material.push_back(material);
    geometric.emplace_back(0);
    return static_cast<std::uint32_t>(vertices_.size()) - 1;
  };
  const bool one_material = instance.material_override.valid() || mesh.triangle_materials.empty();
  const bool smooth = !mesh.normals.empty();
  if (smooth && one_material) {
    for (std::uint32_t v = 0; v < positions.size(); ++v)
      add(v, normalize_or(normal_matrix * mesh.normals[v], Vec3(0, 0, 1)), material_of(0));
    member.shared = mesh.triangles.data(), member.base = base;
  }
  std::unordered_map<std::uint64_t, std::uint32_t> known;  // (vertex, material), for smooth meshes of several materials
  // Corners of flat triangles around a vertex that lie in one plane are one: the last that was made of it and the one before, by chains.
  std::vector<std::uint32_t> last(smooth ? 0 : positions.size(), kNone), before;
  const auto flat_corner = [&](std::uint32_t vertex, const Vec3& normal, std::uint32_t material) {
    for (std::uint32_t i = last[vertex]; i != kNone; i = before[i - base]) {
      if (vertices_.material[i] == material && length_squared(vertices_.normal[i] - normal) < kSameNormal * kSameNormal) return i;
    }
    before.push_back(last[vertex]);
    return last[vertex] = add(vertex, normal, material);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const UVec3& corners = mesh.triangles[t];
    const Vec3 twice_area = winding * glm::cross(positions[corners.y] - positions[corners.x], positions[corners.z] - positions[corners.x]);
    UVec3 triangle = corners + base;
    if (!member.shared) {
      const std::uint32_t material = material_of(t);
      for (int k = 0; k < 3; ++k) {
        if (!smooth) {
          triangle[k] = flat_corner(corners[k], normalize_or(twice_area, Vec3(0, 0, 1)), material);
          continue;
        }
        const auto [at, fresh] = known.try_emplace(std::uint64_t{material} << 32 | corners[k], 0);
        if (fresh) at->second = add(corners[k], normalize_or(normal_matrix * mesh.normals[corners[k]], Vec3(0, 0, 1)), material);
        triangle[k] = at->second;
      }
      member.own.push_back(triangle);
    }
    for (int k = 0; k < 3; ++k) geometric[triangle[k] - base] += twice_area;
  }
  for (std::size_t i = 0; i < geometric.size(); ++i) {
    Vec3& normal = vertices_.normal[base + i];
    const Vec3 up = normalize_or(geometric[i], normal);
    // Shading normals lie on the side that the winding says is the front, as World has it.
    if (glm::dot(up, normal) < 0) normal = -normal;
    vertices_.geometric_normal.push_back(up);
    vertices_.error.push_back(4e-7f * (largest(vertices_.position[base + i]) + largest(Vec3(object_from_member[3]))));
  }
}

void ShadingGeometry::add_sphere(const Sphere& sphere, Member& member) {
  member.base = static_cast<std::uint32_t>(vertices_.size());
  const float side = sphere.reverse_orientation ? -1.f : 1.f;
  for (std::uint32_t ring = 0; ring <= kRings; ++ring) {
    for (std::uint32_t k = 0; k <= kMeridians; ++k) {
      const float theta = kPi * static_cast<float>(ring) / kRings, phi = 2 * kPi * static_cast<float>(k) / kMeridians;
      const Vec3 d(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      vertices_.position.push_back(sphere.center + sphere.radius * d);
      vertices_.normal.push_back(side * d);
      vertices_.geometric_normal.push_back(side * d);
      vertices_.tangent.push_back({-std::sin(phi), 0, std::cos(phi)});
      vertices_.error.push_back(8e-7f * (largest(sphere.center) + sphere.radius));
      vertices_.material.push_back(sphere.material.valid() ? sphere.material.index : kDefaultMaterial);
    }
  }
}

void ShadingGeometry::bound(Part& part) const {
  Bounds bounds;
  const std::span<const Vec3> positions = std::span(vertices_.position).subspan(part.first, part.count);
  for (const Vec3& p : positions) bounds.add(p);
  if (bounds.is_empty()) return;
  part.center = 0.5f * (bounds.lower + bounds.upper);
  float radius2 = 0;
  for (const Vec3& p : positions) radius2 = std::max(radius2, length_squared(p - part.center));
  part.radius = std::sqrt(radius2) * (1 + 1e-5f);
}

std::uint32_t ShadingGeometry::object_of(std::uint32_t instance) const {
  return instance & kSphereBit ? spheres_[instance & ~kSphereBit].object : instances_[instance].object;
}

VertexHit ShadingGeometry::vertices_of(const HitBatch& hits, std::size_t i, const Vec3& position) const {
  const std::uint32_t instance = hits.instance[i];
  if (instance & kSphereBit) {
    const Sphere& sphere = sphere_shapes_[instance & ~kSphereBit];
    const Vec3 d = normalize_or(position - sphere.center, Vec3(0, 1, 0));
    const float ring = std::acos(std::clamp(d.y, -1.f, 1.f)) / kPi * kRings;
    float turn = std::atan2(d.z, d.x) / (2 * kPi);
    turn = (turn < 0 ? turn + 1 : turn) * kMeridians;
    const auto r = static_cast<std::uint32_t>(std::clamp(ring, 0.f, kRings - 1.f)),
               k = static_cast<std::uint32_t>(std::clamp(turn, 0.f, kMeridians - 1.f));
    const float y = ring - static_cast<float>(r), x = turn - static_cast<float>(k);
    const std::uint32_t base = spheres_[instance & ~kSphereBit].base, a = base + r * (kMeridians + 1) + k, b = a + kMeridians + 1;
    if (x + y <= 1) return {{a, a + 1, b}, {1 - x - y, x, y}};
    return {{b + 1, b, a + 1}, {x + y - 1, 1 - x, 1 - y}};
  }
  const Member& member = instances_[instance];
  const float u = hits.u[i], v = hits.v[i];
  const UVec3 t = member.shared ? member.shared[hits.primitive[i]] + member.base : member.own[hits.primitive[i]];
  return {{t.x, t.y, t.z}, {1 - u - v, u, v}};
}

// Along a curve that visits the cells of a grid in blocks: three bits of ten, by turns.
void ShadingGeometry::put_in_order(const Part& part) {
  const auto spread = [](std::uint32_t v) {
    v = (v | v << 16) & 0x030000ff, v = (v | v << 8) & 0x0300f00f, v = (v | v << 4) & 0x030c30c3;
    return (v | v << 2) & 0x09249249;
  };
  const float scale = part.radius > 0 ? 511.f / part.radius : 0;
  std::vector<std::uint64_t> places;
  places.reserve(part.count);
  for (std::uint32_t i = part.first; i < part.first + part.count; ++i) {
    std::uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float cell = (vertices_.position[i][axis] - part.center[axis]) * scale + 511;
      code |= spread(static_cast<std::uint32_t>(std::clamp(cell, 0.f, 1023.f))) << axis;
    }
    places.push_back(std::uint64_t{code} << 32 | i);
  }
  std::sort(places.begin(), places.end());
  for (const std::uint64_t place : places) order_.push_back(static_cast<std::uint32_t>(place));
}

std::uint64_t ShadingGeometry::bytes() const {
  std::uint64_t bytes = vertices_.size() * (4 * sizeof(Vec3) + sizeof(float) + 2 * sizeof(std::uint32_t));
  for (const std::vector<Member>* members : {&instances_, &spheres_}) {
    for (const Member& member : *members) bytes += sizeof(Member) + member.own.size() * sizeof(UVec3);
  }
  return bytes;
}

}  // namespace sightline::square_lights
