#include "scene/builtin/rooms.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/core/error.h"
#include "scene/builtin/parts.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/smooth_normals.h"
#include "scene/builtin/subdivide.h"
#include "scene/load/load.h"

namespace sightline::builtin {
namespace {

/// A builtin scene by name, else a file: relative paths are looked up in the data directory, then in the working directory.
Scene load_content(const std::string& spec, const LoadOptions& options, const Context& context) {
  constexpr std::string_view kPrefix = "builtin:";
  if (spec.starts_with(kPrefix)) return build_builtin(std::string_view(spec).substr(kPrefix.size()), options, context);
  const std::string name = spec.substr(0, spec.find_first_of("?,"));
  const auto& table = builtin_scenes();
  if (std::any_of(table.begin(), table.end(), [&](const BuiltinScene& scene) { return scene.name == name; })) {
    return build_builtin(spec, options, context);
  }
  const std::filesystem::path path(spec);
  if (path.is_relative() && !options.data_directory.empty()) {
    std::error_code ignored;
    if (std::filesystem::exists(options.data_directory / path, ignored)) {
      return load_scene((options.data_directory / path).string(), options, context);
    }
  }
  try {
    return load_scene(spec, options, context);
  } catch (Error& error) {
    if (path.is_relative() && options.data_directory.empty())
      error.remedy("relative content is looked up in --data or SIGHTLINE_DATA, then here");
    throw error.during("loading content");
  }
}

/// Largest distance of a vertex from `center` in world space.
float farthest_vertex(const Scene& scene, const Vec3& center) {
  float farthest = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh.index];
    const auto look = [&](std::span<const Vec3> positions) {
      for (const Vec3& p : positions) {
        const float d = length_squared(transform_point(instance.world_from_object, p) - center);
        if (d > farthest) farthest = d;
      }
    };
    if (mesh.source) {
      MeshChunk chunk;
      for (mesh.source->restart(); mesh.source->next(chunk);) look(chunk.positions);
      mesh.source->restart();
    } else {
      look(mesh.positions.span());
    }
  }
  farthest = std::sqrt(farthest);
  for (const Sphere& sphere : scene.spheres) farthest = std::fmax(farthest, glm::length(sphere.center - center) + sphere.radius);
  return farthest;
}

/// Geometry only, as it stands at time 0.
Scene frozen(Scene scene) {
  scene = pose(std::move(scene), 0);
  scene.cameras.clear();
  scene.lights.clear();
  scene.environment.reset();
  scene.hints = {};
  scene.framing.reset();
  scene.nodes.clear();
  scene.skins.clear();
  for (Mesh& mesh : scene.meshes) {
    mesh.deformation.reset();
    mesh.skin = {};
    mesh.weights_node = {};
  }
  scene.animation_duration_s = 0;
  for (Instance& instance : scene.instances) instance.node = {};
  return scene;
}

enum class Normals { file, smooth };

SettingInfo normals_info() {
  return {.help = "of content meshes without normals: none (facets show), or means of the triangles around each vertex",
          .choices = {"file", "smooth"}};
}

Scene load_content(const std::string& spec, Normals normals, const LoadOptions& options, const Context& context) {
  Scene scene = frozen(load_content(spec, options, context));
  if (normals == Normals::smooth) add_smooth_normals(scene, context);
  return scene;
}

struct RoomSettings {
  std::string content = "hairball";
  Normals normals = Normals::file;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("content", &RoomSettings::content, {.help = "scene file (relative to the data directory) or builtin scene to put in the room"});
    visit("normals", &RoomSettings::normals, normals_info());
  }
};

Scene build_room(const RoomSettings& s, const LoadOptions& options, const Context& context) {
  return place_in_room(load_content(s.content, s.normals, options, context), false);
}
Scene build_open_room(const RoomSettings& s, const LoadOptions& options, const Context& context) {
  return place_in_room(load_content(s.content, s.normals, options, context), true);
}

struct GroundSettings {
  std::string content = "hairball";
  Normals normals = Normals::file;
  std::uint64_t min_vertices = 0;
  float spin = 0;
  template <class Visitor>
  static void describe(Visitor&& visit) {
    visit("content", &GroundSettings::content,
          {.help = "scene file (relative to the data directory) or builtin scene to put on the ground"});
    visit("normals", &GroundSettings::normals, normals_info());
    visit("min_vertices", &GroundSettings::min_vertices,
          {.help = "split every triangle in four until the content has this many vertices", .minimum = 0, .maximum = 1e8});
    visit("spin", &GroundSettings::spin,
          {.help = "time in which the content turns once about +Y, 0 = it stands still", .minimum = 0, .maximum = 1e6, .unit = "s"});
  }
};

/// Hangs all instances on a node that turns once about the vertical line through `center`, counter-clockwise seen from above.
void add_spin(Scene& scene, const Vec3& center, float seconds) {
  if (!scene.spheres.empty()) throw usage_error("analytic spheres cannot turn").remedy("leave out spin=, or use content of triangles");
  Node turn;
  turn.name = "spin";
  turn.translation = center;
  for (int quarter = 0; quarter <= 4; ++quarter) {
    const float half_angle_rad = 0.25f * kPi * static_cast<float>(quarter);
    turn.rotation_track.times_s.push_back(0.25f * seconds * static_cast<float>(quarter));
    turn.rotation_track.values.emplace_back(0, std::sin(half_angle_rad), 0, std::cos(half_angle_rad));
  }
  scene.nodes.push_back(std::move(turn));
  for (Instance& instance : scene.instances) {
    Node placed;
    placed.name = instance.name;
    placed.parent = NodeId(0);
    placed.has_matrix = true;
    placed.matrix = instance.world_from_object;
    placed.matrix[3] -= Vec4(center, 0);
    instance.node = NodeId(scene.nodes.size());
    scene.nodes.push_back(std::move(placed));
  }
  scene.animation_duration_s = seconds;
}

Scene build_ground(const GroundSettings& s, const LoadOptions& options, const Context& context) {
  // Normals come first: subdivision interpolates them, while those of the parts of a flat triangle would show it flat again.
  Scene scene = load_content(s.content, s.normals, options, context);
  subdivide(scene, s.min_vertices, context);
  const Bounds bounds = scene_bounds(scene);
  if (bounds.is_empty()) throw input_error("the content has no geometry");
  const Vec3 center = bounds.center();
  const float radius = farthest_vertex(scene, center);
  if (s.spin > 0) add_spin(scene, center, s.spin);
  add_mesh(scene, ground_mesh({center.x, bounds.lower.y, center.z}, 4 * radius, 200), add_diffuse(scene, "ground", Color(0.5f)));
  scene.framing = bounds;
  scene.cameras.push_back(framing_camera(bounds));
  scene.hints.size_px = IVec2(800, 600);
  return scene;
}

}  // namespace

Scene place_in_room(Scene content, bool open) {
  Scene scene = frozen(std::move(content));
  const Bounds bounds = scene_bounds(scene);
  if (bounds.is_empty()) throw input_error("the content has no geometry");
  const Vec3 center = bounds.center();
  const float radius = farthest_vertex(scene, center);
  const float scale = radius > 0 ? 1 / radius : 1;

  // Content: one material for all, scaled, moved onto the floor.
  const Mat4 place(Vec4(scale, 0, 0, 0), Vec4(0, scale, 0, 0), Vec4(0, 0, scale, 0),
                   Vec4(-scale * center.x, -scale * bounds.lower.y, -scale * center.z, 1));
  scene.materials.clear();
  scene.textures.clear();
  scene.images.clear();
  scene.media.clear();
  const MaterialId grey = add_diffuse(scene, "grey", Color(0.7f));
  for (Mesh& mesh : scene.meshes) {
    mesh.materials = {grey};
    mesh.triangle_materials = {};
  }
  for (Instance& instance : scene.instances) {
    instance.world_from_object = place * instance.world_from_object;
    instance.material_override = grey;  // chunks of a source may name materials of their own
  }
  for (Sphere& sphere : scene.spheres) {
    sphere.center = transform_point(place, sphere.center);
    sphere.radius *= scale;
    sphere.reverse_orientation = false;
    sphere.material = grey;
  }

  // The room: x, z in [-2.5, 2.5], y in [0, 4], seen from inside.
  const Vec3 x(5, 0, 0), y(0, 4, 0), z(0, 0, 5);
  MeshBuilder walls;
  walls.quad({-2.5f, 0, -2.5f}, z, x);  // floor
  walls.quad({-2.5f, 0, -2.5f}, x, y);  // back
  walls.quad({-2.5f, 0, -2.5f}, y, z);  // left
  walls.quad({2.5f, 0, -2.5f}, z, y);   // right
  if (!open) {
    walls.quad({-2.5f, 4, -2.5f}, x, z);  // ceiling
    walls.quad({-2.5f, 0, 2.5f}, y, x);   // front
  }
  add_mesh(scene, walls.build("room"), grey);
  if (!open) {
    const MaterialId light = add_emitter(scene, "light", Color(40));
    add_mesh(scene, MeshBuilder().quad({-0.5f, 3.99f, -0.5f}, {1, 0, 0}, {0, 0, 1}).build("light"), light);
  }
  add_camera(scene, {1.6f, 1.5f, 2.2f}, {0, 0.8f, 0}, 50);
  scene.hints.size_px = IVec2(1280, 960);
  return scene;
}

BuiltinScene room_scene() { return declare<RoomSettings, build_room>("room", "content in a closed room below a square light"); }
BuiltinScene open_room_scene() {
  return declare<RoomSettings, build_open_room>("open-room",
                                                "content in a room without ceiling, front wall and light: give it an environment");
}
BuiltinScene ground_scene() {
  return declare<GroundSettings, build_ground>("ground", "content on a ground, framed: give it an environment");
}

}  // namespace sightline::builtin
