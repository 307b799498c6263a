// sightline bench visibility-cache
#include <fmt/format.h>

#include <algorithm>

#include "base/core/error.h"
#include "base/settings/settings.h"
#include "bench/visibility_cache/cache_bench.h"
#include "commands.h"
#include "image/io/image_io.h"
#include "image/tone_map.h"

namespace sightline::app {
namespace {

// "4,8" and repeated options alike.
std::vector<std::string> listed(const std::vector<std::string>& texts) {
  std::vector<std::string> items;
  for (const std::string& text : texts) {
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      items.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  return items;
}

}  // namespace

int run_visibility_cache_bench(const CommandLine& line, Context& context) {
  const BenchCommand& command = line.bench;
  CacheBenchOptions options;
  options.data = line.common.data_directory;
  options.views = command.views;
  options.parts = listed(command.parts);
  for (const std::string& text : listed(command.ce)) options.ce.push_back(parse_real("--ce", text, {.minimum = 1e-3, .maximum = 1e6}));
  for (const std::string& text : listed(command.spp))
    options.spp.push_back(static_cast<int>(parse_integer("--spp", text, {.minimum = 1, .maximum = 65536})));
  options.size_px = command.size_px;
  options.quick = command.quick;
  options.strip = !command.strip.empty();
  for (const std::string& path : {command.html, command.strip, command.json, command.markdown}) {
    if (!path.empty() && path != "-") check_writable(path);
  }

  const CacheBenchResults results = run_cache_bench(options, context);
  const std::string markdown = cache_bench_markdown(results.json);
  if (!command.json.empty()) write_text(command.json, results.json.dump(2) + "\n");
  if (!command.markdown.empty()) write_text(command.markdown, markdown);
  if (!command.html.empty()) write_text(command.html, cache_bench_html(results));
  if (!command.strip.empty() && results.strip)
    write_file(command.strip, encode_png(results.strip->width, results.strip->height, 3, to_srgb8(*results.strip)));
  else if (!command.strip.empty())
    context.warn("no frame of a camera move was made: there is no strip to write");
  if (command.json != "-" && command.markdown != "-" && command.html != "-") fmt::print("{}", markdown);
  if (!results.json["interrupted"].get<bool>()) return kDone;
  context.warn("interrupted: the results are those of the parts done so far");
  return kInterrupted;
}

}  // namespace sightline::app
