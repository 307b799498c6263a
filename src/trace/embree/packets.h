// Traces batches through Embree as single rays or packets.
#pragma once

#include <cstdint>
#include <span>

#include "trace/alpha_mask.h"
#include "trace/embree/alpha_filter.h"
#include "trace/embree/embree_compat.h"
#include "trace/ray_batch.h"

namespace sightline {

/// How a batch is handed to Embree.
struct CallStyle {
  int width = 1;  ///< 1, 8 or 16 rays a call
  bool coherent = false;
};

/// How large triangles are beside a packet of neighbouring rays, as far as their number in the static scene tells.
enum class GeometryDetail : std::uint8_t { coarse, medium, fine };
GeometryDetail geometry_detail(std::uint64_t static_triangles);

/// Scenes to trace one after the other, either may be null, and what their hits mean.
struct EmbreeScenes {
  RTCScene static_scene = nullptr, top_scene = nullptr;
  GeometryTables tables;
  bool static_is_identity = false;  ///< static_instances[i] == i
  GeometryDetail detail = GeometryDetail::medium;
  const AlphaMasks* masks = nullptr;
};

/// The style for a kind of batch: fixed tables, so that equal runs make equal calls. Never coherent on a scene with instances: Embree
/// 3.13.5 then may not return from rtcOccluded16.
CallStyle intersect_style(BatchKind kind, const EmbreeScenes& scenes, int native_width);
CallStyle occluded_style(BatchKind kind, const EmbreeScenes& scenes, int native_width);

void intersect_batch(const EmbreeScenes& scenes, const RayBatch& rays, HitBatch& hits, CallStyle style);
void occluded_batch(const EmbreeScenes& scenes, const RayBatch& rays, std::span<std::uint8_t> occluded, CallStyle style);

}  // namespace sightline
