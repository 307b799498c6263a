// Reads glTF 2.0 and GLB. nlohmann-json gives the tree; every index, offset, count and size in it is checked here before use.
#include <new>

#include "base/core/error.h"
#include "image/io/image_io.h"
#include "scene/load/gltf/animation.h"
#include "scene/load/gltf/document.h"
#include "scene/load/gltf/extensions.h"
#include "scene/load/gltf/import.h"
#include "scene/load/gltf/materials.h"
#include "scene/load/gltf/meshes.h"
#include "scene/load/gltf/nodes.h"
#include "scene/load/gltf/textures.h"
#include "scene/load/load.h"

namespace sightline {
namespace {

Scene read_gltf(std::span<const std::byte> file, const std::string& name, const std::filesystem::path* folder, const Context& context) {
  using namespace gltf;
  try {
    Scene scene;
    Document document(file, folder, context);
    Import import{.document = document, .scene = scene, .context = context, .name = name};
    check_extensions(import);
    TextureImporter textures(import);
    const std::vector<std::uint64_t> uv_sets = import_materials(import, textures);
    MeshImporter meshes(import, uv_sets);
    const NodeMap nodes = import_nodes(import);
    import_animations(import, nodes);
    attach_to_nodes(import, nodes, meshes);
    meshes.warn_of_losses();
    textures.decode_images();
    if (scene.instances.empty()) import.warn("nothing to see: no node of the scene has triangles");
    return scene;
  } catch (Error& error) {
    throw error.at(name);
  } catch (const std::bad_alloc&) {
    throw resource_error("not enough memory to read the scene").at(name);
  }
}

}  // namespace

Scene load_gltf(const std::filesystem::path& path, const LoadOptions&, const Context& context) {
  const std::vector<std::byte> file = read_file(path);
  const std::filesystem::path folder = path.parent_path();
  return read_gltf(file, path.string(), &folder, context);
}

Scene parse_gltf(std::span<const std::byte> bytes, const std::string& name, const Context& context) {
  return read_gltf(bytes, name, nullptr, context);
}

}  // namespace sightline
