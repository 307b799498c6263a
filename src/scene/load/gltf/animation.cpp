#include "scene/load/gltf/animation.h"

#include <algorithm>

#include "base/core/error.h"
#include "scene/load/gltf/accessor.h"

namespace sightline::gltf {
namespace {

Interpolation interpolation_of(const JsonView& sampler) {
  const std::optional<JsonView> member = sampler.find("interpolation");
  const std::string name = member ? member->as_string() : "LINEAR";
  if (name == "LINEAR") return Interpolation::linear;
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  throw input_error(fmt::format("'{}' is no interpolation", name)).at(member->path());
}

Track read_track(Import& import, const JsonView& sampler, int components) {
  Document& document = import.document;
  Track track;
  track.interpolation = interpolation_of(sampler);
  const JsonView input = sampler.require("input"), output = sampler.require("output");
  track.times_s = read_floats(document, document.resolve("accessors", input), 1);
  if (track.times_s.empty()) throw input_error("an animation needs at least one key").at(input.path());
  for (std::size_t i = 0; i < track.times_s.size(); ++i) {
    if (!std::isfinite(track.times_s[i]) || (i > 0 && track.times_s[i] < track.times_s[i - 1])) {
      throw input_error(fmt::format("key {} has time {}: times must be finite and increase", i, track.times_s[i])).at(input.path());
    }
  }

  const std::vector<float> values = read_floats(document, document.resolve("accessors", output), components);
  const std::size_t per_key = track.interpolation == Interpolation::cubic_spline ? 3 : 1;
  const auto width = static_cast<std::size_t>(components);
  if (values.size() != per_key * width * track.times_s.size()) {
    throw input_error(fmt::format("{} values for {} keys, {} a key are needed", values.size() / width, track.times_s.size(), per_key))
        .at(output.path());
  }
  track.values.resize(values.size() / width, Vec4(0));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) throw input_error("a value is not finite").at(output.path());
    track.values[i / width][static_cast<int>(i % width)] = values[i];
  }
  return track;
}

/// The track of a node that a channel's path names, and how many numbers a value has; null for what is not rigid.
struct Target {
  Track* track = nullptr;
  int components = 0;
};

Target target_of(Node& node, const std::string& path) {
  if (path == "translation") return {&node.translation_track, 3};
  if (path == "rotation") return {&node.rotation_track, 4};
  if (path == "scale") return {&node.scale_track, 3};
  return {};
}

}  // namespace

void import_animations(Import& import, const NodeMap& nodes) {
  Document& document = import.document;
  std::size_t ignored = 0, doubled = 0;
  const std::size_t animation_count = document.count("animations");
  for (std::size_t a = 0; a < animation_count; ++a) {
    const JsonView animation = document.element("animations", a);
    const JsonView channels = animation.require("channels"), samplers = animation.require("samplers");
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const JsonView channel = channels.at(i);
      const JsonView destination = channel.require("target");
      const std::string path = destination.require("path").as_string();
      const std::optional<JsonView> reference = destination.find("node");
      if (!reference) {
        ++ignored;
        continue;
      }
      const auto found = nodes.find(document.resolve("nodes", *reference));
      if (found == nodes.end()) continue;
      Node& node = import.scene.nodes[found->second.index];
      const Target target = target_of(node, path);
      if (target.track == nullptr || node.has_matrix) {
        ++ignored;
        continue;
      }
      if (!target.track->times_s.empty()) {
        ++doubled;
        continue;
      }
      const JsonView sampler_reference = channel.require("sampler");
      const std::uint64_t sampler = sampler_reference.as_unsigned();
      if (sampler >= samplers.size()) {
        throw input_error(fmt::format("there is no sampler {}, only {}", sampler, samplers.size())).at(sampler_reference.path());
      }
      *target.track = read_track(import, samplers.at(static_cast<std::size_t>(sampler)), target.components);
      import.scene.animation_duration_s = std::max(import.scene.animation_duration_s, target.track->times_s.back());
    }
  }
  if (ignored > 0) import.warn(fmt::format("{} animation channels that do not move a node rigidly are ignored", ignored));
  if (animation_count > 1) {
    import.warn(fmt::format("{} animations are played together{}", animation_count,
                            doubled > 0 ? fmt::format("; {} channels that move what an earlier one moves are ignored", doubled) : ""));
  }
}

}  // namespace sightline::gltf
