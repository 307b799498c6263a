// Objects and their vertices in their own spaces: what stays as it is while things merely move.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "methods/square_lights/self_visibility.h"
#include "world/world.h"

namespace sightline::square_lights {

/// What moves as one piece. All that stands still is one object, in world space; instances that hang on the same animated node are another,
/// in the space of that node, in which nothing about them changes.
struct ShadingObject {
  std::string name;
  bool moving = false;
  bool deformable = false;             ///< no visibility: local deformable shading
  Mat4 world_from_object{1};           ///< rotation, translation and uniform scale
  std::vector<std::uint32_t> members;  ///< Scene::instances, or Scene::spheres with kSphereBit
  std::vector<Mat4> object_from_member;
  std::uint32_t first = 0, count = 0;  ///< its vertices
  Vec3 center{0};                      ///< of a sphere around it, in its own space
  float radius = 0;
};

/// Structure of arrays over the vertices of all objects, in the space of their object.
struct ShadingVertices {
  std::vector<Vec3> position, normal, tangent, geometric_normal;
  std::vector<float> error;             ///< bound on the position's error
  std::vector<std::uint32_t> material;  ///< Scene::materials or kDefaultMaterial
  std::size_t size() const { return position.size(); }
  /// Those of one object.
  VertexSpans spans(const ShadingObject& object) const;
};

/// The three vertices, and their weights, between which a hit lies.
struct VertexHit {
  std::array<std::uint32_t, 3> vertex{};
  std::array<float, 3> weight{};
};

/// The scene's objects where they are now, without vertices. Throws Error{usage} where a moving node scales differently along different
/// axes: squares would not stay squares.
std::vector<ShadingObject> collect_objects(const World& world);
/// What the vertices of these objects depend on, so that equal keys mean equal geometry as long as the arrays of meshes that it names by
/// their addresses are kept (ShadingGeometry does).
std::array<std::uint64_t, 2> geometry_key(const World& world, const std::vector<ShadingObject>& objects);

/// Vertices of all objects, and where triangles find theirs. Immutable once built.
class ShadingGeometry {
 public:
  ShadingGeometry(const World& world, const std::vector<ShadingObject>& objects);

  /// Vertices and bounding sphere of an object.
  struct Part {
    std::uint32_t first = 0, count = 0;
    Vec3 center{0};
    float radius = 0;
  };
  const std::vector<Part>& parts() const { return parts_; }
  const ShadingVertices& vertices() const { return vertices_; }
  /// All vertices, object by object; those of moving objects so that neighbours in space follow one another, which then read the same
  /// tables of occluders.
  const std::vector<std::uint32_t>& order() const { return order_; }
  std::uint32_t object_of(std::uint32_t instance) const;
  VertexHit vertices_of(const HitBatch& hits, std::size_t i, const Vec3& position) const;
  std::uint64_t bytes() const;

 private:
  struct Member {
    std::uint32_t object = 0;
    const UVec3* shared = nullptr;  ///< the mesh's own triangles, counted from `base`
    std::uint32_t base = 0;
    std::vector<UVec3> own;  ///< or triangles made anew
  };
  void add_mesh(const World& world, std::uint32_t instance, const Mat4& object_from_member, Member& member);
  void add_sphere(const Sphere& sphere, Member& member);
  void bound(Part& part) const;
  void put_in_order(const Part& part);

  std::vector<Part> parts_;
  ShadingVertices vertices_;
  std::vector<std::uint32_t> order_;
  std::vector<Member> instances_, spheres_;
  std::vector<Sphere> sphere_shapes_;
  std::vector<Mesh> meshes_;  ///< of the scene, whose arrays are shared with it
};

}  // namespace sightline::square_lights
