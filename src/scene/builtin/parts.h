// What the builtin scenes are put together from.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "scene/builtin/builtin.h"
#include "scene/scene.h"

namespace sightline::builtin {

/// Collects quads, boxes and balls into one mesh. Quads are flat, so no normals are stored unless a smooth shape asks for them.
class MeshBuilder {
 public:
  /// Corners origin, +u, +u+v, +v; faces along cross(u, v). uv (0,0) is at `origin`.
  MeshBuilder& quad(const Vec3& origin, const Vec3& u, const Vec3& v);
  /// Box centred at `center` with half edges, turned by `angle_rad` about +Y; faces outward.
  MeshBuilder& box(const Vec3& center, const Vec3& half, float angle_rad = 0);
  /// Ball of latitude and longitude lines, as a polyhedron (no smooth normals); faces outward, or inward.
  MeshBuilder& ball(const Vec3& center, float radius, int rings, bool inward = false);
  MeshBuilder& triangle(const Vec3& a, const Vec3& b, const Vec3& c);
  Mesh build(std::string name) const;

 private:
  std::uint32_t vertex(const Vec3& p, const Vec2& uv);

  std::vector<Vec3> positions_;
  std::vector<Vec2> uvs_;
  std::vector<UVec3> triangles_;
};

/// A horizontal square of `side` x `side` vertices that faces up.
Mesh ground_mesh(const Vec3& center, float edge, std::uint32_t side);

MaterialId add_material(Scene& scene, std::string name, const SurfaceModel& model);
MaterialId add_diffuse(Scene& scene, std::string name, const Color& reflectance);
/// Black, one-sided emitter.
MaterialId add_emitter(Scene& scene, std::string name, const Color& radiance);
/// Adds the mesh and one instance of it.
MeshId add_mesh(Scene& scene, Mesh mesh, MaterialId material);
void add_sphere(Scene& scene, std::string name, const Vec3& center, float radius, MaterialId material, bool inward = false);
/// Looks from `eye` to `target`, +Y up; vertical field of view.
void add_camera(Scene& scene, const Vec3& eye, const Vec3& target, float fov_degrees);

/// One entry of the table: `Build` takes the settings struct itself.
template <class S, Scene (*Build)(const S&, const LoadOptions&, const Context&)>
BuiltinScene declare(std::string name, std::string help) {
  return {std::move(name), std::move(help), SettingsValue::of<S>(),
          [](const SettingsValue& parameters, const LoadOptions& options, const Context& context) {
            return Build(parameters.as<S>(), options, context);
          }};
}

}  // namespace sightline::builtin
