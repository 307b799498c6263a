#include "shade/light_table.h"

namespace sightline {

void LightSampleBatch::resize(std::size_t n) {
  for (Vec3Batch* batch : {&wi, &point, &normal, &radiance}) batch->resize(n);
  for (AlignedVector<float>* array : {&distance, &point_error, &pdf}) array->resize(padded(n));
  is_delta.resize(padded(n));
  is_mesh.resize(padded(n));
  light.resize(padded(n));
}

void LightSampleBatch::set(std::size_t i, const LightSample& s) {
  const auto put = [i](Vec3Batch& batch, const Vec3& v) {
    batch.x[i] = v.x;
    batch.y[i] = v.y;
    batch.z[i] = v.z;
  };
  put(wi, s.wi);
  put(point, s.point);
  put(normal, s.normal);
  put(radiance, s.radiance);
  distance[i] = s.distance;
  point_error[i] = s.point_error;
  pdf[i] = s.pdf;
  is_delta[i] = s.is_delta ? 1 : 0;
  is_mesh[i] = s.is_mesh ? 1 : 0;
  light[i] = s.light;
}

}  // namespace sightline
