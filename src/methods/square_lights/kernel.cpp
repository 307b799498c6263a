#include "methods/square_lights/kernel.h"

#include <algorithm>
#include <limits>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "shade/material_eval.h"

namespace sightline::square_lights {
namespace {

// A block of 4 x 4 pixels makes a packet of 16 rays.
constexpr int kBlock = 4;

bool all_simple(const Scene& scene, bool by_vertex) {
  if (!by_vertex || !scene.spheres.empty() || !scene.textures.empty()) return false;
  return std::ranges::all_of(scene.materials, [](const Material& m) { return is_black(m.emission.value); });
}

// Of a colour that is interpolated between vertices, what belongs to the place itself: its albedo by that which the vertices were lit with.
Color ratio(const Color& here, const Color& mean) {
  Color result(1);
  for (int c = 0; c < 3; ++c) result[c] = mean[c] > 1e-4f ? std::min(here[c] / mean[c], 10.f) : 1.f;
  return result;
}

}  // namespace

SquareKernel::SquareKernel(const World& world, const View& view, const SquareBake& bake, const FrameShading& shading,
                           std::span<const float> radiance, std::uint64_t seed)
    : world_(world),
      view_(view),
      bake_(bake),
      shading_(shading),
      radiance_(radiance),
      seed_(seed),
      simple_(all_simple(world.scene(), !radiance.empty())) {
  const auto most = static_cast<std::size_t>(Frame::kTileSize) * Frame::kTileSize;
  for (auto* numbers : {&pixel_, &key_, &index_}) numbers->resize(most);
  for (auto* numbers : {&u0_, &u1_, &u2_, &u3_}) numbers->resize(most);
  inside_.resize(most);
  rays_.resize(most), color_.resize(most);
  missed_.resize(most), missed_direction_.resize(most), missed_color_.resize(most);
}

void SquareKernel::render_tile(const Tile& tile, SampleRange samples, Frame& frame, PassStatistics& statistics) {
  count_ = 0;
  for (int y = tile.y0; y < tile.y1; y += kBlock) {
    for (int x = tile.x0; x < tile.x1; x += kBlock) {
      for (int lane = 0; lane < kBlock * kBlock; ++lane, ++count_) {
        const int px = x + lane % kBlock, py = y + lane / kBlock;
        inside_[count_] = px < tile.x1 && py < tile.y1;
        pixel_[count_] = static_cast<std::uint32_t>(std::min(py, tile.y1 - 1) * view_.width() + std::min(px, tile.x1 - 1));
        key_[count_] = pixel_key(seed_, pixel_[count_]);
      }
    }
  }
  bool aovs = false;
  for (const Aov aov : {Aov::albedo, Aov::normal, Aov::position, Aov::depth, Aov::surface, Aov::alpha}) aovs |= frame.aovs().has(aov);
  const bool direct = frame.aovs().has(Aov::direct);
  for (std::uint32_t sample = samples.begin; sample < samples.end; ++sample) {
    trace(tile, sample, statistics);
    const bool surfaces = !simple_ || aovs;
    if (surfaces) world_.surfaces(rays_, hits_, surfaces_);
    color_background();
    for (std::size_t i = 0; i < count_; ++i) {
      if (hits_.hit(i)) store(color_, i, simple_ ? vertex_color(i, Vec3(0)) : surface_color(i));
      if (aovs && inside_[i]) write_aovs(frame, i);
    }
    for (std::size_t at = 0; at < count_; at += kLanes) {
      const PixelBlock block{
          pixel_.data() + at, inside_.data() + at, sample, 1, {color_.x.data() + at, color_.y.data() + at, color_.z.data() + at}};
      if (direct) frame.add(Aov::direct, block);
      frame.add_color(block);
    }
  }
}

void SquareKernel::trace(const Tile&, std::uint32_t sample, PassStatistics& statistics) {
  std::fill_n(index_.begin(), count_, sample);
  sobol_2d(key_.data(), index_.data(), dimension::kPixel, count_, u0_.data(), u1_.data());
  if (view_.has_lens()) sobol_2d(key_.data(), index_.data(), dimension::kLens, count_, u2_.data(), u3_.data());
  rays_.size = count_;
  view_.primary_rays(pixel_.data(), u0_.data(), u1_.data(), u2_.data(), u3_.data(), count_,
                     {rays_.origin.x.data(), rays_.origin.y.data(), rays_.origin.z.data(), rays_.direction.x.data(),
                      rays_.direction.y.data(), rays_.direction.z.data()});
  std::fill_n(rays_.t_near.begin(), count_, 0.f);
  std::fill_n(rays_.t_far.begin(), count_, std::numeric_limits<float>::infinity());
  world_.tracer().intersect(rays_, hits_, BatchKind::primary, statistics.rays);
}

void SquareKernel::color_background() {
  std::size_t missed = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    missed_[missed] = static_cast<std::uint32_t>(i);
    missed += hits_.hit(i) ? 0 : 1;
  }
  if (missed == 0) return;
  if (missed == count_) {
    world_.lights().environment(rays_.direction, count_, color_);
    return;
  }
  for (std::size_t k = 0; k < missed; ++k) store(missed_direction_, k, load(rays_.direction, missed_[k]));
  world_.lights().environment(missed_direction_, missed, missed_color_);
  for (std::size_t k = 0; k < missed; ++k) store(color_, missed_[k], load(missed_color_, k));
}

Color SquareKernel::vertex_color(std::size_t i, const Vec3& position) const {
  const VertexHit hit = bake_.scene().vertices_of(hits_, i, position);
  Color sum(0);
  for (std::size_t k = 0; k < 3; ++k) {
    const float* c = radiance_.data() + std::size_t{hit.vertex[k]} * 4;
    sum += hit.weight[k] * Color(c[0], c[1], c[2]);
  }
  return sum;
}

Color SquareKernel::surface_color(std::size_t i) {
  const Vec3 position = load(surfaces_.position, i), normal = load(surfaces_.geometric_normal, i), direction = load(rays_.direction, i);
  const Vec3 wo = -direction;
  const std::uint32_t material = surfaces_.material[i];
  Color emitted(0);
  const bool textured = !world_.scene().textures.empty() && !surfaces_.plain[i];
  if (surfaces_.light[i] != kNoLight) {
    const SurfaceDetail detail = world_.detail(rays_, hits_, i, 0);
    emitted = world_.lights().emission(surfaces_.light[i], detail.texture, glm::dot(normal, wo) > 0);
  }
  const std::uint32_t object = bake_.scene().object_of(hits_.instance[i]);
  if (!radiance_.empty() && !textured) return emitted + vertex_color(i, position);

  const MaterialId id = material == kDefaultMaterial ? MaterialId() : MaterialId(material);
  const float distance = glm::length(position - load(rays_.origin, i));
  const SurfaceDetail detail = world_.detail(rays_, hits_, i, view_.cone_width() + distance * view_.cone_spread());
  const Color tint =
      textured ? ratio(make_bsdf(world_.scene(), world_.textures(), id, detail.texture, 0.5f).albedo(), bake_.table_albedo(material))
               : Color(1);
  if (!radiance_.empty()) return emitted + tint * vertex_color(i, position);
  const Frame3 frame = perturb_frame(world_.scene(), world_.textures(), id, detail.texture, detail.frame, detail.dp_du, detail.dp_dv,
                                     detail.dn_du, detail.dn_dv, normal, wo);
  return emitted +
         tint * shading_.shade_point(bake_.scene().vertices_of(hits_, i, position), object, material, position, frame, wo, scratch_);
}

void SquareKernel::write_aovs(Frame& frame, std::size_t i) {
  const std::uint32_t pixel = pixel_[i];
  if (!hits_.hit(i)) {
    frame.add(Aov::surface, pixel, Vec3(0, 0, 1));
    return;
  }
  const Vec3 position = load(surfaces_.position, i);
  const std::uint32_t material = surfaces_.material[i];
  const MaterialId id = material == kDefaultMaterial ? MaterialId() : MaterialId(material);
  Color albedo = load(surfaces_.albedo, i);
  if (!surfaces_.plain[i])
    albedo = make_bsdf(world_.scene(), world_.textures(), id, world_.detail(rays_, hits_, i, 0).texture, 0.5f).albedo();
  frame.add(Aov::albedo, pixel, albedo);
  frame.add(Aov::normal, pixel, load(surfaces_.shading_normal, i));
  frame.add(Aov::position, pixel, position);
  frame.add(Aov::depth, pixel, Vec3(glm::length(position - load(rays_.origin, i))));
  frame.add(Aov::surface, pixel, surfaces_.light[i] != kNoLight ? Vec3(0, 1, 0) : Vec3(1, 0, 0));
  frame.add(Aov::alpha, pixel, Vec3(1));
}

}  // namespace sightline::square_lights
