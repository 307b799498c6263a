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

/// Key times and values of a sampler, `width` numbers a value.
struct Keys {
  Interpolation interpolation;
  std::vector<float> times_s, values;
};

std::vector<float> read_times(Import& import, const JsonView& input) {
  std::vector<float> times_s = read_floats(import.document, import.document.resolve("accessors", input), 1);
  if (times_s.empty()) throw input_error("an animation needs at least one key").at(input.path());
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (!std::isfinite(times_s[i]) || (i > 0 && times_s[i] < times_s[i - 1])) {
      throw input_error(fmt::format("key {} has time {}: times must be finite and increase", i, times_s[i])).at(input.path());
    }
  }
  return times_s;
}

/// `components` of the accessor; a value takes `width` numbers, which is more for the weights of several targets.
Keys read_keys(Import& import, const JsonView& sampler, int components, std::size_t width) {
  Keys keys;
  keys.interpolation = interpolation_of(sampler);
  const JsonView input = sampler.require("input"), output = sampler.require("output");
  keys.times_s = read_times(import, input);
  keys.values = read_floats(import.document, import.document.resolve("accessors", output), components);
  const std::size_t per_key = keys.interpolation == Interpolation::cubic_spline ? 3 : 1;
  if (keys.values.size() != per_key * width * keys.times_s.size()) {
    throw input_error(
        fmt::format("{} numbers for {} keys of {} values with {} numbers", keys.values.size(), keys.times_s.size(), per_key, width))
        .at(output.path());
  }
  for (const float value : keys.values) {
    if (!std::isfinite(value)) throw input_error("a value is not finite").at(output.path());
  }
  return keys;
}

Track read_track(Import& import, const JsonView& sampler, int components) {
  const auto width = static_cast<std::size_t>(components);
  Keys keys = read_keys(import, sampler, components, width);
  Track track;
  track.interpolation = keys.interpolation;
  track.times_s = std::move(keys.times_s);
  track.values.resize(keys.values.size() / width, Vec4(0));
  for (std::size_t i = 0; i < keys.values.size(); ++i) track.values[i / width][static_cast<int>(i % width)] = keys.values[i];
  return track;
}

WeightsTrack read_weights_track(Import& import, const JsonView& sampler, std::size_t target_count) {
  Keys keys = read_keys(import, sampler, 1, target_count);
  return {.interpolation = keys.interpolation, .times_s = std::move(keys.times_s), .values = std::move(keys.values)};
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
      const bool morphs = path == "weights" && !node.weights.empty();
      const Target target = target_of(node, path);
      if (!morphs && (target.track == nullptr || node.has_matrix)) {
        ++ignored;
        continue;
      }
      std::vector<float>& times_s = morphs ? node.weights_track.times_s : target.track->times_s;
      if (!times_s.empty()) {
        ++doubled;
        continue;
      }
      const JsonView sampler_reference = channel.require("sampler");
      const std::uint64_t sampler_index = sampler_reference.as_unsigned();
      if (sampler_index >= samplers.size()) {
        throw input_error(fmt::format("there is no sampler {}, only {}", sampler_index, samplers.size())).at(sampler_reference.path());
      }
      const JsonView sampler = samplers.at(static_cast<std::size_t>(sampler_index));
      if (morphs) {
        node.weights_track = read_weights_track(import, sampler, node.weights.size());
      } else {
        *target.track = read_track(import, sampler, target.components);
      }
      import.scene.animation_duration_s = std::max(import.scene.animation_duration_s, times_s.back());
    }
  }
  if (ignored > 0) import.warn(fmt::format("{} animation channels without anything to move are ignored", ignored));
  if (animation_count > 1) {
    import.warn(fmt::format("{} animations are played together{}", animation_count,
                            doubled > 0 ? fmt::format("; {} channels that move what an earlier one moves are ignored", doubled) : ""));
  }
}

}  // namespace sightline::gltf
