#include "methods/fragments/camera_pass.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/fragments/analytic_kind.h"
#include "shade/material_eval.h"

namespace sightline {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

CameraPass::CameraPass(const World& world, const View& view, std::uint64_t seed, int light_samples, Sampling sampling,
                       Visibility* visibility)
    : world_(world), view_(view), seed_(seed), sampling_(sampling), sampled_(world, view, light_samples, visibility) {
  has_mixes_ = std::ranges::any_of(world.scene().materials, [](const Material& m) { return std::holds_alternative<MixMaterial>(m.model); });
  for (auto* indices : {&pixel_, &key_, &sample_}) indices->resize(kBatch);
  for (auto* numbers : {&u0_, &u1_, &u2_, &u3_}) numbers->resize(kBatch);
  inside_.resize(kBatch), plain_.resize(kBatch);
  bsdf_.resize(kBatch), frame_.resize(kBatch), kind_.resize(kBatch), form_.resize(kBatch);
  light_.resize(kBatch);
  turned_geometric_.resize(kBatch), turned_shading_.resize(kBatch), albedo_.resize(kBatch), back_.resize(kBatch);
}

void CameraPass::render(std::size_t index, std::uint32_t sample, GBuffer& g, Vec3Batch& radiance, PassStatistics& statistics) {
  begin(index, static_cast<std::uint32_t>(index), g);
  const RootTile tile = g.root(index);
  // Camera rays travel in packets of 4 x 4 pixels, as the reference's do: an answer at a tie depends on the company a ray keeps.
  const auto flush = [&] {
    place(sample);
    finish(sample, index, g, radiance, statistics);
  };
  for (int by = tile.y0; by < tile.y1; by += kBlock) {
    for (int bx = tile.x0; bx < tile.x1; bx += kBlock) {
      block_at_[count_ / kLanes] = g.at(bx, by);
      for (int i = 0; i < static_cast<int>(kLanes); ++i, ++count_) {
        const int x = bx + i % kBlock, y = by + i / kBlock;
        inside_[count_] = x < tile.x1 && y < tile.y1;
        pixel_[count_] = static_cast<std::uint32_t>(std::min(y, tile.y1 - 1) * view_.width() + std::min(x, tile.x1 - 1));
        key_[count_] = pixel_key(seed_, pixel_[count_]);
      }
      if (count_ == kBatch) flush();
    }
  }
  flush();
}

void CameraPass::render(std::span<const CameraPlace> places, std::size_t index, std::uint32_t scope, GBuffer& g, Vec3Batch& radiance,
                        PassStatistics& statistics) {
  begin(index, scope, g);
  const RootTile tile = g.root(index);
  for (std::size_t first = 0; first < places.size(); first += kBatch) {
    const std::span some = places.subspan(first, std::min(kBatch, places.size() - first));
    count_ = padded(some.size());
    for (std::size_t i = 0; i < count_; ++i) {
      const CameraPlace& place = some[std::min(i, some.size() - 1)];
      if (i % kLanes == 0) {
        const auto block = static_cast<int>((first + i) / kLanes);
        block_at_[i / kLanes] = g.at(tile.x0 + block_x(block), tile.y0 + block_y(block));
      }
      inside_[i] = i < some.size();
      pixel_[i] = place.pixel, key_[i] = place.key, sample_[i] = place.sample, u0_[i] = place.u, u1_[i] = place.v;
    }
    finish(0, index, g, radiance, statistics);
  }
}

void CameraPass::begin(std::size_t index, std::uint32_t scope, GBuffer& g) {
  const RootTile tile = g.root(index);
  g.glossy[index].clear();
  for (int y = tile.y0; y < tile.y0 + kRootSize; ++y) std::fill_n(g.kind.data() + g.at(tile.x0, y), kRootSize, PixelKind::background);
  sampled_.begin(scope);
  count_ = 0;
}

// Where sample `sample` of each pixel goes through it.
void CameraPass::place(std::uint32_t sample) {
  std::fill_n(sample_.data(), count_, sample);
  sobol_2d(key_.data(), sample_.data(), dimension::kPixel, count_, u0_.data(), u1_.data());
}

void CameraPass::finish(std::uint32_t sample, std::size_t root, GBuffer& g, Vec3Batch& radiance, PassStatistics& statistics) {
  if (count_ == 0) return;
  trace(statistics);
  evaluate_materials();
  emit();
  to_sample_.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    const bool surface = kind_[i] != PixelKind::background && kind_[i] != PixelKind::dark;
    if (surface && hits_.hit(i) && (sampling_ == Sampling::all || kind_[i] == PixelKind::general || kind_[i] == PixelKind::emitter))
      to_sample_.push_back(i);
  }
  sampled_.shade({&rays_, &hits_, &surfaces_, &bsdf_, &frame_, plain_.data(), key_.data(), sample}, to_sample_, light_, statistics);
  write(root, g, radiance);
  count_ = 0;
}

void CameraPass::trace(PassStatistics& statistics) {
  rays_.resize(count_);
  if (view_.has_lens()) sobol_2d(key_.data(), sample_.data(), dimension::kLens, count_, u2_.data(), u3_.data());
  view_.primary_rays(pixel_.data(), u0_.data(), u1_.data(), u2_.data(), u3_.data(), count_,
                     {rays_.origin.x.data(), rays_.origin.y.data(), rays_.origin.z.data(), rays_.direction.x.data(),
                      rays_.direction.y.data(), rays_.direction.z.data()});
  for (std::size_t i = 0; i < count_; ++i) rays_.t_far[i] = inside_[i] ? kInfinity : -1.f;
  std::fill_n(rays_.t_near.data(), count_, 0.f);
  world_.tracer().intersect(rays_, hits_, BatchKind::primary, statistics.rays);
  world_.surfaces(rays_, hits_, surfaces_);
}

void CameraPass::evaluate_materials() {
  const Scene& scene = world_.scene();
  for (std::size_t i = 0; i < count_; ++i) {
    plain_[i] = hits_.hit(i) && surfaces_.plain[i];
    kind_[i] = plain_[i] ? PixelKind::diffuse : PixelKind::background;
    if (!hits_.hit(i) || plain_[i]) continue;
    const Vec3 wo = -load(rays_.direction, i), geometric = load(surfaces_.geometric_normal, i);
    const MaterialId id = surfaces_.material[i] == kDefaultMaterial ? MaterialId{} : MaterialId{surfaces_.material[i]};
    const SurfaceDetail detail = world_.detail(rays_, hits_, i, view_.cone_width() + view_.cone_spread() * hits_.t[i]);
    float u_mix = has_mixes_ ? sobol_2d(key_[i], sample_[i], dimension::pair_of(0, dimension::kLightPick)).y : 0.f;
    const MaterialId resolved = resolve_mix(scene, world_.textures(), id, detail.texture, u_mix);
    frame_[i] = perturb_frame(scene, world_.textures(), resolved, detail.texture, detail.frame, detail.dp_du, detail.dp_dv, detail.dn_du,
                              detail.dn_dv, geometric, wo);
    if (glm::dot(wo, frame_[i].normal) * glm::dot(wo, geometric) <= 0) frame_[i] = frame_from_normal_tangent(geometric, frame_[i].tangent);
    bsdf_[i] = make_bsdf(scene, world_.textures(), resolved, detail.texture, u_mix);
    form_[i] = sampling_ == Sampling::general ? analytic_form(bsdf_[i]) : std::nullopt;
    kind_[i] = kind_of(bsdf_[i], form_[i]);
  }
}

// Light that surfaces and the environment send to the camera by themselves.
void CameraPass::emit() {
  const LightTable& lights = world_.lights();
  fill(light_, 0, count_, Color(0));
  for (std::size_t i = 0; i < count_; ++i) {
    if (!inside_[i]) continue;
    const Vec3 direction = load(rays_.direction, i);
    if (!hits_.hit(i)) {
      if (lights.has_environment()) store(light_, i, lights.environment(direction));
      continue;
    }
    if (surfaces_.light[i] == kNoLight) continue;
    kind_[i] = PixelKind::emitter;
    TexturePoint texture;
    if (!surfaces_.plain[i]) texture = world_.detail(rays_, hits_, i, view_.cone_width() + view_.cone_spread() * hits_.t[i]).texture;
    store(light_, i, lights.emission(surfaces_.light[i], texture, glm::dot(load(surfaces_.geometric_normal, i), direction) < 0));
  }
}

// Blocks of 4 x 4 pixels, row by row. What lies outside the picture is background, whatever else is written there.
void CameraPass::write(std::size_t root, GBuffer& g, Vec3Batch& radiance) {
  const auto scatter = [&](std::size_t first, std::size_t at, const float* from, float* to) {
    for (int row = 0; row < kBlock; ++row)
      std::memcpy(to + at + static_cast<std::size_t>(row * g.stride), from + first + row * kBlock, kBlock * sizeof(float));
  };
  const auto scatter3 = [&](std::size_t first, std::size_t at, const Vec3Batch& from, Vec3Batch& to) {
    scatter(first, at, from.x.data(), to.x.data()), scatter(first, at, from.y.data(), to.y.data());
    scatter(first, at, from.z.data(), to.z.data());
  };
  turn_normals();
  for (std::size_t first = 0; first < count_; first += kLanes) {
    const std::size_t at = block_at_[first / kLanes];
    scatter3(first, at, light_, radiance), scatter3(first, at, surfaces_.position, g.position);
    scatter3(first, at, turned_geometric_, g.geometric_normal), scatter3(first, at, turned_shading_, g.shading_normal);
    scatter3(first, at, albedo_, g.albedo);
    scatter(first, at, surfaces_.error.data(), g.error.data()), scatter(first, at, hits_.t.data(), g.depth.data());
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t i = first + lane, to = at + lane % kBlock + lane / kBlock * static_cast<std::size_t>(g.stride);
      if (!inside_[i]) continue;
      g.kind[to] = kind_[i], g.back[to] = back_[i];
      if (kind_[i] != PixelKind::analytic) continue;
      g.glossy_index[to] = static_cast<std::uint32_t>(g.glossy[root].size());
      g.glossy[root].push_back({bsdf_[i], *form_[i], frame_[i], -load(rays_.direction, i)});
    }
  }
}

// Normals on the viewer's side, and albedos; shading normals give way where they do not see the camera on the side on which the geometric
// normal does. Hits at infinity for rays that hit nothing.
void CameraPass::turn_normals() {
  for (std::size_t i = 0; i < count_; ++i) {
    if (hits_.hit(i) && !plain_[i]) {
      store(surfaces_.shading_normal, i, frame_[i].normal);
      store(albedo_, i, bsdf_[i].albedo());
    } else {
      store(albedo_, i, load(surfaces_.albedo, i));
    }
    if (!hits_.hit(i)) hits_.t[i] = kInfinity;
  }
  for (std::size_t i = 0; i < count_; ++i) {
    const Vec3 direction = load(rays_.direction, i), geometric = load(surfaces_.geometric_normal, i);
    const Vec3 shading = load(surfaces_.shading_normal, i);
    const float by_geometric = glm::dot(direction, geometric), by_shading = glm::dot(direction, shading);
    const float side = by_geometric > 0 ? -1.f : 1.f;
    const bool usable = by_shading * by_geometric > 0;
    back_[i] = side < 0;
    store(turned_geometric_, i, side * geometric);
    store(turned_shading_, i, side * (usable ? shading : geometric));
  }
}

}  // namespace sightline
