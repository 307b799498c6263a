// The last step: files are read in parallel, names resolved, and everything is put into the Scene.
#include <algorithm>
#include <cmath>
#include <system_error>

#include "base/parallel/parallel.h"
#include "base/settings/settings.h"
#include "scene/load/load.h"
#include "scene/load/pbrt/builder.h"
#include "scene/load/pbrt/environment.h"
#include "scene/load/pbrt/merge_meshes.h"
#include "scene/load/pbrt/transform.h"

namespace sightline::pbrt {
namespace {

std::uint64_t size_of_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  return error ? 0 : size;
}

/// Shapes that pbrt takes as one for an area light's power; of meshes it takes each triangle.
bool is_one_shape(const std::string& name) { return name == "sphere" || name == "disk" || name == "cylinder"; }

}  // namespace

void Builder::load_meshes_of(const std::vector<std::size_t>& shapes) {
  ShapeEntry& first = shapes_[shapes.front()];
  try {
    const Mesh mesh = read_ply_mesh(first.file, context_, &first.dropped);
    // A mesh that is used once is baked into world space; of others one copy an orientation stays in its own space.
    const bool is_shared = shapes.size() > 1;
    std::optional<Mesh> sides[2];
    for (const std::size_t index : shapes) {
      ShapeEntry& shape = shapes_[index];
      shape.is_shared = is_shared && shape.object == kNoSlot;
      if (!shape.is_shared) {
        shape.mesh = bake(mesh, shape.world_from_object, shape.reverse_orientation);
        continue;
      }
      std::optional<Mesh>& side = sides[shape.reverse_orientation ? 1 : 0];
      if (!side) side = bake(mesh, Mat4d(1), shape.reverse_orientation);
      shape.mesh = *side;
    }
  } catch (Error& error) {
    if (error.code() != ErrorCode::interrupted) error.during("reading the plymesh of " + first.place.text());
    first.error = std::make_exception_ptr(error);
  } catch (...) {
    first.error = std::current_exception();
  }
}

void Builder::load_files() {
  struct Job {
    std::uint64_t bytes = 0;
    ImageEntry* image = nullptr;
    const std::vector<std::size_t>* shapes = nullptr;
  };
  std::vector<Job> jobs;
  for (ImageEntry& image : images_) {
    if (directory_)
      jobs.push_back({size_of_file(image.path), &image, nullptr});
    else
      warn(image.place, fmt::format("image '{}' is not read: other files are out of reach", shown(image.path.string())));
  }
  for (const auto& [file, shapes] : shapes_of_file_) {
    std::error_code error;
    if (directory_ && std::filesystem::is_regular_file(file, error)) {
      jobs.push_back({size_of_file(file), nullptr, &shapes});
    } else {
      warn(shapes_[shapes.front()].place, fmt::format("mesh file '{}' is not there; the shape is left out", shown(file)));
    }
  }
  // The largest first, so that no long one starts last.
  std::sort(jobs.begin(), jobs.end(), [](const Job& a, const Job& b) { return a.bytes > b.bytes; });
  parallel_for(context_, jobs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (jobs[i].shapes != nullptr) {
        load_meshes_of(*jobs[i].shapes);
        continue;
      }
      Scene messages;  // one each: a Scene is not for several threads
      jobs[i].image->image = load_texture_image(jobs[i].image->path, messages, Context{});
      jobs[i].image->warnings = std::move(messages.warnings);
    }
  });
  // Reported in the order of the file, whatever the threads did.
  for (const ImageEntry& image : images_) {
    for (const std::string& text : image.warnings) warn(image.place, text);
  }
  for (const ShapeEntry& shape : shapes_) {
    if (shape.error) std::rethrow_exception(shape.error);
    scene_.dropped_triangles += shape.dropped;
  }
}

void Builder::resolve_images() {
  for (ImageEntry& entry : images_) {
    const bool is_environment = environment_ && environment_->image && &images_[static_cast<std::size_t>(*environment_->image)] == &entry;
    if (!entry.image || is_environment) continue;
    entry.id = ImageId(scene_.images.size());
    scene_.images.push_back({entry.path.filename().string(), entry.image});
  }
  for (Texture& texture : scene_.textures) {
    auto* const node = std::get_if<ImageTexture>(&texture.node);
    if (node == nullptr) continue;
    ImageEntry& entry = images_[node->image.index];
    if (entry.image && !entry.id.valid()) {  // shared with the environment
      entry.id = ImageId(scene_.images.size());
      scene_.images.push_back({entry.path.filename().string(), entry.image});
    }
    if (entry.id.valid())
      node->image = entry.id;
    else
      texture.node = ConstantTexture{Vec4(0.5f, 0.5f, 0.5f, 1)};  // mid-grey; the image's own warning stands already
  }
}

void Builder::resolve_environment() {
  if (!environment_) return;
  Environment result;
  result.name = "infinite";
  result.scale = environment_->scale;
  const std::shared_ptr<const Image> image = environment_->image ? images_[static_cast<std::size_t>(*environment_->image)].image : nullptr;
  if (environment_->image && !image) warn(environment_->place, "the infinite light has no image; it shines evenly");
  if (!image) {
    if (environment_->illuminance > 0) result.scale *= environment_->illuminance / kPi;
    scene_.environment = result;
    return;
  }
  result.image = image;
  if (const std::optional<double> scale = uniform_scale(environment_->world_from_object)) {
    result.world_from_environment = glm::mat3(Mat3d(environment_->world_from_object) / *scale);
  } else {
    warn(environment_->place, "the infinite light's transformation is no rotation; it is left out");
  }
  result.mapping = EnvironmentMapping::octahedral;
  if (image->width != image->height) {
    warn(environment_->place, "the infinite light's image is not square: it is read as a latitude-longitude map of pbrt-v3");
    result.mapping = EnvironmentMapping::latlong;
    result.world_from_environment = result.world_from_environment * latlong_of_v3();
  } else if (environment_->illuminance > 0) {
    const double own = upper_illuminance(*image);
    if (own > 0) result.scale *= static_cast<float>(environment_->illuminance / own);
  }
  scene_.environment = result;
}

MaterialId Builder::resolve_material(const MaterialKey& key, double area) {
  const auto [found, is_new] = resolved_materials_.try_emplace(key, MaterialId());
  if (!is_new) return found->second;

  Material material;
  material.model = DiffuseMaterial{Color(0.5f)};  // pbrt's default
  material.name = "default";
  if (key.material != kNoSlot) {
    const MaterialEntry& entry = materials_[static_cast<std::size_t>(key.material)];
    if (!entry.defined) {
      std::vector<std::string> known;
      for (const auto& [name, slot] : material_names_) {
        if (materials_[static_cast<std::size_t>(slot)].defined) known.push_back(name);
      }
      const std::string nearest = nearest_name(entry.material.name, known);
      warn_once(entry.place, fmt::format("there is no named material '{}'{}; diffuse 0.5 is used", shown(entry.material.name),
                                         nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest)));
    }
    material = entry.material;
    if (auto* const mix = std::get_if<MixMaterial>(&material.model)) {
      mix->first = resolve_material({entry.mix_first, kNoSlot, key.medium, {}, kNoSlot}, 0);
      mix->second = resolve_material({entry.mix_second, kNoSlot, key.medium, {}, kNoSlot}, 0);
    }
  }
  const auto is_image = [&](TextureId id) { return std::holds_alternative<ImageTexture>(scene_.textures[id.index].node); };
  if (material.normal_map.valid() && !is_image(material.normal_map)) material.normal_map = {};  // its file is missing

  if (key.area_light != kNoSlot) {
    const AreaLight& light = area_lights_[static_cast<std::size_t>(key.area_light)];
    if (std::holds_alternative<InterfaceMaterial>(material.model)) {
      warn_once(light.place, "an area light on an interface does not emit, as in pbrt");
    } else {
      const float sides = light.two_sided ? 2 : 1;
      const float factor = light.power > 0 && area > 0 ? light.power / (kPi * static_cast<float>(area) * sides) : 1;
      material.emission = factor * light.radiance;
      material.emission.texture = light.image;
      material.emission_two_sided = light.two_sided;
    }
  }
  material.alpha.value = key.alpha.value;
  material.alpha.texture = key.alpha.texture;
  if (key.alpha.texture.valid() || key.alpha.value < 1) material.alpha_mode = AlphaMode::blend;
  if (key.alpha.texture.valid() && has_transparency(key.alpha.texture)) material.alpha.channel = 3;
  material.interior = medium_for(key.medium, key.material == kNoSlot ? Place{} : materials_[static_cast<std::size_t>(key.material)].place);

  scene_.materials.push_back(std::move(material));
  const MaterialId id(scene_.materials.size() - 1);
  resolved_materials_[key] = id;
  return id;
}

MaterialId Builder::material_of(std::size_t shape_index) {
  const ShapeEntry& shape = shapes_[shape_index];
  MaterialKey key{shape.material, shape.area_light, shape.medium, shape.alpha, kNoSlot};
  double area = 0;
  if (shape.area_light != kNoSlot && area_lights_[static_cast<std::size_t>(shape.area_light)].power > 0) {
    key.shape = static_cast<Slot>(shape_index);
    if (shape.sphere) {
      area = 4.0 * static_cast<double>(kPi) * static_cast<double>(shape.sphere->radius) * static_cast<double>(shape.sphere->radius);
    } else {
      const AreaStatistics areas = triangle_areas(shape.mesh, shape.is_shared ? shape.world_from_object : Mat4d(1));
      const double mean = areas.total / static_cast<double>(std::max<std::size_t>(1, shape.mesh.triangles.size()));
      area = is_one_shape(shape.name) ? areas.total : mean;
      if (!is_one_shape(shape.name) && areas.largest - areas.smallest > 1e-3 * mean) {
        warn(shape.place, "pbrt gives each triangle of the light the same power; here all get the same radiance, of the same total power");
      }
    }
  }
  return resolve_material(key, area);
}

void Builder::add_shapes() {
  std::vector<std::vector<std::size_t>> shapes_of_object(objects_.size());
  std::map<std::pair<std::string, bool>, MeshId> shared;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    ShapeEntry& shape = shapes_[i];
    if (shape.object != kNoSlot) {
      shapes_of_object[static_cast<std::size_t>(shape.object)].push_back(i);
      continue;
    }
    if (shape.sphere) {
      shape.sphere->material = material_of(i);
      scene_.spheres.push_back(*shape.sphere);
      continue;
    }
    if (shape.mesh.triangles.empty()) continue;
    const MaterialId material = material_of(i);
    Instance instance;
    instance.name = shape.name;
    if (shape.is_shared) {
      const auto [found, is_new] = shared.try_emplace({shape.file.string(), shape.reverse_orientation}, MeshId(scene_.meshes.size()));
      instance.mesh = found->second;
      instance.world_from_object = Mat4(shape.world_from_object);
      if (!is_new) {
        if (scene_.meshes[found->second.index].materials.front() != material) instance.material_override = material;
        scene_.instances.push_back(std::move(instance));
        continue;
      }
    } else {
      instance.mesh = MeshId(scene_.meshes.size());
    }
    shape.mesh.name = shape.name;
    shape.mesh.materials = {material};
    scene_.meshes.push_back(std::move(shape.mesh));
    scene_.instances.push_back(std::move(instance));
  }
  add_objects(shapes_of_object);
}

void Builder::add_objects(const std::vector<std::vector<std::size_t>>& shapes_of_object) {
  std::vector<std::optional<std::vector<MeshId>>> meshes_of_object(objects_.size());
  for (const InstanceEntry& entry : instances_) {
    const auto slot = static_cast<std::size_t>(entry.object);
    if (!meshes_of_object[slot]) {  // objects that nobody places cost nothing
      std::vector<Mesh> parts;
      for (const std::size_t index : shapes_of_object[slot]) {
        if (shapes_[index].mesh.triangles.empty()) continue;
        shapes_[index].mesh.materials = {material_of(index)};
        parts.push_back(std::move(shapes_[index].mesh));
      }
      meshes_of_object[slot].emplace();
      for (Mesh& mesh : merge_meshes(std::move(parts))) {
        mesh.name = objects_[slot].name;
        meshes_of_object[slot]->push_back(MeshId(scene_.meshes.size()));
        scene_.meshes.push_back(std::move(mesh));
      }
    }
    for (const MeshId mesh : *meshes_of_object[slot]) {
      Instance instance;
      instance.name = objects_[slot].name;
      instance.mesh = mesh;
      instance.world_from_object = Mat4(entry.world_from_object);
      scene_.instances.push_back(std::move(instance));
    }
  }
}

Scene Builder::finish() {
  load_files();
  resolve_images();
  resolve_environment();
  add_shapes();
  return std::move(scene_);
}

}  // namespace sightline::pbrt
