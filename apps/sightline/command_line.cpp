#include "command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "base/core/error.h"
#include "base/settings/settings.h"
#include "bench_suites.h"
#include "session/material_option.h"
#include "session/options_text.h"
#include "sightline/version.h"

namespace sightline::app {
namespace {

// An option whose text is parsed by one of our own parsers.
template <class T, class Parse>
CLI::Option* add_parsed(CLI::App& app, const std::string& name, std::optional<T>& target, Parse parse, const std::string& help,
                        const std::string& form) {
  return app
      .add_option_function<std::string>(
          name, [&target, parse, name](const std::string& text) { target = parse(name.substr(name.find("--")), text); }, help)
      ->type_name(form);
}

template <class T>
CLI::Option* add_optional(CLI::App& app, const std::string& name, std::optional<T>& target, const std::string& help,
                          const std::string& form) {
  return app.add_option(name, target, help)->type_name(form);
}

void add_common(CLI::App& app, CommonOptions& common) {
  app.add_option("--threads", common.threads, "worker threads (default: all cores)")
      ->type_name("N")
      ->check(CLI::Range(0, 4096))
      ->group("General");
  app.add_option("--data", common.data_directory, "folder of test scenes, for bench and content= (default: $SIGHTLINE_DATA)")
      ->type_name("DIR")
      ->envname("SIGHTLINE_DATA")
      ->group("General");
  app.add_option("--simd", common.simd, "pin the instruction set: AVX3, AVX2, SSSE3 (default: the best)")
      ->type_name("NAME")
      ->group("General");
  app.add_option("--progress", common.progress, "auto, bar, plain, json or none")
      ->type_name("KIND")
      ->check(CLI::IsMember({"auto", "bar", "plain", "json", "none"}))
      ->group("General");
  app.add_option("--log-level", common.log_level, "debug, info, warning or error")
      ->type_name("LEVEL")
      ->check(CLI::IsMember({"debug", "info", "warning", "error"}))
      ->group("General");
  app.add_flag_callback("-v,--verbose", [&common] { common.log_level = "debug"; }, "say more")->group("General");
  app.add_flag_callback(
         "-q,--quiet", [&common] { common.log_level = "error", common.progress = "none"; }, "say only errors")
      ->group("General");
}

void add_render_view(CLI::App& app, RenderCommand& r) {
  const std::string group = "View";
  add_parsed(app, "--size", r.view.size_px, parse_size, "picture size in pixels (default: the scene's, else 1280x720)", "WxH")
      ->group(group);
  add_optional(app, "--camera", r.view.camera, "camera by name or number (default: the first)", "NAME")->group(group);
  add_parsed(app, "--eye", r.view.eye, parse_vec3, "camera position", "X,Y,Z")->group(group);
  add_parsed(app, "--target", r.view.target, parse_vec3, "point the camera looks at", "X,Y,Z")->group(group);
  add_parsed(app, "--up", r.view.up, parse_vec3, "up direction (default 0,1,0)", "X,Y,Z")->group(group);
  add_optional(app, "--fov", r.view.fov_deg, "vertical field of view in degrees", "DEG")->check(CLI::Range(0.001, 179.0))->group(group);
  app.add_option("--filter", r.view.filter, "pixel filter: gaussian, box or centre")->type_name("NAME")->group(group);
  add_optional(app, "--frame", r.frame, "animation frame (default 0)", "N")->group(group);
  add_optional(app, "--frames", r.frames, "render frames A to B, every S-th", "A-B[xS]")->group(group);
  app.add_option("--fps", r.fps, "frames a second of the animation clock")
      ->type_name("N")
      ->check(CLI::PositiveNumber)
      ->group(group)
      ->capture_default_str();
  app.add_flag("--seed-per-frame", r.seed_per_frame, "mix the frame number into the seed")->group(group);
  app.add_flag("--skip-existing", r.skip_existing, "leave out frames whose outputs exist")->group(group);
}

void add_render_lights(CLI::App& app, RenderCommand& r) {
  const std::string group = "Lights (added to the scene's)";
  add_optional(app, "--environment", r.lights.environment, "image-based light (.hdr, .exr, ...)", "FILE")->group(group);
  app.add_option("--environment-scale", r.lights.environment_scale, "multiplies the environment")->type_name("S")->group(group);
  app.add_option("--environment-rotate", r.lights.environment_rotate_deg, "turns it counter-clockwise about +Y")
      ->type_name("DEG")
      ->group(group);
  app.add_option("--environment-mapping", r.lights.environment_mapping, "latlong, angular, octahedral or cube")
      ->type_name("NAME")
      ->group(group);
  app.add_option("--environment-turn", r.lights.environment_turn_deg, "turns it by so much more each frame")
      ->type_name("DEG")
      ->group(group);
  app.add_option("--environment-cube", r.lights.environment_cube, "makes it a cube map of N x N texels a face, constant over each")
      ->type_name("N")
      ->check(CLI::Range(1, 4096))
      ->group(group);
  app.add_option("--light-area", r.lights.area, "one-sided rectangle: \"X,Y,Z NX,NY,NZ WxH R,G,B\" (radiance); repeatable")
      ->type_name("TEXT")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->group(group);
  app.add_option("--light-point", r.lights.point, "\"X,Y,Z R,G,B\" (intensity); repeatable")
      ->type_name("TEXT")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->group(group);
  app.add_option("--light-directional", r.lights.directional, "\"DX,DY,DZ R,G,B\" (irradiance); repeatable")
      ->type_name("TEXT")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->group(group);
  app.add_flag("!--no-default-light", r.lights.default_light, "leave a scene without lights dark")->group(group);
}

/// The models with their parameters and defaults, one a line.
std::string material_listing() {
  std::string text = "Models of --material, with defaults ('sightline info material:' explains them):";
  for (const MaterialChoice& choice : material_choices()) {
    text += "\n  " + choice.name;
    for (const auto& [key, value] : choice.parameters.to_text()) text += fmt::format(",{}={}", key, value.empty() ? "..." : value);
  }
  return text;
}

void add_materials(CLI::App& app, std::vector<std::string>& materials) {
  app.add_option("--material", materials,
                 "replaces the reflectance of the material NAME, or of everything but lights and a built-in stage; repeatable")
      ->type_name("[NAME=]MODEL[,KEY=VALUE...]")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->group("Materials");
  app.footer(material_listing());
}

void add_render_method(CLI::App& app, RenderCommand& r) {
  const std::string group = "Method";
  app.add_option("--method", r.render.method, "how the picture is formed (sightline methods lists them)")
      ->type_name("NAME")
      ->group(group)
      ->capture_default_str();
  app.add_option("--set", r.render.settings, "a setting of the method or visibility; repeatable")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->group(group);
  add_optional(app, "--visibility", r.render.visibility, "how visibility is answered (default: the method's own)", "NAME")->group(group);
  add_optional(app, "--spp", r.render.spp, "samples a pixel (default: the scene's, else the method's)", "N")
      ->check(CLI::Range(1, 1 << 30))
      ->group(group);
  add_optional(app, "--light-samples", r.render.light_samples, "light samples a shading point", "N")
      ->check(CLI::Range(1, 65536))
      ->group(group);
  add_optional(app, "--max-bounces", r.render.max_bounces, "indirect bounces, 0 = direct light only (default: the scene's, else 8)", "N")
      ->check(CLI::Range(0, 1000000))
      ->group(group);
  app.add_option("--seed", r.seed, "seed of all random numbers")->type_name("N")->group(group)->capture_default_str();
  app.add_option("--tracer", r.tracer, "embree or brute")
      ->type_name("NAME")
      ->check(CLI::IsMember({"embree", "brute"}))
      ->group(group)
      ->capture_default_str();
  add_optional(app, "--bake-dir", r.bake_directory, "folder of what methods precompute; '' keeps nothing (default: the user's cache)",
               "DIR")
      ->group(group);
  app.add_flag("--smooth-terminator", r.smooth_terminator, "shade coarse meshes as the curved surface that their normals suggest")
      ->group(group);
}

void add_render_limits(CLI::App& app, RenderCommand& r) {
  const std::string group = "Limits";
  add_optional(app, "--target-error", r.render.target_error, "stop when the estimated relative error falls below E", "E")
      ->check(CLI::PositiveNumber)
      ->group(group);
  add_optional(app, "--time-limit", r.render.time_limit_s, "stop in time with the best picture so far", "SECONDS")
      ->check(CLI::PositiveNumber)
      ->group(group);
  add_optional(app, "--memory-limit", r.memory_limit_gib, "refuse what would not fit", "GIB")->check(CLI::PositiveNumber)->group(group);
  add_parsed(app, "--sample-range", r.render.sample_range, parse_sample_range,
             "render only samples A to B-1 of the --spp, for merge (-o NAME.slice)", "A:B")
      ->group(group);
  app.add_option_function<std::string>(
         "--checkpoint", [&r](const std::string& p) { r.render.checkpoint = p; }, "save progressive state now and then")
      ->type_name("FILE")
      ->group(group);
  app.add_option_function<std::string>(
         "--resume", [&r](const std::string& p) { r.render.resume = p; }, "go on from a checkpoint")
      ->type_name("FILE")
      ->group(group);
}

void add_render_output(CLI::App& app, RenderCommand& r) {
  const std::string group = "Output";
  app.add_option("-o,--output", r.outputs, ".exr, .hdr, .pfm, .png, .jpg or .slice; repeatable; #### is the frame number; exr:- is stdout")
      ->type_name("FILE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->required()
      ->group(group);
  app.add_option("--aov", r.aovs,
                 "layers for EXR: albedo,normal,position,depth,surface,direct,indirect,variance,alpha (also for PNG) or all")
      ->type_name("LIST")
      ->group(group);
  app.add_option("--exposure", r.exposure_ev, "stops, for 8-bit outputs")->type_name("EV")->group(group);
  app.add_option("--tonemap", r.tonemap, "srgb, reinhard, aces or filmic, for 8-bit outputs")
      ->type_name("NAME")
      ->group(group)
      ->capture_default_str();
  app.add_option("--stats", r.stats, "statistics as JSON (- is stdout)")->type_name("FILE")->group(group);
}

void add_bench(CLI::App& app, BenchCommand& bench) {
  std::vector<std::string> suites, parts;
  for (const BenchSuite& suite : bench_suites()) {
    suites.emplace_back(suites.empty() ? std::string(suite.name) + " (default)" : suite.name);
    if (suite.parts) parts.push_back(fmt::format("{}: {}", suite.name, fmt::join(suite.parts(), ", ")));
  }
  app.add_option("SUITE", bench.suites, fmt::format("{}", fmt::join(suites, ", ")));
  // What only some suites read says so.
  const auto help = [](const char* name, const std::string& text) {
    return fmt::format("{}: {}", fmt::join(suites_with(name), ", "), text);
  };
  const auto add_list = [&](const char* name, std::vector<std::string>& target, const std::string& text, const char* type) {
    app.add_option(name, target, text)->type_name(type)->take_all()->expected(1)->allow_extra_args(false);
  };
  add_list("--view", bench.views, "a standard view, or builtin:SCENE, instead of the suite's own; repeatable", "NAME");
  add_list("--part", bench.parts, fmt::format("{} (default: all)", fmt::join(parts, "; ")), "LIST");
  add_list("--ce", bench.ce, help("--ce", "C_E of the curves (default: 4,8,16,36,64)"), "LIST");
  add_list("--spp", bench.spp, help("--spp", "samples a pixel of curves and shadow maps (default: 1,9,16)"), "LIST");
  add_list("--set", bench.settings, help("--set", "a setting of the curves' cached pictures; repeatable"), "NAME=VALUE");
  app.add_option("--json", bench.json, "results as JSON (- is stdout)")->type_name("FILE");
  app.add_option("--markdown", bench.markdown, "results as a Markdown table")->type_name("FILE");
  app.add_option("--html", bench.html, help("--html", "charts, tables and pictures as one page"))->type_name("FILE");
  app.add_option("--strip", bench.strip, help("--strip", "frames of what moves as a PNG"))->type_name("FILE");
  add_parsed(app, "--size", bench.size_px, parse_size, "picture size (default: the views' own)", "WxH");
  add_optional(app, "--truth-samples", bench.truth_samples, help("--truth-samples", "light samples a pixel of the reference"), "N")
      ->check(CLI::Range(1, 1 << 20));
  add_optional(app, "--rounds", bench.rounds, help("--rounds", "rounds that times are the median of (default: 3)"), "N")
      ->check(CLI::Range(1, 1000));
  app.add_option("--cache-dir", bench.cache_directory, help("--cache-dir", "folder in which reference pictures are kept"))
      ->type_name("DIR");
  add_optional(app, "--bake-dir", bench.bake_directory,
               help("--bake-dir", "folder in which bakes are kept; '' keeps them in memory (default: the user's cache)"), "DIR");
  app.add_flag("--quick", bench.quick, "small pictures and few repetitions: to see that it works, not to quote");
}

}  // namespace

namespace {

/// The mistake in one line; for an option or command that does not exist, with the one that was probably meant.
Error mistake(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  for (const CLI::App* sub : app.get_subcommands()) command = sub;
  Error usage = usage_error(error.what());
  usage.remedy(fmt::format("see '{} --help'", command == &app ? app.get_name() : app.get_name() + " " + command->get_name()));
  std::vector<std::string> known;
  for (const CLI::Option* option : command->get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  for (const CLI::App* sub : command->get_subcommands([](const CLI::App*) { return true; })) known.push_back(sub->get_name());
  std::vector<std::string> left = command->remaining();
  if (command != &app && left.empty()) left = app.remaining();
  for (const std::string& argument : left) {
    const std::string name = argument.substr(0, argument.find('='));
    const std::string nearest = nearest_name(name, known);
    if (argument.starts_with("--") && !nearest.empty())
      return usage_error(fmt::format("unknown option '{}'", name)).remedy(fmt::format("did you mean '{}'?", nearest));
    if (argument.starts_with("--"))
      return usage_error(fmt::format("unknown option '{}'", name))
          .remedy(fmt::format("'sightline {} --help' lists them", command->get_name()));
    if (command == &app) {
      return usage_error(fmt::format("unknown command '{}'", argument))
          .remedy(nearest.empty() ? "'sightline --help' lists them" : fmt::format("did you mean '{}'?", nearest));
    }
  }
  return usage;
}

}  // namespace

std::optional<CommandLine> parse_command_line(int argument_count, const char* const* arguments) {
  CommandLine line;
  CLI::App app("Sightline renders direct and global illumination on CPUs and makes visibility cheap.", "sightline");
  app.set_version_flag("--version", std::string("sightline ") + kVersion);
  app.require_subcommand(1);
  app.fallthrough(false);
  app.footer(
      "'sightline COMMAND --help' shows a command's options. Exit codes: 0 done, 1 a bug, 2 wrong usage, 3 unreadable input,\n"
      "4 a resource ran out, 5 interrupted, 6 compare over a threshold.");

  CLI::App* render = app.add_subcommand("render", "render one view, or a sequence of frames");
  render->add_option("SCENE", line.render.scenes, "scene files (.gltf .glb .pbrt .obj .ply) or builtin:NAME; several are merged")
      ->required();
  add_render_output(*render, line.render);
  add_render_method(*render, line.render);
  add_render_view(*render, line.render);
  add_render_lights(*render, line.render);
  add_materials(*render, line.render.materials);
  add_render_limits(*render, line.render);

  CLI::App* compare = app.add_subcommand("compare", "error metrics, difference images, an HTML report");
  compare->add_option("REFERENCE", line.compare.reference, "the picture taken for the truth")->required();
  compare->add_option("IMAGE", line.compare.images, "pictures to compare with it")->required();
  compare->add_option("--json", line.compare.json, "metrics as JSON (- is stdout)")->type_name("FILE");
  compare->add_option("--html", line.compare.html, "a self-contained report")->type_name("FILE");
  compare->add_option("--difference", line.compare.difference, "false-colour FLIP error of the first image (.png)")->type_name("FILE");
  compare->add_flag("--mask", line.compare.mask, "leave out background and emitters (the reference's surface layer)");
  compare->add_option("--exposure", line.compare.exposure_ev, "stops before tone mapping, for psnr, ssim and flip")->type_name("EV");
  compare->add_option("--fail-over", line.compare.fail_over, "exit with 6 if a metric is worse than VALUE; repeatable")
      ->type_name("METRIC=VALUE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);

  CLI::App* methods = app.add_subcommand("methods", "the methods and their settings");
  methods->add_option("NAME", line.methods.name, "one method or visibility");
  methods->add_flag("--json", line.methods.json, "as JSON");

  CLI::App* info = app.add_subcommand("info", "what is in a scene, picture or frame file");
  info->add_option("FILE", line.info.files, "scene, picture, slice or checkpoint; builtin: lists the built-in scenes, material: the models")
      ->required();
  add_materials(*info, line.info.materials);
  info->add_flag("--json", line.info.json, "as JSON");

  CLI::App* bake = app.add_subcommand("bake", "precompute and store what a method needs");
  bake->add_option("SCENE", line.render.scenes, "scene files or builtin:NAME; several are merged")->required();
  add_render_method(*bake, line.render);
  add_render_lights(*bake, line.render);
  add_materials(*bake, line.render.materials);
  add_optional(*bake, "--frame", line.render.frame, "animation frame (default 0)", "N");
  add_optional(*bake, "--memory-limit", line.render.memory_limit_gib, "refuse what would not fit", "GIB")->check(CLI::PositiveNumber);
  bake->add_flag("--json", line.render.bake_json, "what was found and made, as JSON");

  CLI::App* bench = app.add_subcommand("bench", "measure: methods and tracers side by side");
  add_bench(*bench, line.bench);

  CLI::App* gallery = app.add_subcommand("gallery", "pictures and what they say about themselves as one HTML page");
  gallery->add_option("PICTURE", line.gallery.pictures, "picture files; a page of the same name (.html) beside one becomes its link")
      ->required();
  gallery->add_option("-o,--output", line.gallery.output, "the page (.html)")->type_name("FILE")->required();
  gallery->add_option("--title", line.gallery.title, "heading")->type_name("TEXT");
  gallery->add_option("--exposure", line.gallery.exposure_ev, "stops")->type_name("EV");
  gallery->add_option("--tonemap", line.gallery.tonemap, "srgb, reinhard, aces or filmic")->type_name("NAME");

  CLI::App* merge = app.add_subcommand("merge", "add up sample ranges rendered apart");
  merge->add_option("SLICE", line.merge.slices, "slices of one picture")->required();
  merge->add_option("-o,--output", line.merge.outputs, "as for render; .slice joins slices")
      ->type_name("FILE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->required();
  merge->add_option("--exposure", line.merge.exposure_ev, "stops, for 8-bit outputs")->type_name("EV");
  merge->add_option("--tonemap", line.merge.tonemap, "srgb, reinhard, aces or filmic")->type_name("NAME");

  const std::vector<std::pair<CLI::App*, CommandLine::Command>> commands = {
      {render, CommandLine::Command::render},   {compare, CommandLine::Command::compare}, {methods, CommandLine::Command::methods},
      {info, CommandLine::Command::info},       {bake, CommandLine::Command::bake},       {bench, CommandLine::Command::bench},
      {gallery, CommandLine::Command::gallery}, {merge, CommandLine::Command::merge}};
  for (const auto& [sub, command] : commands) add_common(*sub, line.common);

  try {
    app.parse(argument_count, arguments);
  } catch (const CLI::Success& success) {
    app.exit(success, std::cout, std::cerr);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw mistake(app, error);
  }
  for (const auto& [sub, command] : commands) {
    if (sub->parsed()) line.command = command;
  }
  for (int i = 0; i < argument_count; ++i) line.render.command_line += (i ? " " : "") + std::string(arguments[i]);
  return line;
}

}  // namespace sightline::app
