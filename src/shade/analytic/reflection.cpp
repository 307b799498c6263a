#include "shade/analytic/reflection.h"

#include <algorithm>
#include <cmath>

#include "shade/analytic/polygon_plane.h"

namespace sightline {

PolygonReflection reflect_polygon(std::span<const Vec3> polygon, const Vec3& position, const Vec3& normal, const Vec3& wo,
                                  const AnalyticLobes& lobes, EmitterSides sides) {
  const PolygonPlane plane(polygon);
  const double height = glm::dot(Vec3d(position) - Vec3d(plane.centre), Vec3d(plane.normal));
  if (!plane.emits_towards(height, sides)) return {};
  const Vec3 upward = glm::dot(wo, normal) < 0 ? -normal : normal;
  const std::vector<Vec3d> local = local_polygon(polygon, position, frame_from_normal_tangent(upward, wo));
  const auto share = [&](const glm::dmat3& transform) {
    const double form_factor = horizon_form_factor(local, transform);
    return static_cast<float>(std::max(0.0, height > 0 ? form_factor : -form_factor));
  };
  PolygonReflection result;
  result.diffuse = lobes.diffuse * share(glm::dmat3(1));
  if (!is_black(lobes.wide)) {
    const double narrowed = 1 / static_cast<double>(lobes.stretch);
    result.diffuse = glm::max(result.diffuse + lobes.wide * share({narrowed, 0, 0, 0, narrowed, 0, 0, 0, 1}), Color(0));
  }
  if (!is_black(lobes.specular)) result.specular = lobes.specular * share({lobes.m11, 0, lobes.m31, 0, 1, 0, lobes.m13, 0, lobes.m33});
  return result;
}

void AnalyticLobesBatch::resize(std::size_t n) {
  for (Vec3Batch* batch : {&diffuse, &wide, &specular}) batch->resize(n);
  for (AlignedVector<float>* values : {&stretch, &m11, &m13, &m31, &m33}) values->resize(padded(n));
}

void AnalyticLobesBatch::set(std::size_t i, const AnalyticLobes& lobes) {
  const auto set_color = [i](Vec3Batch& batch, const Color& c) { batch.x[i] = c.x, batch.y[i] = c.y, batch.z[i] = c.z; };
  set_color(diffuse, lobes.diffuse), set_color(wide, lobes.wide), set_color(specular, lobes.specular);
  stretch[i] = lobes.stretch;
  m11[i] = lobes.m11, m13[i] = lobes.m13, m31[i] = lobes.m31, m33[i] = lobes.m33;
}

}  // namespace sightline
