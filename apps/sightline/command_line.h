// The command line as plain structs: the only code that knows CLI11 is command_line.cpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/load/load.h"
#include "session/render.h"
#include "session/setup.h"

namespace sightline::app {

/// Options that every command has.
struct CommonOptions {
  int threads = 0;
  std::string data_directory;  ///< --data, else $SIGHTLINE_DATA
  std::string log_level = "info";
  std::string progress = "auto";
  std::string simd;
};

struct RenderCommand {
  std::vector<std::string> scenes, outputs;
  std::vector<std::string> materials;  ///< option texts
  ViewRequest view;
  LightRequest lights;
  RenderRequest render;
  std::string aovs, tonemap = "srgb", stats, tracer = "embree";
  float exposure_ev = 0;
  std::optional<int> frame;
  std::optional<std::string> frames;
  float fps = 24;
  bool seed_per_frame = false, skip_existing = false;
  bool smooth_terminator = false;
  std::uint64_t seed = 0;
  std::optional<double> memory_limit_gib;
  std::optional<std::string> bake_directory;
  bool bake_json = false;
  std::string command_line;  ///< as typed, for the EXR header
};

struct CompareCommand {
  std::string reference;
  std::vector<std::string> images;
  std::string json, html, difference;
  bool mask = false;
  float exposure_ev = 0;
  std::vector<std::string> fail_over;  ///< "metric=value"
};

struct MethodsCommand {
  std::string name;
  bool json = false;
};

struct InfoCommand {
  std::vector<std::string> files, materials;
  bool json = false;
};

struct BenchCommand {
  std::vector<std::string> suites, views;
  std::vector<std::string> parts, ce, spp, settings;
  std::optional<int> truth_samples, rounds;
  std::string cache_directory;
  std::optional<std::string> bake_directory;
  std::optional<IVec2> size_px;
  std::string json, markdown, html, strip;
  bool quick = false;
};

struct GalleryCommand {
  std::vector<std::string> pictures;
  std::string output, title = "Pictures", tonemap = "srgb";
  float exposure_ev = 0;
};

struct MergeCommand {
  std::vector<std::string> slices, outputs;
  std::string tonemap = "srgb", stats;
  float exposure_ev = 0;
};

struct CommandLine {
  enum class Command { none, render, compare, methods, info, bake, bench, gallery, merge };
  Command command = Command::none;
  CommonOptions common;
  RenderCommand render;
  CompareCommand compare;
  MethodsCommand methods;
  InfoCommand info;
  BenchCommand bench;
  GalleryCommand gallery;
  MergeCommand merge;
};

/// Parses the arguments. Returns nothing when help or version was printed; throws Error{usage} on a mistake.
std::optional<CommandLine> parse_command_line(int argument_count, const char* const* arguments);

}  // namespace sightline::app
