// A Frame on disk: checkpoints and slices for `merge`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "film/frame.h"

namespace sightline {

/// What must agree for two frames to belong to one picture: opaque text (method, settings, scene hash, seed, SIMD target), compared as is.
struct FrameIdentity {
  std::string text;
};

/// Compressed bytes with a version and a checksum. `note` is free JSON carried along (command line, statistics).
std::vector<std::byte> encode_frame(const Frame& frame, const FrameIdentity& identity, const std::string& note);

struct StoredFrame {
  Frame frame;
  FrameIdentity identity;
  std::string note;
};
/// Throws Error{input} on a truncated, damaged or foreign file; sizes are checked before memory is taken.
StoredFrame decode_frame(std::span<const std::byte> bytes, const std::string& name);

}  // namespace sightline
