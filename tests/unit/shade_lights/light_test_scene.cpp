#include "light_test_scene.h"

#include <cmath>

namespace sightline::test {

Material emissive(const Color& radiance, bool two_sided) {
  Material material;
  material.name = "emitter";
  material.emission = ColorParam(radiance);
  material.emission_two_sided = two_sided;
  return material;
}

Scene scene_with_mesh(std::vector<Vec3> positions, std::vector<UVec3> triangles, const Material& material, const Mat4& transform) {
  Scene scene;
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.positions = SharedArray<Vec3>(positions);
  mesh.triangles = SharedArray<UVec3>(triangles);
  mesh.materials = {MaterialId(std::size_t{0})};
  scene.meshes.push_back(mesh);
  Instance instance;
  instance.mesh = MeshId(std::size_t{0});
  instance.world_from_object = transform;
  scene.instances.push_back(instance);
  return scene;
}

LightTable table_of(const Scene& scene) {
  const Bounds bounds{Vec3(-1 / std::sqrt(3.f)), Vec3(1 / std::sqrt(3.f))};
  const Context context;
  return {scene, TextureSet(scene, context), bounds, context};
}

Color irradiance(const LightTable& table, const Vec3& position, const Vec3& normal, int n) {
  Vec3d sum(0);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      // The pick runs through a permutation of the strata, so that it is independent of the place.
      const int k = (i * 97 + j * 61) % n;
      const float u_pick = (static_cast<float>(k) + 0.5f) / static_cast<float>(n);
      const Vec2 u{(static_cast<float>(i) + 0.5f) / static_cast<float>(n), (static_cast<float>(j) + 0.5f) / static_cast<float>(n)};
      const LightSample s = table.sample(position, normal, u_pick, u);
      if (s.pdf > 0) sum += Vec3d(s.radiance) * static_cast<double>(std::fmax(0.f, glm::dot(s.wi, normal)) / s.pdf);
    }
  }
  return Color(sum / static_cast<double>(n * n));
}

double polygon_irradiance(const std::vector<Vec3>& corners, const Vec3& position, const Vec3& normal) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = glm::normalize(Vec3d(corners[i] - position));
    const Vec3d b = glm::normalize(Vec3d(corners[(i + 1) % corners.size()] - position));
    const Vec3d cross = glm::cross(a, b);
    const double sine = glm::length(cross);
    if (sine > 0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(cross / sine, Vec3d(normal));
  }
  return std::fabs(0.5 * sum);
}

}  // namespace sightline::test
