// Eye paths of whole pictures, and scenes to send them into.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "methods/visibility_cache/eye_paths.h"
#include "unit/trace/trace_scenes.h"

namespace sightline::test {

inline Camera camera_at(const Vec3& eye, const Vec3& target, float fov_rad) {
  Camera camera;
  const Vec3 back = glm::normalize(eye - target);
  const Vec3 right = glm::normalize(glm::cross(std::fabs(back.y) > 0.9f ? Vec3{0, 0, 1} : Vec3{0, 1, 0}, back));
  camera.world_from_camera = Mat4(Vec4(right, 0), Vec4(glm::cross(back, right), 0), Vec4(back, 0), Vec4(eye, 1));
  camera.fov_rad = fov_rad;
  return camera;
}

/// Square of half width `size` about `center` with unit normal `normal`.
inline Mesh square(const Vec3& center, const Vec3& normal, float size) {
  const Frame3 f = frame_from_normal(normal);
  const Vec3 a = size * f.tangent, b = size * f.bitangent;
  return make_mesh({center - a - b, center + a - b, center + a + b, center - a + b}, {{0, 1, 2}, {0, 2, 3}});
}

/// Sphere of triangles with smooth normals.
inline Mesh smooth_sphere(const Vec3& center, float radius, std::uint32_t rings) {
  std::vector<Vec3> positions, normals;
  std::vector<UVec3> triangles;
  const std::uint32_t columns = 2 * rings;
  for (std::uint32_t r = 0; r <= rings; ++r) {
    for (std::uint32_t c = 0; c <= columns; ++c) {
      const float theta = kPi * static_cast<float>(r) / static_cast<float>(rings);
      const float phi = 2 * kPi * static_cast<float>(c) / static_cast<float>(columns);
      normals.push_back({std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi)});
      positions.push_back(center + radius * normals.back());
      if (r == rings || c == columns) continue;
      const std::uint32_t i = r * (columns + 1) + c, below = i + columns + 1;
      if (r > 0) triangles.push_back({i, below, i + 1});
      if (r + 1 < rings) triangles.push_back({i + 1, below, below + 1});
    }
  }
  Mesh mesh = make_mesh(positions, triangles);
  mesh.normals = normals;
  return mesh;
}

inline MaterialId add_material(Scene& scene, const SurfaceModel& model, const Color& emission = Color(0)) {
  Material material;
  material.model = model, material.emission.value = emission;
  scene.materials.push_back(material);
  return MaterialId(scene.materials.size() - 1);
}

inline void place(Scene& scene, Mesh mesh, MaterialId material) {
  mesh.materials = {material};
  place(scene, std::move(mesh));
}

inline void place_sphere(Scene& scene, const Vec3& center, float radius, MaterialId material) {
  Sphere sphere;
  sphere.center = center, sphere.radius = radius, sphere.material = material;
  scene.spheres.push_back(sphere);
}

struct Take {
  IVec2 size_px{64, 64};
  PixelFilter::Kind filter = PixelFilter::Kind::centre;
  SampleRange range{0, 1};
  std::uint32_t pass_samples = 1;
  EyePathOptions options{};
  AovSet aovs{};
};

/// An eye sample and whose it is.
struct Seen {
  std::uint32_t pixel, sample;
  EyeSample eye;
};

struct Taken {
  std::vector<Seen> seen;      ///< tile by tile
  std::vector<Color> emitted;  ///< sum over the samples of each pixel
  Frame frame;
  RayCounts rays;
};

inline Taken take(const World& world, const Camera& camera, const Take& how) {
  const View view(camera, how.size_px, PixelFilter(how.filter));
  Taken taken{{}, std::vector<Color>(view.pixel_count(), Color(0)), Frame(how.size_px.x, how.size_px.y, how.aovs), {}};
  EyePaths eye_paths(world, view, how.options);
  TilePaths paths;
  std::vector<EyeSample> samples;
  for (std::size_t t = 0; t < taken.frame.tile_count(); ++t) {
    eye_paths.trace(taken.frame.tile(t), how.range, how.pass_samples, paths, samples, taken.frame, taken.rays);
    for (const EyeSample& eye : samples) taken.seen.push_back({paths.pixel[eye.slot], paths.sample[eye.slot], eye});
    for (std::size_t i = 0; i < paths.count; ++i) {
      if (paths.inside[i]) taken.emitted[paths.pixel[i]] += Color(paths.emitted.x[i], paths.emitted.y[i], paths.emitted.z[i]);
    }
  }
  return taken;
}

inline double total_area(const Taken& taken) {
  double sum = 0;
  for (const Seen& seen : taken.seen) sum += static_cast<double>(seen.eye.area);
  return sum;
}

}  // namespace sightline::test
