#include "bench_output.h"

#include <fmt/format.h>

#include <algorithm>

#include "image/io/image_io.h"
#include "image/tone_map.h"

namespace sightline::app {

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

void check_bench_outputs(const BenchCommand& command) {
  for (const std::string& path : {command.html, command.strip, command.json, command.markdown}) {
    if (!path.empty() && path != "-") check_writable(path);
  }
}

int write_bench_results(const BenchCommand& command, const BenchResults& results, const std::string& markdown,
                        std::string (*html)(const BenchResults&), const Context& context) {
  if (!command.json.empty()) write_text(command.json, results.json.dump(2) + "\n");
  if (!command.markdown.empty()) write_text(command.markdown, markdown);
  if (!command.html.empty()) write_text(command.html, html(results));
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
