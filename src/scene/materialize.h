// From a stream of chunks to arrays, within the memory budget.
#pragma once

#include <cstdint>
#include <string_view>

#include "base/core/context.h"
#include "scene/mesh.h"

namespace sightline {

/// Throws Error{resource} if `bytes` more would exceed the context's memory budget: called before a big allocation.
/// `reserved_bytes` of it are spoken for.
void require_memory(const Context& context, std::uint64_t bytes, std::string_view purpose, std::uint64_t reserved_bytes = 0);

/// The mesh with its source read into arrays; a mesh that has arrays already comes back as it is. Counts are known beforehand, so each
/// array is allocated once: the peak is the arrays and one chunk. Degenerate triangles are kept (sources are ours and make none).
/// Chunks with a material of their own fill triangle_materials. Throws Error{resource} before allocating what does not fit, Error{input}
/// if the source breaks its promise.
Mesh materialize(const Mesh& mesh, const Context& context, std::uint64_t reserved_bytes = 0);

}  // namespace sightline
