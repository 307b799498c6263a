// The smallest user of the installed library: loads a scene, renders it, looks at the picture.
#include <sightline/sightline.h>

#include <cmath>
#include <cstdio>
#include <cstring>

namespace {

// Errors of the library are caught by users, with code and text intact.
bool reports_unknown_scene() {
  try {
    sightline::Renderer().load("builtin:cornel");
  } catch (const sightline::Error& error) {
    return error.code() == sightline::ErrorCode::usage && std::strstr(error.what(), "cornell") != nullptr;
  }
  return false;
}

}  // namespace

int main() {
  try {
    if (!reports_unknown_scene()) return 1;
    sightline::Renderer renderer({.threads = 1});
    renderer.load("builtin:cornell");
    const sightline::Picture picture = renderer.render({.width = 32, .height = 24, .spp = 4, .max_bounces = 2});
    if (picture.width != 32 || picture.height != 24 || picture.rgb.size() != 3u * 32 * 24 || !picture.complete) return 2;
    double sum = 0;
    for (const float value : picture.rgb) sum += value;
    if (!(sum > 0) || !std::isfinite(sum)) return 3;
    if (picture.statistics_json.find("\"reference\"") == std::string::npos) return 4;
    // The same seed gives the same pixels.
    if (renderer.render({.width = 32, .height = 24, .spp = 4, .max_bounces = 2}).rgb != picture.rgb) return 5;
  } catch (const sightline::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 6;
  }
  std::printf("sightline %s\n", sightline::kVersion);
  return 0;
}
