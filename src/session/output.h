// Writing finished frames in the format that a file's ending names.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "film/frame.h"
#include "film/frame_file.h"
#include "film/view.h"
#include "image/tone_map.h"

namespace sightline {

struct OutputOptions {
  ToneMap tone_map = ToneMap::srgb;
  float exposure_ev = 0;
  std::vector<std::pair<std::string, std::string>> metadata;  ///< EXR header
  FrameIdentity identity;                                     ///< of a slice
  std::string note;                                           ///< carried by a slice: statistics
};

/// Checks path and ending before any work is done: Error{usage} for an unknown ending, Error{resource} where nothing can be written.
/// "exr:-" (also hdr, pfm, png, jpg, slice) is standard output.
void check_output(const std::string& output);
/// Writes .exr (all layers and metadata), .hdr, .pfm, .png, .jpg, or .slice (exact sums, for merge). Alpha, if the frame has that layer, is
/// channel A of EXR (colour is premultiplied) and of PNG (colour is not).
void write_output(const std::string& output, const Frame& frame, const OutputOptions& options);
/// "####" replaced by the frame number with at least as many digits.
std::string numbered(const std::string& output, int frame_number);
bool has_number(const std::string& output);

}  // namespace sightline
