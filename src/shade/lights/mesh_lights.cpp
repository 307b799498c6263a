#include "shade/lights/mesh_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/core/error.h"
#include "base/parallel/parallel.h"
#include "shade/lights/parallelogram.h"
#include "trace/triangle_uv.h"

namespace sightline {
namespace {

/// The triangle in world space; its normal is the object's front side wherever the transform mirrors.
FlatLight placed_triangle(const Mat4& m, bool mirrored, const std::array<Vec3, 3>& object) {
  const Vec3 v0 = transform_point(m, object[0]), v1 = transform_point(m, object[1]), v2 = transform_point(m, object[2]);
  FlatLight light;
  light.origin = v0;
  light.e1 = v1 - v0;
  light.e2 = v2 - v0;
  // In double: slender triangles far from the origin keep a normal.
  const Vec3d cross = glm::cross(Vec3d(light.e1), Vec3d(light.e2));
  const double length = glm::length(cross);
  if (length > 0 && std::isfinite(length)) {
    light.normal = Vec3(mirrored ? -cross / length : cross / length);
    light.area = static_cast<float>(0.5 * length);
  }
  // Bound on the rounding of M p and of v0 + a e1 + b e2, per component.
  float largest = 0;
  for (const Vec3& p : object) {
    for (int row = 0; row < 3; ++row) {
      const float sum = std::fabs(m[0][row] * p.x) + std::fabs(m[1][row] * p.y) + std::fabs(m[2][row] * p.z) + std::fabs(m[3][row]);
      largest = std::max(largest, sum);
    }
  }
  light.point_error = 6 * std::numeric_limits<float>::epsilon() * largest;
  return light;
}

/// Mean of the emission texture over a triangle: four sub-triangles, each by a look-up with its own footprint. Where the look-ups miss
/// what little emits, a share of the texture's mean keeps the light's power above 0.
float mean_luminance_over(const TextureSet& textures, TextureId texture, const std::array<Vec2, 3>& uv, float texture_mean) {
  const Vec2 d1 = 0.5f * (uv[1] - uv[0]), d2 = 0.5f * (uv[2] - uv[0]);
  const Vec2 center = (uv[0] + uv[1] + uv[2]) / 3.f;
  float sum = 0;
  for (const Vec2& p : {center, 0.5f * (center + uv[0]), 0.5f * (center + uv[1]), 0.5f * (center + uv[2])}) {
    sum += std::max(0.f, luminance(Color(textures.sample(texture, {p, d1, d2}))));
  }
  return std::max(0.25f * sum, 0.01f * texture_mean);
}

}  // namespace

Color usable_emission(const Scene& scene, MaterialId material) {
  if (!material.valid() || material.index >= scene.materials.size()) return Color(0);
  const Material& m = scene.materials[material.index];
  // Rays pass through interfaces, so nothing could weigh their light against BSDF sampling.
  if (std::holds_alternative<InterfaceMaterial>(m.model)) return Color(0);
  const Color emission = glm::max(m.emission.value, Color(0));
  return is_finite(m.emission.value) ? emission : Color(0);
}

MeshLights::MeshLights(const Scene& scene, const TextureSet& textures, const Context& context, AlignedVector<FlatLight>& lights,
                       std::vector<FlatEmitter>& emitters, std::vector<float>& powers)
    : sources_(scene.instances.size()) {
  for (std::size_t i = 0; i < scene.instances.size(); ++i) add_instance(scene, textures, context, i, lights, emitters, powers);
}

void MeshLights::add_instance(const Scene& scene, const TextureSet& textures, const Context& context, std::size_t instance_index,
                              AlignedVector<FlatLight>& lights, std::vector<FlatEmitter>& emitters, std::vector<float>& powers) {
  const Instance& instance = scene.instances[instance_index];
  if (instance.mesh.index >= scene.meshes.size()) throw input_error("the instance's mesh does not exist").at(instance.name);
  const Mesh& mesh = scene.meshes[instance.mesh.index];

  // Two emitters a slot of the palette that emits: for its triangles, and after it for its parallelograms.
  const bool overridden = instance.material_override.valid();
  std::vector<MaterialId> palette = overridden ? std::vector<MaterialId>{instance.material_override} : mesh.materials;
  std::vector<std::uint32_t> emitter_of(palette.size(), kNoLight);
  std::vector<float> texture_mean(palette.size(), 1);
  bool any = false, all = !palette.empty();
  for (std::size_t slot = 0; slot < palette.size(); ++slot) {
    const Color radiance = usable_emission(scene, palette[slot]);
    if (is_black(radiance)) {
      all = false;
      continue;
    }
    any = true;
    const Material& material = scene.materials[palette[slot].index];
    FlatEmitter emitter;
    emitter.radiance = radiance;
    emitter.flags = FlatEmitter::kTriangle | FlatEmitter::kMesh | (material.emission_two_sided ? FlatEmitter::kTwoSided : 0u);
    if (material.emission.texture.valid()) {
      emitter.flags |= FlatEmitter::kTextured;
      emitter.texture = material.emission.texture;
      texture_mean[slot] = std::max(0.f, luminance(Color(textures.mean(emitter.texture))));
    }
    emitter.source = static_cast<std::uint32_t>(instance_index);
    emitter_of[slot] = static_cast<std::uint32_t>(emitters.size());
    emitters.push_back(emitter);
    emitter.flags &= ~static_cast<std::uint32_t>(FlatEmitter::kTriangle);
    emitters.push_back(emitter);
  }
  if (!any) return;
  if (mesh.source) {
    context.warn(fmt::format("mesh '{}' is streamed and emits; it is lit by camera and bounce rays only", mesh.name));
    return;
  }

  // Lights in the order of triangles.
  const auto slot_of = [&](std::size_t triangle) -> std::size_t {
    return overridden || mesh.triangle_materials.empty() ? 0 : mesh.triangle_materials[triangle];
  };
  Source& source = sources_[instance_index];
  source.first = static_cast<std::uint32_t>(lights.size());
  source.triangles = mesh.triangles;
  source.uvs = mesh.uvs;
  std::vector<std::uint32_t> primitives;
  if (!all && !(overridden || mesh.triangle_materials.empty())) {
    source.index_of.assign(mesh.triangles.size(), kNoLight);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (slot_of(t) >= palette.size() || emitter_of[slot_of(t)] == kNoLight) continue;
      source.index_of[t] = static_cast<std::uint32_t>(primitives.size());
      primitives.push_back(static_cast<std::uint32_t>(t));
    }
  } else if (emitter_of[0] == kNoLight) {
    source = {};
    return;
  }
  // A parallelogram is one light: its samples are stratified as a whole, and there is one choice less to make.
  const bool dense = source.index_of.empty();
  const std::size_t triangle_count = dense ? mesh.triangles.size() : primitives.size();
  const auto corners_of = [&](std::size_t t) -> TriangleCorners {
    const UVec3 corner = mesh.triangles[t];
    return {mesh.positions[corner.x], mesh.positions[corner.y], mesh.positions[corner.z]};
  };
  const auto is_valid = [&](std::size_t t) {
    const UVec3 corner = mesh.triangles[t];
    return std::max({corner.x, corner.y, corner.z}) < mesh.positions.size() && slot_of(t) < palette.size();
  };
  const auto shape_of_pair = [&](std::size_t t, std::size_t partner) -> std::optional<TriangleCorners> {
    const bool alike = is_valid(t) && is_valid(partner) && slot_of(t) == slot_of(partner);
    if (!alike || emitters[emitter_of[slot_of(t)]].is(FlatEmitter::kTextured)) return std::nullopt;
    return parallelogram_of(corners_of(t), corners_of(partner));
  };
  struct Part {
    std::uint32_t primitive, partner;
  };
  std::vector<Part> parts;
  for (std::size_t i = 0; i < triangle_count; ++i) {
    const auto primitive_at = [&](std::size_t k) { return dense ? static_cast<std::uint32_t>(k) : primitives[k]; };
    const std::uint32_t t = primitive_at(i);
    const bool pair = i + 1 < triangle_count && shape_of_pair(t, primitive_at(i + 1)).has_value();
    parts.push_back({t, pair ? primitive_at(++i) : kNoLight});
  }
  const std::size_t count = parts.size();
  if (count < triangle_count) {
    source.index_of.assign(mesh.triangles.size(), kNoLight);
    for (std::size_t i = 0; i < count; ++i) {
      source.index_of[parts[i].primitive] = static_cast<std::uint32_t>(i);
      if (parts[i].partner != kNoLight) source.index_of[parts[i].partner] = static_cast<std::uint32_t>(i);
    }
  }
  if (count + lights.size() >= kNoLight) throw resource_error("more than 2^32 emissive triangles").at(mesh.name);

  const Mat4& m = instance.world_from_object;
  const bool mirrored = glm::determinant(glm::mat3(m)) < 0;
  const std::size_t base = lights.size();
  lights.resize(base + count);
  powers.resize(base + count);
  parallel_for(context, count, 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto [t, partner] = parts[i];
      if (!is_valid(t)) continue;
      const std::size_t slot = slot_of(t);
      const bool pair = partner != kNoLight;
      FlatLight& light = lights[base + i];
      light = placed_triangle(m, mirrored, pair ? *shape_of_pair(t, partner) : corners_of(t));
      if (pair) light.area *= 2, light.point_error *= 3;  // the fourth corner lies at most three times as far out as the others
      light.emitter = emitter_of[slot] + (pair ? 1 : 0);
      light.primitive = t;
      const FlatEmitter& emitter = emitters[light.emitter];
      float mean = luminance(emitter.radiance);
      if (emitter.is(FlatEmitter::kTextured)) {
        mean *= mean_luminance_over(textures, emitter.texture, corner_uvs(mesh.uvs, mesh.triangles[t]), texture_mean[slot]);
      }
      powers[base + i] = mean * light.area * kPi * (emitter.is(FlatEmitter::kTwoSided) ? 2.f : 1.f);
    }
  });
}

std::uint32_t MeshLights::light_of(std::uint32_t instance, std::uint32_t primitive) const {
  if (instance >= sources_.size()) return kNoLight;
  const Source& source = sources_[instance];
  if (source.first == kNoLight || primitive >= source.triangles.size()) return kNoLight;
  const std::uint32_t offset = source.index_of.empty() ? primitive : source.index_of[primitive];
  return offset == kNoLight ? kNoLight : source.first + offset;
}

Vec2 MeshLights::uv(const FlatEmitter& emitter, std::uint32_t primitive, const Vec2& ab) const {
  const Source& source = sources_[emitter.source];
  return interpolate_uv(corner_uvs(source.uvs, source.triangles[primitive]), ab.x, ab.y);
}

std::uint64_t MeshLights::memory_bytes() const {
  std::uint64_t bytes = sources_.size() * sizeof(Source);
  for (const Source& source : sources_) bytes += source.index_of.size() * sizeof(std::uint32_t);
  return bytes;
}

}  // namespace sightline
