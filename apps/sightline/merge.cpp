// sightline merge: adds up slices (--sample-range A:B -o NAME.slice) bit for bit.
#include <fmt/format.h>

#include <algorithm>

#include "base/core/error.h"
#include "commands.h"
#include "film/frame_file.h"
#include "image/io/image_io.h"
#include "session/output.h"
#include "sightline/version.h"

namespace sightline::app {
namespace {

SampleRange range_of(const Frame& frame) { return {frame.first_sample(), frame.first_sample() + frame.samples_done()}; }

}  // namespace

int run_merge(const CommandLine& line, Context& context) {
  const MergeCommand& command = line.merge;
  for (const std::string& output : command.outputs) check_output(output);
  const ToneMap tone_map = tone_map_from_name(command.tonemap);
  std::vector<StoredFrame> slices;
  for (const std::string& path : command.slices) {
    slices.push_back(decode_frame(read_file(path), path));
    if (slices.back().identity.text != slices.front().identity.text)
      throw usage_error("the slices belong to different pictures: scene, view, settings, seed or SIMD target differ").at(path);
    if (slices.back().frame.aovs().bits() != slices.front().frame.aovs().bits())
      throw usage_error("the slices have different layers").at(path);
  }
  // Slices that overlap would count samples twice.
  std::sort(slices.begin(), slices.end(),
            [](const StoredFrame& a, const StoredFrame& b) { return a.frame.first_sample() < b.frame.first_sample(); });
  for (std::size_t i = 1; i < slices.size(); ++i) {
    const SampleRange before = range_of(slices[i - 1].frame), here = range_of(slices[i].frame);
    if (here.begin < before.end)
      throw usage_error(fmt::format("slices overlap: samples {}:{} and {}:{}", before.begin, before.end, here.begin, here.end));
    if (here.begin > before.end) context.warn(fmt::format("samples {}:{} are in no slice", before.end, here.begin));
  }
  Frame frame = std::move(slices.front().frame);
  for (std::size_t i = 1; i < slices.size(); ++i) frame.merge(slices[i].frame);
  OutputOptions options;
  options.tone_map = tone_map;
  options.exposure_ev = command.exposure_ev;
  options.identity = slices.front().identity;
  options.note = slices.front().note;
  options.metadata = {{"sightline.version", kVersion},
                      {"sightline.command", line.render.command_line},
                      {"sightline.samples", fmt::format("{}", frame.samples_done())},
                      {"sightline.merged", fmt::format("{} slices", slices.size())},
                      {"sightline.identity", options.identity.text}};
  for (const std::string& output : command.outputs) write_output(output, frame, options);
  return kDone;
}

}  // namespace sightline::app
