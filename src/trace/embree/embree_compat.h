// What differs between Embree 3.13 and 4.x, in one place.
#pragma once

#if SIGHTLINE_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace sightline {

class AlphaMasks;
struct GeometryTables;

#if SIGHTLINE_EMBREE_MAJOR >= 4
using EmbreeContext = RTCRayQueryContext;
#else
using EmbreeContext = RTCIntersectContext;
#endif

/// What one batch of queries hands to Embree, and through it to our filter functions: these must not find their data through the
/// geometry, because committed scenes are shared by several Worlds.
struct EmbreeQuery {
  EmbreeContext context;  // first: filters get a pointer to it
  const AlphaMasks* masks = nullptr;
  const GeometryTables* tables = nullptr;
  bool in_static_scene = true;
#if SIGHTLINE_EMBREE_MAJOR >= 4
  RTCIntersectArguments intersect_arguments;
  RTCOccludedArguments occluded_arguments;
#endif

  EmbreeQuery(bool coherent, const AlphaMasks* alpha_masks, const GeometryTables* geometry_tables)
      : masks(alpha_masks), tables(geometry_tables) {
#if SIGHTLINE_EMBREE_MAJOR >= 4
    rtcInitRayQueryContext(&context);
    rtcInitIntersectArguments(&intersect_arguments);
    rtcInitOccludedArguments(&occluded_arguments);
    intersect_arguments.context = occluded_arguments.context = &context;
    intersect_arguments.flags = occluded_arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
#else
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#endif
  }
  EmbreeQuery(const EmbreeQuery&) = delete;
  EmbreeQuery& operator=(const EmbreeQuery&) = delete;
};

#if SIGHTLINE_EMBREE_MAJOR >= 4
inline void embree_intersect(RTCScene scene, EmbreeQuery& query, RTCRayHit& ray) { rtcIntersect1(scene, &ray, &query.intersect_arguments); }
inline void embree_intersect(const int* valid, RTCScene scene, EmbreeQuery& query, RTCRayHit8& rays) {
  rtcIntersect8(valid, scene, &rays, &query.intersect_arguments);
}
inline void embree_intersect(const int* valid, RTCScene scene, EmbreeQuery& query, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &rays, &query.intersect_arguments);
}
inline void embree_occluded(RTCScene scene, EmbreeQuery& query, RTCRay& ray) { rtcOccluded1(scene, &ray, &query.occluded_arguments); }
inline void embree_occluded(const int* valid, RTCScene scene, EmbreeQuery& query, RTCRay8& rays) {
  rtcOccluded8(valid, scene, &rays, &query.occluded_arguments);
}
inline void embree_occluded(const int* valid, RTCScene scene, EmbreeQuery& query, RTCRay16& rays) {
  rtcOccluded16(valid, scene, &rays, &query.occluded_arguments);
}
#else
inline void embree_intersect(RTCScene scene, EmbreeQuery& query, RTCRayHit& ray) { rtcIntersect1(scene, &query.context, &ray); }
inline void embree_intersect(const int* valid, RTCScene scene, EmbreeQuery& query, RTCRayHit8& rays) {
  rtcIntersect8(valid, scene, &query.context, &rays);
}
inline void embree_intersect(const int* valid, RTCScene scene, EmbreeQuery& query, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &query.context, &rays);
}
inline void embree_occluded(RTCScene scene, EmbreeQuery& query, RTCRay& ray) { rtcOccluded1(scene, &query.context, &ray); }
inline void embree_occluded(const int* valid, RTCScene scene, EmbreeQuery& query, RTCRay8& rays) {
  rtcOccluded8(valid, scene, &query.context, &rays);
}
inline void embree_occluded(const int* valid, RTCScene scene, EmbreeQuery& query, RTCRay16& rays) {
  rtcOccluded16(valid, scene, &query.context, &rays);
}
#endif

}  // namespace sightline
