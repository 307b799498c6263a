#include "methods/example/kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/sample/sobol.h"
#include "shade/material_eval.h"

namespace sightline {
namespace {

Vec3 load(const Vec3Batch& batch, std::size_t i) { return {batch.x[i], batch.y[i], batch.z[i]}; }

}  // namespace

ExampleKernel::ExampleKernel(const World& world, const View& view, Visibility& visibility, const ExampleSettings& settings,
                             std::uint64_t seed)
    : world_(world), view_(view), settings_(settings), seed_(seed), visibility_(visibility.worker()) {}

void ExampleKernel::render_tile(const Tile& tile, SampleRange samples, Frame& frame, PassStatistics& statistics) {
  const auto count = static_cast<std::size_t>(tile.pixel_count());
  for (auto* numbers : {&pixel_, &key_, &index_}) numbers->resize(padded(count));
  for (auto* numbers : {&u0_, &u1_, &u2_, &u3_}) numbers->resize(padded(count));
  rays_.resize(count);
  radiance_.resize(count);
  std::size_t i = 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x, ++i) {
      pixel_[i] = static_cast<std::uint32_t>(y * view_.width() + x);
      key_[i] = pixel_key(seed_, pixel_[i]);
    }
  }
  visibility_->begin(tile.index);
  for (std::uint32_t sample = samples.begin; sample < samples.end; ++sample) {
    trace_camera_rays(sample, statistics);
    gather_queries(sample);
    add_results(sample, frame, statistics);
  }
}

void ExampleKernel::random_numbers(std::uint32_t sample, std::uint32_t pair, AlignedVector<float>& u, AlignedVector<float>& v) {
  std::fill(index_.begin(), index_.end(), sample);
  sobol_2d(key_.data(), index_.data(), pair, rays_.size, u.data(), v.data());
}

void ExampleKernel::trace_camera_rays(std::uint32_t sample, PassStatistics& statistics) {
  random_numbers(sample, dimension::kPixel, u0_, u1_);
  random_numbers(sample, dimension::kLens, u2_, u3_);
  view_.primary_rays(pixel_.data(), u0_.data(), u1_.data(), u2_.data(), u3_.data(), rays_.size,
                     {rays_.origin.x.data(), rays_.origin.y.data(), rays_.origin.z.data(), rays_.direction.x.data(),
                      rays_.direction.y.data(), rays_.direction.z.data()});
  std::fill(rays_.t_near.begin(), rays_.t_near.end(), 0.f);
  std::fill(rays_.t_far.begin(), rays_.t_far.end(), std::numeric_limits<float>::infinity());
  world_.tracer().intersect(rays_, hits_, BatchKind::primary, statistics.rays);
  world_.surfaces(rays_, hits_, surfaces_);
}

void ExampleKernel::gather_queries(std::uint32_t sample) {
  random_numbers(sample, dimension::pair_of(0, dimension::kLightPick), u0_, u1_);
  random_numbers(sample, dimension::pair_of(0, dimension::kLightPoint), u2_, u3_);
  // At most one query a pixel: eye end i is pixel i's surface, light end k the k-th light sample.
  queries_.eye.resize(rays_.size);
  queries_.resize_lights(rays_.size);
  queries_.resize_queries(rays_.size);
  contributions_.clear();
  const LightTable& lights = world_.lights();
  for (std::size_t i = 0; i < rays_.size; ++i) {
    const Vec3 direction = load(rays_.direction, i), wo = -direction;
    if (!hits_.hit(i)) {
      radiance_[i] = lights.environment(direction);
      continue;
    }
    // What the camera sees directly: the light that the surface itself emits.
    const Vec3 position = load(surfaces_.position, i), normal = load(surfaces_.geometric_normal, i);
    const SurfaceDetail detail = world_.detail(rays_, hits_, i, 0);
    const std::uint32_t own_light = surfaces_.light[i];
    radiance_[i] = own_light == kNoLight ? Color(0) : lights.emission(own_light, detail.texture, glm::dot(normal, wo) > 0);

    const LightSample light = lights.sample(position, normal, u0_[i], {u2_[i], u3_[i]});
    if (light.pdf <= 0) continue;
    const MaterialId material = surfaces_.material[i] == kDefaultMaterial ? MaterialId() : MaterialId(surfaces_.material[i]);
    const Bsdf bsdf = make_bsdf(world_.scene(), world_.textures(), material, detail.texture, u1_[i]);
    const Frame3 shading = perturb_frame(world_.scene(), world_.textures(), material, detail.texture, detail.frame, detail.dp_du,
                                         detail.dp_dv, detail.dn_du, detail.dn_dv, normal, wo);
    const Color value = bsdf.evaluate(shading.to_local(wo), shading.to_local(light.wi)).f_cos * light.radiance / light.pdf;
    if (is_black(value)) continue;

    // Cell areas of 0: we do not know how large a patch our samples stand for, so that a cache answers with a ray.
    const auto k = static_cast<std::uint32_t>(contributions_.size());
    const bool finite = std::isfinite(light.distance);
    queries_.eye.set(i, position, glm::dot(normal, wo) < 0 ? -normal : normal, surfaces_.error[i], 0, pixel_[i]);
    queries_.light.set(k, finite ? light.point : light.wi, light.normal, light.point_error, 0, sample);
    queries_.semantic[k] = static_cast<std::uint8_t>(finite ? QuerySemantic::surface : QuerySemantic::direction);
    queries_.eye_of[k] = static_cast<std::uint32_t>(i), queries_.light_of[k] = k;
    contributions_.push_back(value);
  }
  queries_.resize_queries(contributions_.size());
}

void ExampleKernel::add_results(std::uint32_t sample, Frame& frame, PassStatistics& statistics) {
  weights_.resize(padded(queries_.size));
  visibility_->visible(queries_, weights_, statistics.rays, statistics.visibility);
  for (std::size_t k = 0; k < queries_.size; ++k) radiance_[queries_.eye_of[k]] += weights_[k] * contributions_[k];
  for (std::size_t i = 0; i < rays_.size; ++i) frame.add_color(pixel_[i], sample, settings_.brightness * radiance_[i]);
}

}  // namespace sightline
