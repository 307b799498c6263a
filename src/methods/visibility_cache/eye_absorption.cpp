#include "methods/visibility_cache/eye_absorption.h"

#include "base/math/vec3_batch.h"
#include "visibility/query_rays.h"

namespace sightline {

void EyeAbsorption::apply(const QueryBatch& queries, std::span<const float> weights, Contributions& contributions, RayCounts& counts) {
  arriving_.resize(contributions.size);
  medium_.clear(), contribution_.clear();
  for (std::uint32_t i = 0; i < contributions.size; ++i) {
    if (weights[i] == 0) continue;
    const Eye& eye = eyes_[contributions.eye[i]];
    const Ray ray = query_ray(queries, contributions.eye[i], contributions.light[i]);
    const MediumId medium = glm::dot(ray.direction, eye.normal) > 0 ? eye.medium : eye.beyond;
    if (!medium.valid() && !rays_.media().any_interface()) continue;
    arriving_.set(contribution_.size(), ray);
    medium_.push_back(medium), contribution_.push_back(i);
  }
  arriving_.resize(contribution_.size());
  const std::span<const Color> left = rays_.attenuate(arriving_, medium_, counts);
  for (std::size_t k = 0; k < contribution_.size(); ++k) {
    const std::uint32_t i = contribution_[k];
    store(contributions.color, i, load(contributions.color, i) * left[k]);
  }
}

}  // namespace sightline
