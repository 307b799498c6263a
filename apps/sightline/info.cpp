// sightline info
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>

#include "bake/bake_description.h"
#include "base/core/error.h"
#include "commands.h"
#include "film/frame_file.h"
#include "image/io/image_io.h"
#include "methods/method.h"
#include "scene/builtin/builtin.h"
#include "session/material_option.h"

namespace sightline::app {
namespace {

using Json = nlohmann::ordered_json;

Json vec(const Vec3& v) { return {v.x, v.y, v.z}; }

Json camera_json(const Camera& camera) {
  Json json = {{"name", camera.name},
               {"projection", camera.projection == Camera::Projection::perspective ? "perspective" : "orthographic"}};
  const Mat4& m = camera.world_from_camera;
  json["eye"] = vec(Vec3(m[3]));
  json["direction"] = vec(glm::normalize(-Vec3(m[2])));
  json["up"] = vec(glm::normalize(Vec3(m[1])));
  if (camera.projection == Camera::Projection::perspective) {
    json["fov_degrees"] = glm::degrees(camera.fov_rad);
    constexpr std::array<std::string_view, 3> axes = {"vertical", "shorter", "longer"};
    json["fov_axis"] = axes[static_cast<std::size_t>(camera.fov_axis)];
  } else {
    json["height"] = camera.ortho_height;
  }
  if (camera.lens_radius > 0) json["lens_radius"] = camera.lens_radius, json["focal_distance"] = camera.focal_distance;
  return json;
}

Json scene_json(const std::string& spec, const Scene& scene) {
  const Bounds bounds = scene_bounds(scene);
  Json json = {{"file", spec}, {"kind", "scene"}};
  std::uint64_t unique = 0;
  for (const Mesh& mesh : scene.meshes) unique += mesh.triangle_count();
  json["meshes"] = scene.meshes.size();
  json["instances"] = scene.instances.size();
  json["spheres"] = scene.spheres.size();
  json["triangles"] = instanced_triangle_count(scene);
  json["unique_triangles"] = unique;
  json["dropped_triangles"] = scene.dropped_triangles;
  json["bytes"] = scene_bytes(scene);
  if (!bounds.is_empty()) json["bounds"] = {{"lower", vec(bounds.lower)}, {"upper", vec(bounds.upper)}};
  json["materials"] = Json::array();
  for (const Material& material : scene.materials) {
    json["materials"].push_back({{"name", material.name},
                                 {"model", name_of(static_cast<MaterialKind>(material.model.index()))},
                                 {"emissive", !is_black(material.emission.value)}});
    if (const auto* measured = std::get_if<MeasuredMaterial>(&material.model)) json["materials"].back()["file"] = measured->file;
  }
  json["images"] = Json::array();
  for (const ImageAsset& asset : scene.images) {
    Json entry = {{"name", asset.name}};
    if (asset.image) entry["size"] = {asset.image->width, asset.image->height}, entry["channels"] = asset.image->channels;
    json["images"].push_back(entry);
  }
  json["textures"] = scene.textures.size();
  json["lights"] = Json::array();
  for (const Light& light : scene.lights)
    json["lights"].push_back({{"name", light.name}, {"kind", name_of(static_cast<LightKind>(light.shape.index()))}});
  if (scene.environment) json["lights"].push_back({{"name", scene.environment->name}, {"kind", "environment"}});
  json["cameras"] = Json::array();
  for (const Camera& camera : scene.cameras) json["cameras"].push_back(camera_json(camera));
  if (!bounds.is_empty()) json["framing"] = camera_json(framing_camera(scene.framing ? *scene.framing : bounds));
  json["nodes"] = scene.nodes.size();
  json["animation_seconds"] = scene.animation_duration_s;
  json["skins"] = Json::array();
  for (const Skin& skin : scene.skins) json["skins"].push_back({{"name", skin.name}, {"joints", skin.joints.size()}});
  json["deformable_meshes"] = Json::array();
  for (const Mesh& mesh : scene.meshes) {
    if (!mesh.is_deformable()) continue;
    Json entry = {{"name", mesh.name}, {"vertices", mesh.positions.size()}, {"targets", mesh.deformation->targets.size()}};
    if (mesh.skin.valid()) entry["skin"] = scene.skins[mesh.skin.index].name;
    entry["joints_a_vertex"] = mesh.deformation->influences;
    json["deformable_meshes"].push_back(entry);
  }
  if (scene.hints.size_px) json["size"] = {scene.hints.size_px->x, scene.hints.size_px->y};
  if (scene.hints.spp) json["spp"] = *scene.hints.spp;
  if (scene.hints.max_bounces) json["max_bounces"] = *scene.hints.max_bounces;
  json["warnings"] = scene.warnings;
  return json;
}

Json picture_json(const std::string& path) {
  const LayeredImage image = read_layered_image(path);
  Json json = {{"file", path}, {"kind", "picture"}, {"size", {image.width, image.height}}, {"channels", Json::array()}};
  for (const Channel& channel : image.channels) {
    double sum = 0;
    float lower = 0, upper = 0;
    bool first = true;
    std::uint64_t nonfinite = 0;
    for (const float v : channel.values) {
      if (!std::isfinite(v)) {
        ++nonfinite;
        continue;
      }
      sum += v;
      lower = first ? v : std::min(lower, v), upper = first ? v : std::max(upper, v);
      first = false;
    }
    json["channels"].push_back({{"name", channel.name},
                                {"type", channel.half ? "half" : "float"},
                                {"mean", channel.values.empty() ? 0 : sum / static_cast<double>(channel.values.size())},
                                {"minimum", lower},
                                {"maximum", upper},
                                {"nonfinite", nonfinite}});
  }
  json["metadata"] = Json::object();
  for (const auto& [key, value] : image.metadata) {
    const Json parsed = Json::parse(value, nullptr, false);
    json["metadata"][key] = parsed.is_object() ? parsed : Json(value);
  }
  return json;
}

Json frame_json(const std::string& path, std::span<const std::byte> bytes) {
  const StoredFrame stored = decode_frame(bytes, path);
  const Frame& frame = stored.frame;
  return {{"file", path},
          {"kind", "frame"},
          {"size", {frame.width(), frame.height()}},
          {"first_sample", frame.first_sample()},
          {"samples_done", frame.samples_done()},
          {"identity", stored.identity.text}};
}

bool is_bake_file(const std::string& path) {
  std::array<char, 64> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  return is_bake(std::as_bytes(std::span(first)).first(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0))));
}

Json bake_json(const std::string& path) {
  const BakeDescription bake = describe_bake(path);
  Json json = {{"file", path}, {"kind", "bake"}, {"bytes", bake.bytes}};
  if (!bake.id.kind.empty()) {
    json["of"] = bake.id.kind;
    json["version"] = bake.id.version;
    json["key"] = bake.id.key_text();
    json["sections"] = Json::array();
    for (const BakeDescription::Section& section : bake.sections)
      json["sections"].push_back({{"name", section.name}, {"bytes", section.bytes}, {"damaged", section.damaged}});
  }
  json["damage"] = bake.damage.empty() ? Json() : Json(bake.damage);
  return json;
}

Json builtin_json() {
  Json list = Json::array();
  for (const BuiltinScene& scene : builtin_scenes()) {
    Json entry = {{"name", scene.name}, {"help", scene.help}, {"parameters", Json::object()}};
    for (const auto& [name, value] : scene.parameters.to_text()) entry["parameters"][name] = value;
    list.push_back(entry);
  }
  return list;
}

Json material_models_json() {
  Json list = Json::array();
  for (const MaterialChoice& choice : material_choices()) {
    Json entry = {{"name", choice.name}, {"help", choice.help}, {"parameters", Json::object()}};
    for (const auto& [name, value] : choice.parameters.to_text()) entry["parameters"][name] = value;
    list.push_back(entry);
  }
  return list;
}

void print_material_models() {
  for (const MaterialChoice& choice : material_choices()) {
    fmt::print("{}  {}\n", choice.name, choice.help);
    const auto values = choice.parameters.to_text();
    for (std::size_t i = 0; i < values.size(); ++i)
      fmt::print("    {:<24} {}\n", values[i].first + "=" + values[i].second, choice.parameters.schema().settings()[i].info.help);
  }
}

void print_builtins() {
  for (const BuiltinScene& scene : builtin_scenes()) {
    fmt::print("builtin:{}  {}\n", scene.name, scene.help);
    const auto values = scene.parameters.to_text();
    for (std::size_t i = 0; i < values.size(); ++i)
      fmt::print("    {:<24} {}\n", values[i].first + "=" + values[i].second, scene.parameters.schema().settings()[i].info.help);
  }
}

// JSON as indented "key: value" lines, arrays of objects one line an element.
void print_plain(const Json& json, int indent) {
  for (const auto& [key, value] : json.items()) {
    if (value.is_array() && !value.empty() && (value.front().is_object() || value.front().is_string())) {
      fmt::print("{:{}}{}: {}\n", "", indent, key, value.size());
      std::size_t shown = 0;
      for (const Json& element : value) {
        if (++shown > 40) {
          fmt::print("{:{}}... {} more (--json shows all)\n", "", indent + 2, value.size() - 40);
          break;
        }
        fmt::print("{:{}}{}\n", "", indent + 2, element.is_string() ? element.get<std::string>() : element.dump());
      }
    } else if (value.is_object()) {
      fmt::print("{:{}}{}:\n", "", indent, key);
      print_plain(value, indent + 2);
    } else {
      fmt::print("{:{}}{}: {}\n", "", indent, key, value.is_string() ? value.get<std::string>() : value.dump());
    }
  }
}

bool is_scene(const std::string& file) {
  if (file.starts_with("builtin:")) return true;
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  const std::vector<std::string> endings = scene_file_endings();
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

Json describe(const std::string& file, const LoadOptions& options, const std::vector<MaterialRequest>& materials, const Context& context) {
  if (is_scene(file)) {
    Scene scene = load_scene(file, options, context);
    apply_materials(scene, materials);
    return scene_json(file, scene);
  }
  if (is_bake_file(file)) return bake_json(file);
  const std::vector<std::byte> bytes = read_file(file);
  if (bytes.size() >= 7 && std::memcmp(bytes.data(), "SLFRAME", 7) == 0) return frame_json(file, bytes);
  return picture_json(file);
}

}  // namespace

int run_info(const CommandLine& line, Context& context) {
  LoadOptions options;
  options.data_directory = line.common.data_directory;
  // Counting does not need the triangles of a stream.
  options.keep_sources = true;
  const std::vector<MaterialRequest> materials = parse_materials(line.info.materials, options.data_directory);
  Json all = Json::array();
  for (const std::string& file : line.info.files) {
    if (file == "builtin:") {
      if (!line.info.json) print_builtins();
      all.push_back({{"kind", "builtin scenes"}, {"scenes", builtin_json()}});
      continue;
    }
    if (file == "material:") {
      if (!line.info.json) print_material_models();
      all.push_back({{"kind", "material models"}, {"models", material_models_json()}});
      continue;
    }
    const Json json = describe(file, options, materials, context);
    if (!line.info.json) print_plain(json, 0);
    all.push_back(json);
  }
  if (line.info.json) fmt::print("{}\n", (all.size() == 1 ? all.front() : all).dump(2, ' ', false, Json::error_handler_t::replace));
  // What is left of a damaged bake has been shown; it is unreadable all the same.
  for (const Json& json : all) {
    if (json.value("kind", "") == "bake" && !json["damage"].is_null())
      throw input_error(json["damage"].get<std::string>()).at(json["file"].get<std::string>());
  }
  return kDone;
}

}  // namespace sightline::app
