// Reads scenes: one entry for every format, and builtin: scenes.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/core/context.h"
#include "scene/scene.h"

namespace sightline {

struct LoadOptions {
  std::filesystem::path data_directory;  ///< where `content=` of builtin scenes and relative bench paths are looked up (--data)
  bool keep_sources = false;             ///< leave MeshSources unmaterialised (massive backends)
};

/// Reads one scene from a file (by its ending) or "builtin:NAME[?k=v&k=v | ,k=v,...]". Throws Error{input} with file and place.
Scene load_scene(const std::string& spec, const LoadOptions& options, const Context& context);
/// Several files are merged: geometry, materials and lights appended, the first camera and environment win.
Scene load_scenes(std::span<const std::string> specs, const LoadOptions& options, const Context& context);
/// Appends `other` to `scene`, shifting its ids.
void merge_into(Scene& scene, Scene other);

/// Endings (".gltf") that load_scene understands.
std::vector<std::string> scene_file_endings();

// One function a format, each in its own folder. All check sizes before they allocate.
Scene load_gltf(const std::filesystem::path& path, const LoadOptions& options, const Context& context);
Scene load_pbrt(const std::filesystem::path& path, const LoadOptions& options, const Context& context);
Scene load_obj(const std::filesystem::path& path, const LoadOptions& options, const Context& context);
Scene load_ply(const std::filesystem::path& path, const LoadOptions& options, const Context& context);
/// The same from memory, for tests and fuzz targets: no other file is read; `name` is for messages.
Scene parse_gltf(std::span<const std::byte> bytes, const std::string& name, const Context& context);
Scene parse_pbrt(std::string_view text, const std::string& name, const Context& context);
Scene parse_obj(std::string_view text, const std::string& name, const Context& context);
Scene parse_ply(std::span<const std::byte> bytes, const std::string& name, const Context& context);

/// One mesh of a PLY file, used by load_ply and by pbrt's plymesh.
Mesh read_ply_mesh(const std::filesystem::path& path, const Context& context, std::uint64_t* dropped_triangles);

/// Reads a texture or environment image by its ending, trying the same stem with another known ending (with a warning) if `path` is
/// missing; nullptr and a warning if nothing is found or it cannot be read.
std::shared_ptr<const Image> load_texture_image(const std::filesystem::path& path, Scene& scene, const Context& context);

/// Removes triangles with out-of-range or repeated indices, non-finite vertices or no area; adds to `dropped`.
void drop_bad_triangles(std::span<const Vec3> positions, std::vector<UVec3>& triangles, std::vector<std::uint16_t>* triangle_materials,
                        std::uint64_t& dropped);
/// The same, and gives vertices that are not finite (which no triangle uses any more) the place of one that is.
void drop_bad_triangles(std::vector<Vec3>& positions, std::vector<UVec3>& triangles, std::vector<std::uint16_t>* triangle_materials,
                        std::uint64_t& dropped);

}  // namespace sightline
