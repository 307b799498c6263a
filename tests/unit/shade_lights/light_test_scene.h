// Small scenes of one light, and estimates of what it does.
#pragma once

#include <optional>

#include "scene/scene.h"
#include "shade/light_table.h"

namespace sightline::test {

/// A scene with one light that is not geometry.
template <class Shape>
Scene scene_with(const Shape& shape) {
  Scene scene;
  scene.lights.push_back({"light", shape, {}});
  return scene;
}
/// One emissive mesh; `palette` may differ from triangle to triangle.
Scene scene_with_mesh(std::vector<Vec3> positions, std::vector<UVec3> triangles, const Material& material, const Mat4& transform = Mat4(1));
Material emissive(const Color& radiance, bool two_sided = false);

/// The table of a scene with textures of its own; bounds of radius 1 around the origin.
LightTable table_of(const Scene& scene);

/// Irradiance at a point from stratified light samples: n² of them, a multiple pick numbers spread evenly. All samples count that lie above
/// the surface.
Color irradiance(const LightTable& table, const Vec3& position, const Vec3& normal, int n = 256);

/// Irradiance of a polygon of radiance 1, seen from its front and wholly above the horizon: Lambert's formula.
double polygon_irradiance(const std::vector<Vec3>& corners, const Vec3& position, const Vec3& normal);

}  // namespace sightline::test
