// The scene as the method sees it: rigid objects, and the vertices at which they are lit.
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

class ShadingScene {
 public:
  /// Meshes without normals are flat, so each corner of theirs is a vertex of its own. Throws Error{usage} where a moving node scales
  /// differently along different axes: squares would not stay squares.
  explicit ShadingScene(const World& world);

  const std::vector<ShadingObject>& objects() const { return objects_; }
  const ShadingVertices& vertices() const { return vertices_; }
  /// Object of a hit's instance (kSphereBit allowed).
  std::uint32_t object_of(std::uint32_t instance) const;
  /// Vertices of hit `i`; `position` in world space is read for spheres only.
  VertexHit vertices_of(const HitBatch& hits, std::size_t i, const Vec3& position) const;
  bool any_moving() const;

 private:
  struct Member {
    std::uint32_t object = 0;
    const UVec3* shared = nullptr;  ///< the mesh's own triangles, counted from `base`
    std::uint32_t base = 0;
    std::vector<UVec3> own;  ///< or triangles made anew
  };
  void add_mesh(const World& world, std::uint32_t instance, ShadingObject& object, const Mat4& object_from_member, Member& member);
  void add_sphere(const Sphere& sphere, ShadingObject& object, Member& member);
  void bound(ShadingObject& object) const;

  std::vector<ShadingObject> objects_;
  ShadingVertices vertices_;
  std::vector<Member> instances_, spheres_;
  std::vector<Sphere> sphere_shapes_;
};

/// A scene of one object alone, in its own space, for a tracer: what bakes of it are made from. `position_scale` etc. are left as they are.
Scene object_scene(const Scene& scene, const ShadingObject& object);

}  // namespace sightline::square_lights
