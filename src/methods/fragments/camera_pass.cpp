#include "methods/fragments/camera_pass.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/fragments/analytic_kind.h"
#include "methods/fragments/camera_lanes.h"
#include "shade/material_eval.h"

namespace sightline {
namespace {}  // namespace

CameraPass::CameraPass(const World& world, const View& view, std::uint64_t seed, int light_samples, Sampling sampling,
                       Visibility* visibility)
    : world_(world), view_(view), seed_(seed), sampling_(sampling), sampled_(world, view, light_samples, visibility) {
  has_mixes_ = std::ranges::any_of(world.scene().materials, [](const Material& m) { return std::holds_alternative<MixMaterial>(m.model); });
  for (auto* indices : {&pixel_, &key_, &sample_}) indices->resize(kBatch);
  for (auto* numbers : {&u0_, &u1_, &u2_, &u3_}) numbers->resize(kBatch);
  inside_.resize(kBatch), plain_.resize(kBatch);
  bsdf_.resize(kBatch), frame_.resize(kBatch), kind_.resize(kBatch), form_.resize(kBatch);
  light_.resize(kBatch), back_.resize(kBatch);
}

void CameraPass::render(std::size_t index, std::uint32_t sample, GBuffer& g, Vec3Batch& radiance, PassStatistics& statistics) {
  begin(index, static_cast<std::uint32_t>(index), g);
  const RootTile tile = g.root(index);
  // Camera rays travel in packets of 4 x 4 pixels, as the reference's do: an answer at a tie depends on the company a ray keeps.
  const auto flush = [&] {
    place(sample);
    finish(sample, index, g, radiance, statistics);
  };
  const int width = view_.width();
  for (int by = tile.y0; by < tile.y1; by += kBlock) {
    for (int bx = tile.x0; bx < tile.x1; bx += kBlock) {
      block_at_[count_ / kLanes] = g.at(bx, by);
      const bool whole = bx + kBlock <= tile.x1 && by + kBlock <= tile.y1;
      for (int i = 0; i < static_cast<int>(kLanes); ++i, ++count_) {
        const int x = bx + lane_x(i), y = by + lane_y(i);
        inside_[count_] = whole || (x < tile.x1 && y < tile.y1);
        pixel_[count_] = static_cast<std::uint32_t>(std::min(y, tile.y1 - 1) * width + std::min(x, tile.x1 - 1));
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
  for (std::size_t i = 0; i < count_; ++i) key_[i] = pixel_key(seed_, pixel_[i]);
  std::fill_n(sample_.data(), count_, sample);
  // Through the centre whatever the numbers are.
  if (view_.filter().kind() == PixelFilter::Kind::centre) return;
  sobol_2d(key_.data(), sample_.data(), dimension::kPixel, count_, u0_.data(), u1_.data());
}

void CameraPass::finish(std::uint32_t sample, std::size_t root, GBuffer& g, Vec3Batch& radiance, PassStatistics& statistics) {
  if (count_ == 0) return;
  trace(statistics);
  evaluate_materials();
  emit();
  to_sample_.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    const PixelKind kind = kind_[i];
    if (kind == PixelKind::background || kind == PixelKind::dark) continue;
    if ((sampling_ == Sampling::all || kind == PixelKind::general || kind == PixelKind::emitter) && hits_.hit(i)) to_sample_.push_back(i);
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
  unsigned others = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const bool hit = hits_.instance[i] != kNoHit, plain = hit & (surfaces_.plain[i] != 0);
    plain_[i] = plain;
    kind_[i] = plain ? PixelKind::diffuse : PixelKind::background;
    others |= static_cast<unsigned>(hit & !plain);
  }
  if (others == 0) return;
  for (std::size_t i = 0; i < count_; ++i) {
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
  const bool has_environment = lights.has_environment();
  for (std::size_t i = 0; i < count_; ++i) {
    if (surfaces_.light[i] == kNoLight && (!has_environment || hits_.hit(i))) continue;
    if (!inside_[i]) continue;
    const Vec3 direction = load(rays_.direction, i);
    if (!hits_.hit(i)) {
      store(light_, i, lights.environment(direction));
      continue;
    }
    kind_[i] = PixelKind::emitter;
    TexturePoint texture;
    if (!surfaces_.plain[i]) texture = world_.detail(rays_, hits_, i, view_.cone_width() + view_.cone_spread() * hits_.t[i]).texture;
    store(light_, i, lights.emission(surfaces_.light[i], texture, glm::dot(load(surfaces_.geometric_normal, i), direction) < 0));
  }
}

// Blocks of 4 x 4 pixels, array by array: one place in each of twenty arrays that lie a multiple of 4 KiB apart would throw the others out
// of the cache. What lies outside the picture is background, whatever else is written there.
void CameraPass::write(std::size_t root, GBuffer& g, Vec3Batch& radiance) {
  const std::size_t blocks = count_ / kLanes, stride = static_cast<std::size_t>(g.stride);
  const auto scatter = [&](const auto* from, auto* to) {
    for (std::size_t block = 0; block < blocks; ++block, from += kLanes) {
      auto* row = to + block_at_[block];
      for (int y = 0; y < kBlock; ++y, row += stride) std::memcpy(row, from + y * kBlock, kBlock * sizeof *from);
    }
  };
  const auto scatter3 = [&](const Vec3Batch& from, Vec3Batch& to) {
    scatter(from.x.data(), to.x.data()), scatter(from.y.data(), to.y.data()), scatter(from.z.data(), to.z.data());
  };
  bool lobes = false;
  for (std::size_t i = 0; i < count_; ++i) lobes |= kind_[i] == PixelKind::analytic;
  if (lobes) write_lobes(root, g);
  for (std::size_t i = 0; i < count_; ++i) {
    if (!hits_.hit(i) || plain_[i]) continue;
    store(surfaces_.shading_normal, i, frame_[i].normal), store(surfaces_.albedo, i, bsdf_[i].albedo());
  }
  turn_normals(rays_.direction, count_, surfaces_, hits_, back_.data());
  scatter3(light_, radiance), scatter3(surfaces_.position, g.position), scatter3(surfaces_.albedo, g.albedo);
  scatter3(surfaces_.geometric_normal, g.geometric_normal), scatter3(surfaces_.shading_normal, g.shading_normal);
  scatter(surfaces_.error.data(), g.error.data()), scatter(hits_.t.data(), g.depth.data());
  scatter(kind_.data(), g.kind.data()), scatter(back_.data(), g.back.data());
}

void CameraPass::write_lobes(std::size_t root, GBuffer& g) {
  for (std::size_t i = 0; i < count_; ++i) {
    if (!inside_[i] || kind_[i] != PixelKind::analytic) continue;
    const std::size_t lane = i % kLanes, to = block_at_[i / kLanes] + lane % kBlock + lane / kBlock * static_cast<std::size_t>(g.stride);
    g.glossy_index[to] = static_cast<std::uint32_t>(g.glossy[root].size());
    g.glossy[root].push_back({bsdf_[i], *form_[i], frame_[i], -load(rays_.direction, i)});
  }
}

}  // namespace sightline
