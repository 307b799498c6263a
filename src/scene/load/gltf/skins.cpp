#include "scene/load/gltf/skins.h"

#include <algorithm>
#include <cmath>

#include "base/core/error.h"
#include "scene/load/gltf/accessor.h"

namespace sightline::gltf {
namespace {

/// Displacements by one attribute of a morph target; empty if it has none.
SharedArray<Vec3> read_displacements(Import& import, const JsonView& target, std::string_view attribute, std::size_t vertex_count) {
  const std::optional<JsonView> reference = target.find(attribute);
  if (!reference) return {};
  const std::vector<float> values = read_floats(import.document, import.document.resolve("accessors", *reference), 3);
  if (values.size() != 3 * vertex_count) {
    throw input_error(fmt::format("the target has {} elements for {} vertices", values.size() / 3, vertex_count)).at(reference->path());
  }
  import.document.charge(values.size() * sizeof(float), reference->path());
  return SharedArray<Vec3>::make(vertex_count, [&](std::span<Vec3> array) {
    for (std::size_t i = 0; i < vertex_count; ++i) {
      const Vec3 d(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
      array[i] = is_finite(d) ? d : Vec3(0);
    }
  });
}

void read_targets(Import& import, const JsonView& primitive, std::size_t vertex_count, Deformation& deformation) {
  const std::optional<JsonView> targets = primitive.find("targets");
  if (!targets) return;
  for (std::size_t k = 0; k < targets->size(); ++k) {
    const JsonView target = targets->at(k);
    import.document.charge(sizeof(MorphTarget) + target.path().size(), target.path());
    MorphTarget& morph = deformation.targets.emplace_back();
    morph.name = target.path();
    morph.positions = read_displacements(import, target, "POSITION", vertex_count);
    morph.normals = read_displacements(import, target, "NORMAL", vertex_count);
    morph.tangents = read_displacements(import, target, "TANGENT", vertex_count);
  }
}

/// Makes the weights of one vertex add up to 1. Without any, the first joint carries it.
void normalize_weights(std::span<float> weights) {
  double sum = 0;
  for (float& weight : weights) {
    if (!(weight > 0) || !std::isfinite(weight)) weight = 0;
    sum += static_cast<double>(weight);
  }
  if (!(sum > 0)) {
    weights[0] = 1;
    return;
  }
  for (float& weight : weights) weight = static_cast<float>(static_cast<double>(weight) / sum);
}

void read_joints(Import& import, const JsonView& attributes, std::size_t vertex_count, PrimitiveDeformation& result) {
  // JOINTS_0 with WEIGHTS_0, JOINTS_1 with WEIGHTS_1, ...: four joints each.
  struct Set {
    std::vector<std::uint32_t> joints;
    std::vector<float> weights;
  };
  std::vector<Set> sets;
  while (true) {
    const std::optional<JsonView> joints = attributes.find(fmt::format("JOINTS_{}", sets.size()));
    const std::optional<JsonView> weights = attributes.find(fmt::format("WEIGHTS_{}", sets.size()));
    if (!joints || !weights) break;
    const auto check = [&](std::size_t count, const JsonView& attribute) {
      if (count == 4 * vertex_count) return;
      throw input_error(fmt::format("the attribute has {} elements for {} vertices", count / 4, vertex_count)).at(attribute.path());
    };
    Set set;
    set.joints = read_unsigned(import.document, import.document.resolve("accessors", *joints), 4);
    check(set.joints.size(), *joints);
    set.weights = read_floats(import.document, import.document.resolve("accessors", *weights), 4);
    check(set.weights.size(), *weights);
    sets.push_back(std::move(set));
  }
  if (sets.empty() || vertex_count == 0) return;

  const std::size_t influences = 4 * sets.size();
  import.document.charge(vertex_count * influences * (sizeof(float) + sizeof(std::uint16_t)), attributes.path());
  result.deformation.influences = influences;
  result.deformation.joint_weights = SharedArray<float>::make(vertex_count * influences, [&](std::span<float> target) {
    for (std::size_t i = 0; i < vertex_count; ++i) {
      for (std::size_t k = 0; k < influences; ++k) target[i * influences + k] = sets[k / 4].weights[4 * i + k % 4];
      normalize_weights(target.subspan(i * influences, influences));
    }
  });
  result.deformation.joints = SharedArray<std::uint16_t>::make(vertex_count * influences, [&](std::span<std::uint16_t> target) {
    for (std::size_t k = 0; k < target.size(); ++k) {
      // Files put anything where the weight is 0.
      const std::size_t i = k / influences, slot = k % influences;
      const std::uint32_t joint = result.deformation.joint_weights[k] > 0 ? sets[slot / 4].joints[4 * i + slot % 4] : 0;
      result.largest_joint = std::max(result.largest_joint, joint);
      target[k] = static_cast<std::uint16_t>(std::min(joint, 0xffffu));
    }
  });
}

template <class T>
SharedArray<T> gather(const SharedArray<T>& source, std::span<const std::uint32_t> kept, std::size_t stride) {
  if (source.empty()) return {};
  return SharedArray<T>::make(kept.size() * stride, [&](std::span<T> target) {
    for (std::size_t i = 0; i < target.size(); ++i) target[i] = source[kept[i / stride] * stride + i % stride];
  });
}

}  // namespace

std::size_t morph_target_count(const JsonView& mesh) {
  const JsonView primitives = mesh.require("primitives");
  if (primitives.size() == 0) return 0;
  const std::optional<JsonView> targets = primitives.at(0).find("targets");
  return targets ? targets->size() : 0;
}

std::vector<float> default_weights(Import& import, const JsonView& node) {
  const std::optional<JsonView> reference = node.find("mesh");
  if (!reference) return {};
  const JsonView mesh = import.document.element("meshes", import.document.resolve("meshes", *reference));
  const std::size_t count = morph_target_count(mesh);
  if (count == 0) return {};
  import.document.charge(count * sizeof(float), node.path());
  std::vector<float> weights(count, 0.f);
  std::optional<JsonView> given = node.find("weights");
  if (!given) given = mesh.find("weights");
  if (!given) return weights;
  if (given->size() != count) throw input_error(fmt::format("{} weights for {} morph targets", given->size(), count)).at(given->path());
  given->read_vector(weights);
  return weights;
}

PrimitiveDeformation read_deformation(Import& import, const JsonView& primitive, std::size_t vertex_count) {
  PrimitiveDeformation result;
  read_targets(import, primitive, vertex_count, result.deformation);
  read_joints(import, primitive.require("attributes"), vertex_count, result);
  return result;
}

void keep_vertices(Deformation& deformation, std::span<const std::uint32_t> kept) {
  for (MorphTarget& target : deformation.targets) {
    target.positions = gather(target.positions, kept, 1);
    target.normals = gather(target.normals, kept, 1);
    target.tangents = gather(target.tangents, kept, 1);
  }
  deformation.joints = gather(deformation.joints, kept, deformation.influences);
  deformation.joint_weights = gather(deformation.joint_weights, kept, deformation.influences);
}

std::optional<SkinId> SkinImporter::skin(const JsonView& reference) {
  const std::size_t index = import_.document.resolve("skins", reference);
  const auto [found, is_new] = skins_.try_emplace(index);
  if (is_new) found->second = read(import_.document.element("skins", index));
  return found->second;
}

std::optional<SkinId> SkinImporter::read(const JsonView& json) {
  Skin skin;
  skin.name = json.name();
  const JsonView joints = json.require("joints");
  if (joints.size() == 0) throw input_error("a skin needs at least one joint").at(joints.path());
  import_.document.charge(joints.size() * (sizeof(NodeId) + sizeof(Mat4)), json.path());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto found = nodes_.find(import_.document.resolve("nodes", joints.at(j)));
    if (found == nodes_.end()) {
      ++jointless_;
      return std::nullopt;
    }
    skin.joints.push_back(found->second);
  }
  skin.joint_from_rest.assign(skin.joints.size(), Mat4(1));
  if (const std::optional<JsonView> reference = json.find("inverseBindMatrices")) {
    const std::vector<float> values = read_floats(import_.document, import_.document.resolve("accessors", *reference), 16);
    if (values.size() < 16 * skin.joints.size()) {
      throw input_error(fmt::format("{} inverse bind matrices for {} joints", values.size() / 16, skin.joints.size()))
          .at(reference->path());
    }
    for (std::size_t k = 0; k < 16 * skin.joints.size(); ++k) {
      if (!std::isfinite(values[k])) throw input_error("an inverse bind matrix is not finite").at(reference->path());
      skin.joint_from_rest[k / 16][static_cast<int>(k % 16 / 4)][static_cast<int>(k % 4)] = values[k];
    }
  }
  import_.scene.skins.push_back(std::move(skin));
  return SkinId(import_.scene.skins.size() - 1);
}

void SkinImporter::warn_of_losses() const {
  if (jointless_ > 0) import_.warn(fmt::format("{} skins have joints outside the scene and are ignored", jointless_));
}

}  // namespace sightline::gltf
