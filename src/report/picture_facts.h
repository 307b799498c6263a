// What a rendered picture says about itself, for people.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sightline {

/// A few facts out of the statistics that `render` writes (docs/cli.md): method, size, samples, seconds, rays, triangles, memory, each as
/// it is shown. What is missing is left out; text that is no JSON gives nothing.
std::vector<std::pair<std::string, std::string>> picture_facts(std::string_view statistics_json);

/// 1234567 as "1.23 M"; units k, M, G, T.
std::string short_number(double value);

}  // namespace sightline
