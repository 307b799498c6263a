#include "scene/materialize.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/core/error.h"
#include "scene/array_builder.h"

namespace sightline {
namespace {

/// Position of `id` in the palette, adding it if it is new.
std::uint16_t palette_index(std::vector<MaterialId>& palette, MaterialId id) {
  const auto found = std::find(palette.begin(), palette.end(), id);
  const auto index = static_cast<std::size_t>(found - palette.begin());
  if (index > std::numeric_limits<std::uint16_t>::max()) throw resource_error("a mesh has more than 65536 materials");
  if (found == palette.end()) palette.push_back(id);
  return static_cast<std::uint16_t>(index);
}

}  // namespace

void require_memory(const Context& context, std::uint64_t bytes, std::string_view purpose, std::uint64_t reserved_bytes) {
  if (context.memory_budget_bytes == 0) return;
  const std::uint64_t used = current_resident_bytes() + reserved_bytes;
  if (bytes <= context.memory_budget_bytes && used <= context.memory_budget_bytes - bytes) return;
  constexpr double kGib = 1024.0 * 1024.0 * 1024.0;
  throw resource_error(fmt::format("{} need {:.2f} GiB beside the {:.2f} GiB in use, and the limit is {:.2f} GiB", purpose,
                                   static_cast<double>(bytes) / kGib, static_cast<double>(used) / kGib,
                                   static_cast<double>(context.memory_budget_bytes) / kGib))
      .remedy("raise --memory-limit or use a smaller scene");
}

Mesh materialize(const Mesh& mesh, const Context& context, std::uint64_t reserved_bytes) {
  if (!mesh.source) return mesh;
  MeshSource& source = *mesh.source;
  const std::uint64_t vertex_count = source.vertex_count(), triangle_count = source.triangle_count();
  if (vertex_count > std::numeric_limits<std::uint32_t>::max() || triangle_count > std::numeric_limits<std::uint32_t>::max()) {
    throw resource_error(
        fmt::format("mesh '{}' has {} vertices and {} triangles, too many for 32-bit indices", mesh.name, vertex_count, triangle_count))
        .remedy("use a method that reads geometry in chunks");
  }
  require_memory(context, vertex_count * sizeof(Vec3) + triangle_count * (sizeof(UVec3) + 2), "the arrays of mesh '" + mesh.name + "'",
                 reserved_bytes);

  Mesh result = mesh;
  result.source.reset();
  result.bounds = source.bounds();
  ArrayBuilder<Vec3> positions(static_cast<std::size_t>(vertex_count));
  ArrayBuilder<UVec3> triangles(static_cast<std::size_t>(triangle_count));
  // Runs of chunks with the same material; expanded only if there is more than one material.
  std::vector<std::pair<std::size_t, std::uint16_t>> run_ends;
  const auto broken = [&] {
    return Error(ErrorCode::bug, fmt::format("the source of mesh '{}' does not give what it declared", mesh.name));
  };

  std::size_t vertex = 0, triangle = 0;
  MeshChunk chunk;
  for (source.restart(); source.next(chunk);) {
    context.check_cancelled();
    if (chunk.positions.size() > positions.values.size() - vertex || chunk.triangles.size() > triangles.values.size() - triangle) {
      throw broken();
    }
    std::copy(chunk.positions.begin(), chunk.positions.end(), positions.values.begin() + static_cast<std::ptrdiff_t>(vertex));
    for (std::size_t i = 0; i < chunk.triangles.size(); ++i) {
      triangles.values[triangle + i] = chunk.triangles[i] + static_cast<std::uint32_t>(vertex);
    }
    vertex += chunk.positions.size();
    triangle += chunk.triangles.size();
    if (chunk.material.valid() || !run_ends.empty()) {
      if (run_ends.empty() && triangle > chunk.triangles.size()) run_ends.push_back({triangle - chunk.triangles.size(), 0});
      const MaterialId own = chunk.material.valid() ? chunk.material : mesh.material_of(0);
      run_ends.push_back({triangle, palette_index(result.materials, own)});
    }
    context.report("load", static_cast<double>(triangle), static_cast<double>(triangle_count));
  }
  if (vertex != vertex_count || triangle != triangle_count) throw broken();

  if (result.materials.size() > 1 && !run_ends.empty()) {
    result.triangle_materials = SharedArray<std::uint16_t>::make(triangle, [&](std::span<std::uint16_t> target) {
      std::size_t begin = 0;
      for (const auto& [end, material] : run_ends) {
        std::fill(target.begin() + static_cast<std::ptrdiff_t>(begin), target.begin() + static_cast<std::ptrdiff_t>(end), material);
        begin = end;
      }
    });
  }
  result.positions = positions.array;
  result.triangles = triangles.array;
  return result;
}

}  // namespace sightline
