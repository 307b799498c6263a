#include "scene/load/gltf/nodes.h"

#include <algorithm>
#include <optional>

#include "base/core/error.h"
#include "scene/load/gltf/accessor.h"
#include "scene/load/gltf/cameras_lights.h"
#include "scene/load/gltf/skins.h"

namespace sightline::gltf {
namespace {

/// The glTF nodes that the shown scene starts from.
std::vector<std::size_t> root_nodes(Import& import) {
  Document& document = import.document;
  std::vector<std::size_t> roots;
  if (document.count("scenes") > 0) {
    const std::optional<JsonView> shown = document.root().find("scene");
    const JsonView scene = document.element("scenes", shown ? document.resolve("scenes", *shown) : 0);
    if (scene.find("name")) import.scene.name = scene.name();
    if (const std::optional<JsonView> nodes = scene.find("nodes")) {
      for (std::size_t i = 0; i < nodes->size(); ++i) roots.push_back(document.resolve("nodes", nodes->at(i)));
    }
    return roots;
  }
  // A file without scenes is a library: all that is nobody's child is shown.
  std::vector<bool> is_child(document.count("nodes"), false);
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    const std::optional<JsonView> children = document.element("nodes", i).find("children");
    for (std::size_t k = 0; children && k < children->size(); ++k) is_child[document.resolve("nodes", children->at(k))] = true;
  }
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(i);
  }
  if (roots.empty() && !is_child.empty()) throw input_error("every node is the child of another: they form a cycle").at("/nodes");
  if (!is_child.empty()) import.warn("the file has no scene; all its nodes are shown");
  return roots;
}

Node read_node(Import& import, const JsonView& json, NodeId parent) {
  Node node;
  node.name = json.name();
  node.parent = parent;
  if (const std::optional<JsonView> matrix = json.find("matrix")) {
    matrix->read_vector({&node.matrix[0].x, 16});
    node.has_matrix = true;
  }
  node.weights = default_weights(import, json);
  json.vector_or("translation", {&node.translation.x, 3});
  json.vector_or("scale", {&node.scale.x, 3});
  Vec4 xyzw{0, 0, 0, 1};
  json.vector_or("rotation", {&xyzw.x, 4});
  node.rotation = glm::quat(xyzw.w, xyzw.x, xyzw.y, xyzw.z);
  return node;
}

/// The placements of EXT_mesh_gpu_instancing, relative to the node that has the extension.
std::vector<Node> read_instance_nodes(Import& import, const JsonView& extension, NodeId parent) {
  const JsonView attributes = extension.require("attributes");
  std::optional<std::size_t> count;
  const auto read = [&](std::string_view key, int components) -> std::vector<float> {
    const std::optional<JsonView> attribute = attributes.find(key);
    if (!attribute) return {};
    std::vector<float> values = read_floats(import.document, import.document.resolve("accessors", *attribute), components);
    const std::size_t elements = values.size() / static_cast<std::size_t>(components);
    if (count && *count != elements) {
      throw input_error(fmt::format("{} instances here, {} in another attribute", elements, *count)).at(attribute->path());
    }
    count = elements;
    return values;
  };
  const std::vector<float> translations = read("TRANSLATION", 3), rotations = read("ROTATION", 4), scales = read("SCALE", 3);
  std::vector<Node> nodes(count.value_or(0));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i].parent = parent;
    if (!translations.empty()) nodes[i].translation = {translations[3 * i], translations[3 * i + 1], translations[3 * i + 2]};
    if (!scales.empty()) nodes[i].scale = {scales[3 * i], scales[3 * i + 1], scales[3 * i + 2]};
    if (!rotations.empty())
      nodes[i].rotation = glm::quat(rotations[4 * i + 3], rotations[4 * i], rotations[4 * i + 1], rotations[4 * i + 2]);
  }
  return nodes;
}

bool is_finite_matrix(const Mat4& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(m[column][row])) return false;
    }
  }
  return true;
}

/// Removes what a matrix makes vanish (scale 0 on some axis) or overflow; what moves may grow from nothing.
void drop_unusable_instances(Import& import) {
  const std::vector<bool> moves = moving_nodes(import.scene);
  const std::size_t dropped = std::erase_if(import.scene.instances, [&](const Instance& instance) {
    if (!is_finite_matrix(instance.world_from_object)) return true;
    if (instance.node.valid() && moves[instance.node.index]) return false;
    return glm::determinant(glm::dmat3(instance.world_from_object)) == 0;
  });
  if (dropped > 0) import.warn(fmt::format("{} placements with a singular or infinite transformation are left out", dropped));
}

/// Meshes that bend but never otherwise than at t = 0 are as good as any other.
void settle_still_meshes(Scene& scene) {
  const std::vector<bool> moves = moving_nodes(scene);
  for (Mesh& mesh : scene.meshes) {
    if (!mesh.is_deformable()) continue;
    const bool morphs = !scene.nodes[mesh.weights_node.index].weights_track.times_s.empty();
    const std::vector<NodeId> none;
    const std::vector<NodeId>& joints = mesh.skin.valid() ? scene.skins[mesh.skin.index].joints : none;
    if (morphs || std::any_of(joints.begin(), joints.end(), [&](NodeId joint) { return moves[joint.index]; })) continue;
    mesh.deformation.reset();
    mesh.skin = {};
    mesh.weights_node = {};
  }
}

}  // namespace

NodeMap import_nodes(Import& import) {
  struct Visit {
    std::size_t node;
    NodeId parent;
    std::string reference;  ///< path of the number that led here
  };
  // Depth first with a stack of our own: hierarchies of hostile files are deeper than the call stack.
  std::vector<Visit> open;
  for (const std::size_t root : root_nodes(import)) open.push_back({root, NodeId(), "/scenes"});
  std::reverse(open.begin(), open.end());
  NodeMap ids;
  while (!open.empty()) {
    const Visit visit = std::move(open.back());
    open.pop_back();
    const NodeId id(import.scene.nodes.size());
    if (!ids.emplace(visit.node, id).second) {
      throw input_error(fmt::format("node {} is reached twice: the nodes must form trees", visit.node)).at(visit.reference);
    }
    const JsonView json = import.document.element("nodes", visit.node);
    import.scene.nodes.push_back(read_node(import, json, visit.parent));
    if (const std::optional<JsonView> children = json.find("children")) {
      for (std::size_t i = children->size(); i-- > 0;) {
        const JsonView child = children->at(i);
        open.push_back({import.document.resolve("nodes", child), id, child.path()});
      }
    }
  }
  return ids;
}

void attach_to_nodes(Import& import, const NodeMap& nodes, MeshImporter& meshes) {
  Scene& scene = import.scene;
  const std::vector<bool> moves = moving_nodes(scene);
  const std::vector<Mat4> world = node_matrices(scene, 0);
  SkinImporter skins(import, nodes);
  std::vector<std::pair<std::size_t, NodeId>> in_order(nodes.begin(), nodes.end());
  std::sort(in_order.begin(), in_order.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  for (const auto& entry : in_order) {
    const std::size_t gltf_node = entry.first;
    const NodeId id = entry.second;
    const JsonView json = import.document.element("nodes", gltf_node);
    if (const std::optional<JsonView> camera = json.find("camera")) add_camera(import, *camera, id);
    if (const std::optional<JsonView> light = json.extension("KHR_lights_punctual")) add_light(import, *light, id);
    const std::optional<JsonView> reference = json.find("mesh");
    if (!reference) continue;

    const std::optional<JsonView> skin_reference = json.find("skin");
    const std::optional<SkinId> skin = skin_reference ? skins.skin(*skin_reference) : std::nullopt;
    std::vector<PlacedPart> parts = meshes.place(*reference, id, skin);
    // What hangs on joints is where these are: the node itself, and placements relative to it, do not count [glTF2, §3.7.3.3].
    for (const PlacedPart& part : parts) {
      if (part.skinned) scene.instances.push_back({.name = scene.nodes[id.index].name, .mesh = part.mesh});
    }
    std::erase_if(parts, [](const PlacedPart& part) { return part.skinned; });
    const auto add_instances = [&](NodeId node, const Mat4& world_from_object) {
      import.document.charge(parts.size() * sizeof(Instance), json.path());
      for (const PlacedPart& part : parts) {
        scene.instances.push_back(
            {.name = scene.nodes[id.index].name, .mesh = part.mesh, .world_from_object = world_from_object, .node = node});
      }
    };
    const std::optional<JsonView> instancing = json.extension("EXT_mesh_gpu_instancing");
    if (!instancing) {
      add_instances(id, Mat4(1));
      continue;
    }
    // Where nothing moves, a placement needs no node of its own: there may be millions.
    for (Node& placement : read_instance_nodes(import, *instancing, id)) {
      if (moves[id.index]) {
        import.document.charge(sizeof(Node), json.path());
        add_instances(NodeId(scene.nodes.size()), Mat4(1));
        scene.nodes.push_back(std::move(placement));
      } else {
        add_instances({}, world[id.index] * node_matrix(placement, 0));
      }
    }
  }
  skins.warn_of_losses();

  // Everything stands where it is at t = 0; lights stay in their node's space until the scene is posed.
  Scene posed = pose(scene, 0);
  scene.instances = std::move(posed.instances);
  scene.cameras = std::move(posed.cameras);
  scene.meshes = std::move(posed.meshes);
  settle_still_meshes(scene);
  drop_unusable_instances(import);
}

}  // namespace sightline::gltf
