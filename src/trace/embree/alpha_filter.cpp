#include "trace/embree/alpha_filter.h"

#include "base/math/vec.h"
#include "trace/alpha_mask.h"

namespace sightline {

void reject_holes(const RTCFilterFunctionNArguments* arguments) {
  // Standard layout: the context is EmbreeQuery's first member.
  const auto& query = *reinterpret_cast<const EmbreeQuery*>(arguments->context);
  const unsigned count = arguments->N;
  for (unsigned i = 0; i < count; ++i) {
    if (arguments->valid[i] != -1) continue;
    const unsigned primitive = RTCHitN_primID(arguments->hit, count, i);
    bool hole = false;
    if (query.in_static_scene || RTCHitN_instID(arguments->hit, count, i, 0) != RTC_INVALID_GEOMETRY_ID) {
      const std::uint32_t instance = query.in_static_scene ? query.tables->static_instances[RTCHitN_geomID(arguments->hit, count, i)]
                                                           : query.tables->top_instances[RTCHitN_instID(arguments->hit, count, i, 0)];
      hole = query.masks->is_hole(instance, primitive, RTCHitN_u(arguments->hit, count, i), RTCHitN_v(arguments->hit, count, i));
    } else {
      const float t = RTCRayN_tfar(arguments->ray, count, i);
      const Vec3 origin{RTCRayN_org_x(arguments->ray, count, i), RTCRayN_org_y(arguments->ray, count, i),
                        RTCRayN_org_z(arguments->ray, count, i)};
      const Vec3 direction{RTCRayN_dir_x(arguments->ray, count, i), RTCRayN_dir_y(arguments->ray, count, i),
                           RTCRayN_dir_z(arguments->ray, count, i)};
      hole = query.masks->is_sphere_hole(primitive, origin + t * direction);
    }
    if (hole) arguments->valid[i] = 0;
  }
}

}  // namespace sightline
