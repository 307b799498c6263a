#include "trace/embree/alpha_filter.h"

#include "base/math/vec.h"
#include "trace/alpha_mask.h"

namespace sightline {
namespace {

template <bool kInterfacesToo>
void reject(const RTCFilterFunctionNArguments* arguments) {
  // Standard layout: the context is EmbreeQuery's first member.
  const auto& query = *reinterpret_cast<const EmbreeQuery*>(arguments->context);
  const AlphaMasks& masks = *query.masks;
  const unsigned count = arguments->N;
  for (unsigned i = 0; i < count; ++i) {
    if (arguments->valid[i] != -1) continue;
    const unsigned primitive = RTCHitN_primID(arguments->hit, count, i);
    bool hole = false;
    if (query.in_static_scene || RTCHitN_instID(arguments->hit, count, i, 0) != RTC_INVALID_GEOMETRY_ID) {
      const std::uint32_t instance = query.in_static_scene ? query.tables->static_instances[RTCHitN_geomID(arguments->hit, count, i)]
                                                           : query.tables->top_instances[RTCHitN_instID(arguments->hit, count, i, 0)];
      hole = (kInterfacesToo && masks.is_interface(instance, primitive)) ||
             masks.is_hole(instance, primitive, RTCHitN_u(arguments->hit, count, i), RTCHitN_v(arguments->hit, count, i));
    } else if (kInterfacesToo && masks.is_sphere_interface(primitive)) {
      hole = true;
    } else {
      const float t = RTCRayN_tfar(arguments->ray, count, i);
      const Vec3 origin{RTCRayN_org_x(arguments->ray, count, i), RTCRayN_org_y(arguments->ray, count, i),
                        RTCRayN_org_z(arguments->ray, count, i)};
      const Vec3 direction{RTCRayN_dir_x(arguments->ray, count, i), RTCRayN_dir_y(arguments->ray, count, i),
                           RTCRayN_dir_z(arguments->ray, count, i)};
      hole = masks.is_sphere_hole(primitive, origin + t * direction);
    }
    if (hole) arguments->valid[i] = 0;
  }
}

}  // namespace

void reject_holes(const RTCFilterFunctionNArguments* arguments) { reject<false>(arguments); }
void reject_holes_and_interfaces(const RTCFilterFunctionNArguments* arguments) { reject<true>(arguments); }

}  // namespace sightline
