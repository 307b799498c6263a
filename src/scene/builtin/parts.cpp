#include "scene/builtin/parts.h"

#include <cmath>

namespace sightline::builtin {

std::uint32_t MeshBuilder::vertex(const Vec3& p, const Vec2& uv) {
  positions_.push_back(p);
  uvs_.push_back(uv);
  return static_cast<std::uint32_t>(positions_.size() - 1);
}

MeshBuilder& MeshBuilder::quad(const Vec3& origin, const Vec3& u, const Vec3& v) {
  const std::uint32_t a = vertex(origin, {0, 0}), b = vertex(origin + u, {1, 0}), c = vertex(origin + u + v, {1, 1}),
                      d = vertex(origin + v, {0, 1});
  triangles_.insert(triangles_.end(), {{a, b, c}, {a, c, d}});
  return *this;
}

MeshBuilder& MeshBuilder::triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const std::uint32_t i = vertex(a, {0, 0});
  vertex(b, {1, 0});
  vertex(c, {0, 1});
  triangles_.push_back({i, i + 1, i + 2});
  return *this;
}

MeshBuilder& MeshBuilder::box(const Vec3& center, const Vec3& half, float angle_rad) {
  const float cosine = std::cos(angle_rad), sine = std::sin(angle_rad);
  const Vec3 x = half.x * Vec3(cosine, 0, -sine), y(0, half.y, 0), z = half.z * Vec3(sine, 0, cosine);
  // Each face: outward normal n, and two edges with cross(u, v) along n.
  const auto face = [&](const Vec3& n, const Vec3& u, const Vec3& v) { quad(center + n - u - v, 2.f * u, 2.f * v); };
  face(x, y, z);
  face(-x, z, y);
  face(y, z, x);
  face(-y, x, z);
  face(z, x, y);
  face(-z, y, x);
  return *this;
}

MeshBuilder& MeshBuilder::ball(const Vec3& center, float radius, int rings, bool inward) {
  const int sectors = 2 * rings;
  const auto base = static_cast<std::uint32_t>(positions_.size());
  const auto add = [&](int ring, int sector) {
    const float theta = kPi * static_cast<float>(ring) / static_cast<float>(rings);
    const float phi = 2 * kPi * static_cast<float>(sector) / static_cast<float>(sectors);
    vertex(center + radius * Vec3(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi)),
           {static_cast<float>(sector) / static_cast<float>(sectors), static_cast<float>(ring) / static_cast<float>(rings)});
  };
  // The two poles, then rings without a seam: neighbours share vertices, so the surface is closed.
  vertex(center + Vec3(0, radius, 0), {0.5f, 0});
  vertex(center - Vec3(0, radius, 0), {0.5f, 1});
  for (int ring = 1; ring < rings; ++ring) {
    for (int sector = 0; sector < sectors; ++sector) add(ring, sector);
  }
  const auto at = [&](int ring, int sector) {
    if (ring == 0) return base;
    if (ring == rings) return base + 1;
    return base + 2 + static_cast<std::uint32_t>((ring - 1) * sectors + sector % sectors);
  };
  const auto emit = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles_.push_back(inward ? UVec3(a, c, b) : UVec3(a, b, c));
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int sector = 0; sector < sectors; ++sector) {
      if (ring > 0) emit(at(ring, sector), at(ring + 1, sector), at(ring, sector + 1));
      if (ring + 1 < rings) emit(at(ring, sector + 1), at(ring + 1, sector), at(ring + 1, sector + 1));
    }
  }
  return *this;
}

Mesh MeshBuilder::build(std::string name) const {
  Mesh mesh;
  mesh.name = std::move(name);
  mesh.positions = SharedArray<Vec3>(positions_);
  mesh.uvs = SharedArray<Vec2>(uvs_);
  mesh.triangles = SharedArray<UVec3>(triangles_);
  for (const Vec3& p : positions_) mesh.bounds.add(p);
  return mesh;
}

Mesh ground_mesh(const Vec3& center, float edge, std::uint32_t side) {
  std::vector<Vec3> positions;
  std::vector<UVec3> triangles;
  for (std::uint32_t j = 0; j < side; ++j) {
    for (std::uint32_t i = 0; i < side; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(side - 1) - 0.5f,
                  v = static_cast<float>(j) / static_cast<float>(side - 1) - 0.5f;
      positions.push_back(center + edge * Vec3(u, 0, v));
    }
  }
  for (std::uint32_t j = 0; j + 1 < side; ++j) {
    for (std::uint32_t i = 0; i + 1 < side; ++i) {
      const std::uint32_t a = j * side + i, b = a + 1, c = a + side, d = c + 1;
      triangles.insert(triangles.end(), {{a, c, b}, {b, c, d}});
    }
  }
  Mesh mesh;
  mesh.name = "ground";
  mesh.positions = SharedArray<Vec3>(positions);
  mesh.triangles = SharedArray<UVec3>(triangles);
  for (const Vec3& p : positions) mesh.bounds.add(p);
  return mesh;
}

MaterialId add_material(Scene& scene, std::string name, const SurfaceModel& model) {
  Material material;
  material.name = std::move(name);
  material.model = model;
  scene.materials.push_back(std::move(material));
  return MaterialId(scene.materials.size() - 1);
}

MaterialId add_diffuse(Scene& scene, std::string name, const Color& reflectance) {
  return add_material(scene, std::move(name), DiffuseMaterial{.reflectance = reflectance});
}

MaterialId add_emitter(Scene& scene, std::string name, const Color& radiance) {
  const MaterialId id = add_diffuse(scene, std::move(name), Color(0));
  scene.materials[id.index].emission = radiance;
  return id;
}

MeshId add_mesh(Scene& scene, Mesh mesh, MaterialId material) {
  if (material.valid()) mesh.materials = {material};
  Instance instance;
  instance.name = mesh.name;
  instance.mesh = MeshId(scene.meshes.size());
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back(std::move(instance));
  return scene.instances.back().mesh;
}

void add_sphere(Scene& scene, std::string name, const Vec3& center, float radius, MaterialId material, bool inward) {
  Sphere sphere;
  sphere.name = std::move(name);
  sphere.center = center;
  sphere.radius = radius;
  sphere.reverse_orientation = inward;
  sphere.material = material;
  scene.spheres.push_back(std::move(sphere));
}

void add_camera(Scene& scene, const Vec3& eye, const Vec3& target, float fov_degrees) {
  const Vec3 backwards = glm::normalize(eye - target);
  const Vec3 up = std::fabs(backwards.y) > 0.999f ? Vec3(0, 0, -1) : Vec3(0, 1, 0);
  const Vec3 right = glm::normalize(glm::cross(up, backwards));
  Camera camera;
  camera.name = "camera";
  camera.fov_rad = fov_degrees * kPi / 180;
  camera.focal_distance = glm::length(eye - target);
  camera.world_from_camera = Mat4(Vec4(right, 0), Vec4(glm::cross(backwards, right), 0), Vec4(backwards, 0), Vec4(eye, 1));
  scene.cameras.push_back(std::move(camera));
}

}  // namespace sightline::builtin
