#include "shade/light_table.h"

namespace sightline {

void LightSampleBatch::resize(std::size_t n) {
  for (Vec3Batch* batch : {&wi, &point, &normal, &radiance}) batch->resize(n);
  for (AlignedVector<float>* array : {&distance, &point_error, &pdf}) array->resize(padded(n));
  is_delta.resize(padded(n));
  is_mesh.resize(padded(n));
  light.resize(padded(n));
}

void LightSampleBatch::set(std::size_t first, std::span<const LightSample> samples) {
  const auto put = [&](auto& array, auto&& value) {
    for (std::size_t i = 0; i < samples.size(); ++i) array[first + i] = value(samples[i]);
  };
  const auto put3 = [&](Vec3Batch& batch, Vec3 LightSample::* member) {
    put(batch.x, [&](const LightSample& s) { return (s.*member).x; });
    put(batch.y, [&](const LightSample& s) { return (s.*member).y; });
    put(batch.z, [&](const LightSample& s) { return (s.*member).z; });
  };
  put3(wi, &LightSample::wi);
  put3(point, &LightSample::point);
  put3(normal, &LightSample::normal);
  put3(radiance, &LightSample::radiance);
  put(distance, [](const LightSample& s) { return s.distance; });
  put(point_error, [](const LightSample& s) { return s.point_error; });
  put(pdf, [](const LightSample& s) { return s.pdf; });
  put(is_delta, [](const LightSample& s) { return static_cast<std::uint8_t>(s.is_delta); });
  put(is_mesh, [](const LightSample& s) { return static_cast<std::uint8_t>(s.is_mesh); });
  put(light, [](const LightSample& s) { return s.light; });
}

}  // namespace sightline
