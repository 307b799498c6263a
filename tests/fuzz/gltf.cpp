// glTF and GLB from memory: any bytes end in a scene or in an Error.
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/core/error.h"
#include "scene/load/load.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  sightline::Context context;
  context.threads = 1;
  try {
    const sightline::Scene scene = sightline::parse_gltf(std::as_bytes(std::span(data, size)), "fuzz.glb", context);
    // What a loader promises is what everything above relies on.
    for (const sightline::Mesh& mesh : scene.meshes) {
      for (const sightline::UVec3& t : mesh.triangles) {
        if (t.x >= mesh.positions.size() || t.y >= mesh.positions.size() || t.z >= mesh.positions.size()) __builtin_trap();
      }
      if (mesh.bounds.is_empty()) __builtin_trap();
    }
    sightline::scene_hash(sightline::pose(scene, 0.5f));
    sightline::scene_bounds(scene);
  } catch (const sightline::Error& error) {
    if (error.code() == sightline::ErrorCode::bug || error.place().empty()) __builtin_trap();
  }
  return 0;
}
