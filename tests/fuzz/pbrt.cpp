// pbrt scenes from memory: any bytes end in a scene or in an Error with a place.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/core/error.h"
#include "scene/load/load.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  sightline::Context context;
  context.threads = 1;
  try {
    const sightline::Scene scene = sightline::parse_pbrt({reinterpret_cast<const char*>(data), size}, "fuzz.pbrt", context);
    // What a loader promises is what everything above relies on.
    for (const sightline::Mesh& mesh : scene.meshes) {
      for (const sightline::UVec3& t : mesh.triangles) {
        if (t.x >= mesh.positions.size() || t.y >= mesh.positions.size() || t.z >= mesh.positions.size()) __builtin_trap();
      }
      if (mesh.bounds.is_empty()) __builtin_trap();
      for (const sightline::MaterialId id : mesh.materials) {
        if (id.index >= scene.materials.size()) __builtin_trap();
      }
    }
    for (const sightline::Instance& instance : scene.instances) {
      if (instance.mesh.index >= scene.meshes.size()) __builtin_trap();
    }
    sightline::scene_hash(scene);
    sightline::scene_bounds(scene);
  } catch (const sightline::Error& error) {
    if (error.code() != sightline::ErrorCode::input || error.place().empty()) __builtin_trap();
  }
  return 0;
}
