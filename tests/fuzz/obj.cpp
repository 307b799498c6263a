// OBJ from memory: any bytes end in a scene or in an Error.
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/core/error.h"
#include "scene/load/load.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  sightline::Context context;
  context.threads = 1;
  try {
    const sightline::Scene scene = sightline::parse_obj({reinterpret_cast<const char*>(data), size}, "fuzz.obj", context);
    for (const sightline::Mesh& mesh : scene.meshes) {
      for (const sightline::UVec3& t : mesh.triangles) {
        if (t.x >= mesh.positions.size() || t.y >= mesh.positions.size() || t.z >= mesh.positions.size()) __builtin_trap();
      }
    }
  } catch (const sightline::Error& error) {
    if (error.code() == sightline::ErrorCode::bug || error.place().empty()) __builtin_trap();
  }
  return 0;
}
