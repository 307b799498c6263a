// The smallest user of the installed library.
#include <sightline/error.h>
#include <sightline/version.h>

#include <cstdio>
#include <cstring>

int main() {
  try {
    throw sightline::input_error("unexpected end of file").at("scene.ply:3");
  } catch (const sightline::Error& error) {
    if (std::strcmp(error.what(), "scene.ply:3: unexpected end of file") != 0) return 1;
  }
  std::printf("sightline %s\n", sightline::kVersion);
  return 0;
}
