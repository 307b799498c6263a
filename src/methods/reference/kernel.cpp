#include "methods/reference/kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/reference/kernel_common.h"
#include "shade/material_eval.h"

namespace sightline {
namespace {

using dimension::pair_of;

// Which lanes are a surface, and which of those a plain one; true if all are.
bool classify(const std::uint32_t* __restrict instance, const std::uint8_t* __restrict is_plain, std::size_t count,
              std::uint8_t* __restrict shaded, std::uint8_t* __restrict plain) {
  unsigned others = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto hit = static_cast<std::uint8_t>(instance[i] != kNoHit);
    shaded[i] = hit, plain[i] = static_cast<std::uint8_t>(hit & is_plain[i]);
    others |= static_cast<unsigned>(hit & (is_plain[i] ^ 1));
  }
  return others == 0;
}

// A block of 4x4 pixels makes a packet of 16 rays.
constexpr int kBlockSize = 4;

// Upper left corners of the blocks that cover a tile.
std::vector<IVec2> blocks_of(const Tile& tile) {
  std::vector<IVec2> blocks;
  for (int y = tile.y0; y < tile.y1; y += kBlockSize) {
    for (int x = tile.x0; x < tile.x1; x += kBlockSize) blocks.emplace_back(x, y);
  }
  return blocks;
}

}  // namespace

PathKernel::PathKernel(const World& world, const View& view, const KernelOptions& options)
    : world_(world),
      view_(view),
      options_(options),
      medium_rays_(world),
      camera_medium_(medium_rays_.around_camera(view)),
      terminator_(world) {
  // Rays find the lights that are geometry or surround the scene. Without any, a BSDF ray of the last bounce cannot add light.
  bool emissive = world.lights().has_environment();
  for (const Material& material : world.scene().materials) emissive |= !is_black(material.emission.value);
  bsdf_sampling_finds_lights_ = emissive;

  in_picture_.resize(kBatch), pixel_.resize(kBatch), sample_.resize(kBatch), key_.resize(kBatch);
  direct_.resize(kBatch), indirect_.resize(kBatch);
  slot_.resize(kBatch), throughput_.resize(kBatch), bsdf_pdf_.resize(kBatch), previous_.resize(kBatch), previous_normal_.resize(kBatch);
  medium_.resize(kBatch), cone_width_.resize(kBatch), cone_spread_.resize(kBatch);
  bsdf_.resize(kBatch), frame_.resize(kBatch), shaded_.resize(kBatch), plain_.resize(kBatch);
  scratch_key_.resize(kBatch), scratch_index_.resize(kBatch), pdf_.resize(kBatch), u0_.resize(kBatch), u1_.resize(kBatch),
      u2_.resize(kBatch), u3_.resize(kBatch);
  light_position_.resize(kBatch), light_normal_.resize(kBatch), wi_.resize(kBatch);
  light_.resize(kBatch + kLanes);  // a run that begins inside a group is read in whole vectors
  // In place, each run of light samples takes whole groups of lanes: at least 8 samples, so at most twice as many lanes.
  shadow_.resize(kBatch), occluded_.resize(kBatch);
  if (options.visibility) {
    queries_ = std::make_unique<ShadowQueries>(world, view, *options.visibility, static_cast<float>(options.samples_a_pass),
                                               options.light_samples);
    // Queries are made of lanes in place, whatever the number of samples in a run.
    shadow_.resize(std::max(kBatch, kLanes * kLightChunk)), point_id_.resize(kBatch);
  }
}

void PathKernel::render_tile(const Tile& tile, SampleRange samples, Frame& frame, PassStatistics& statistics) {
  counts_ = {}, visibility_counts_ = {};
  if (queries_) queries_->begin_tile(static_cast<std::uint32_t>(tile.y0 * view_.width() + tile.x0));
  const std::vector<IVec2> blocks = blocks_of(tile);
  // A batch holds all samples of some blocks, or a part of the samples of one; sums are exact, so the split does not show.
  const std::uint32_t samples_a_batch = std::min<std::uint32_t>(samples.count(), kBatch / kLanes);
  const std::size_t blocks_a_batch = kBatch / kLanes / samples_a_batch;
  for (std::size_t first = 0; first < blocks.size(); first += blocks_a_batch) {
    const std::span some = std::span(blocks).subspan(first, std::min(blocks_a_batch, blocks.size() - first));
    for (std::uint32_t begin = samples.begin; begin < samples.end; begin += samples_a_batch) {
      start_paths(tile, some, {begin, std::min(begin + samples_a_batch, samples.end)});
      const std::uint32_t last = static_cast<std::uint32_t>(options_.max_bounces) + 1;
      for (std::uint32_t bounce = 0; bounce <= last && alive_ > 0; ++bounce) {
        trace(bounce);
        add_emission(bounce);
        if (bounce == 0) evaluate_materials(bounce), write_aovs(frame);
        if (bounce == last) break;
        if (bounce > 0) evaluate_materials(bounce);
        sample_lights(bounce);
        if (options_.one_hit || (bounce + 1 == last && !bsdf_sampling_finds_lights_)) break;
        scatter(bounce);
      }
      finish_paths(frame);
    }
  }
  statistics.rays += counts_;
  if (!queries_) visibility_counts_.queries = visibility_counts_.traced = counts_.occlusion;
  statistics.visibility += visibility_counts_;
}

// Every block of pixels has its samples side by side: the film takes them in one go.
void PathKernel::finish_paths(Frame& frame) {
  const auto channels = [](const Vec3Batch& batch, std::size_t at) {
    return std::array<const float*, 3>{batch.x.data() + at, batch.y.data() + at, batch.z.data() + at};
  };
  for (std::size_t at = 0; at < path_count_; at += samples_a_block_ * kLanes) {
    PixelBlock block{pixel_.data() + at, in_picture_.data() + at, sample_[at], static_cast<std::uint32_t>(samples_a_block_), {}};
    block.channel = channels(direct_, at), frame.add(Aov::direct, block);
    block.channel = channels(indirect_, at), frame.add(Aov::indirect, block);
  }
  const auto sum = [this](AlignedVector<float> Vec3Batch::* axis) {
    float* to = (direct_.*axis).data();
    const float* from = (indirect_.*axis).data();
    for (std::size_t i = 0; i < path_count_; ++i) to[i] += from[i];
  };
  sum(&Vec3Batch::x), sum(&Vec3Batch::y), sum(&Vec3Batch::z);
  for (std::size_t at = 0; at < path_count_; at += samples_a_block_ * kLanes)
    frame.add_color(
        {pixel_.data() + at, in_picture_.data() + at, sample_[at], static_cast<std::uint32_t>(samples_a_block_), channels(direct_, at)});
}

void PathKernel::start_paths(const Tile& tile, std::span<const IVec2> blocks, SampleRange samples) {
  // The packet that a camera ray travels in is made of its block and sample alone, whatever else is rendered with it.
  path_count_ = 0, samples_a_block_ = samples.count();
  for (const IVec2& block : blocks) {
    std::array<std::uint32_t, kLanes> pixel, key;
    std::array<std::uint8_t, kLanes> inside;
    for (int i = 0; i < static_cast<int>(kLanes); ++i) {
      const int x = block.x + i % kBlockSize, y = block.y + i / kBlockSize;
      inside[i] = x < tile.x1 && y < tile.y1;
      pixel[i] = static_cast<std::uint32_t>(std::min(y, tile.y1 - 1) * view_.width() + std::min(x, tile.x1 - 1));
      key[i] = pixel_key(options_.seed, pixel[i]);
    }
    for (std::uint32_t sample = samples.begin; sample < samples.end; ++sample, path_count_ += kLanes) {
      std::copy(pixel.begin(), pixel.end(), pixel_.begin() + static_cast<std::ptrdiff_t>(path_count_));
      std::copy(key.begin(), key.end(), key_.begin() + static_cast<std::ptrdiff_t>(path_count_));
      std::copy(inside.begin(), inside.end(), in_picture_.begin() + static_cast<std::ptrdiff_t>(path_count_));
      std::fill_n(sample_.begin() + static_cast<std::ptrdiff_t>(path_count_), kLanes, sample);
    }
  }
  alive_ = path_count_;
  rays_.resize(alive_);
  sobol_2d(key_.data(), sample_.data(), dimension::kPixel, alive_, u0_.data(), u1_.data());
  if (view_.has_lens()) sobol_2d(key_.data(), sample_.data(), dimension::kLens, alive_, u2_.data(), u3_.data());
  view_.primary_rays(pixel_.data(), u0_.data(), u1_.data(), u2_.data(), u3_.data(), alive_,
                     {rays_.origin.x.data(), rays_.origin.y.data(), rays_.origin.z.data(), rays_.direction.x.data(),
                      rays_.direction.y.data(), rays_.direction.z.data()});
  for (std::size_t i = 0; i < alive_; ++i) rays_.t_far[i] = in_picture_[i] ? kInfinity : -1.f;
  std::fill_n(rays_.t_near.data(), alive_, 0.f);
  std::iota(slot_.begin(), slot_.begin() + static_cast<std::ptrdiff_t>(alive_), 0u);
  fill(throughput_, 0, alive_, Color(1));
  fill(direct_, 0, alive_, Color(0)), fill(indirect_, 0, alive_, Color(0));
  std::fill_n(bsdf_pdf_.begin(), alive_, -1.f);
  std::fill_n(medium_.begin(), alive_, camera_medium_);
  std::fill_n(cone_width_.begin(), alive_, view_.cone_width()), std::fill_n(cone_spread_.begin(), alive_, view_.cone_spread());
}

void PathKernel::trace(std::uint32_t bounce) {
  world_.tracer().intersect(rays_, hits_, bounce == 0 ? BatchKind::primary : BatchKind::bounce, counts_);
  world_.surfaces(rays_, hits_, surfaces_);
  if (medium_rays_.media().any() || medium_rays_.media().any_interface()) travel();
  terminator_.apply(rays_, surfaces_, alive_);
}

void PathKernel::add_radiance(std::uint32_t slot, bool direct, const Color& value) { add(direct ? direct_ : indirect_, slot, value); }

// Beer-Lambert on the way, and on behind what only bounds a medium: that is no bounce.
void PathKernel::travel() {
  const std::span<const Color> left = medium_rays_.travel(rays_, hits_, surfaces_, std::span(medium_).first(alive_), counts_);
  for (std::size_t i = 0; i < alive_; ++i) store(throughput_, i, load(throughput_, i) * left[i]);
}

void PathKernel::add_emission(std::uint32_t bounce) {
  const LightTable& lights = world_.lights();
  for (std::size_t i = 0; i < alive_; ++i) {
    if (surfaces_.light[i] == kNoLight && (hits_.hit(i) || !lights.has_environment())) continue;
    const Vec3 direction = load(rays_.direction, i);
    if (!hits_.hit(i)) {
      if (!in_picture_[slot_[i]]) continue;
      float weight = 1;
      if (bsdf_pdf_[i] >= 0)
        weight = power_heuristic(bsdf_pdf_[i], static_cast<float>(options_.light_samples) *
                                                   lights.environment_pdf(previous_[i], previous_normal_[i], direction));
      add_radiance(slot_[i], bounce <= 1, load(throughput_, i) * lights.environment(direction) * weight);
      continue;
    }
    const Vec3 normal = load(surfaces_.geometric_normal, i);
    const bool front = glm::dot(normal, direction) < 0;
    TexturePoint texture;
    if (!surfaces_.plain[i]) texture = world_.detail(rays_, hits_, i, cone_width_[i] + cone_spread_[i] * hits_.t[i]).texture;
    const Color emission = lights.emission(surfaces_.light[i], texture, front);
    if (is_black(emission)) continue;
    float weight = 1;
    if (bsdf_pdf_[i] >= 0) {
      const float light_pdf =
          lights.pdf(previous_[i], previous_normal_[i], surfaces_.light[i], load(surfaces_.position, i), normal, direction);
      weight = power_heuristic(bsdf_pdf_[i], static_cast<float>(options_.light_samples) * light_pdf);
    }
    add_radiance(slot_[i], bounce <= 1, load(throughput_, i) * emission * weight);
  }
}

void PathKernel::evaluate_materials(std::uint32_t bounce) {
  const Scene& scene = world_.scene();
  bool mix = false;
  for (const Material& material : scene.materials) mix |= std::holds_alternative<MixMaterial>(material.model);
  if (mix) {
    gather_keys(bounce);
    sobol_2d(scratch_key_.data(), scratch_index_.data(), pair_of(bounce, dimension::kLightPick), alive_, u0_.data(), u1_.data());
  }
  all_plain_ = classify(hits_.instance.data(), surfaces_.plain.data(), alive_, shaded_.data(), plain_.data());
  if (all_plain_) return;
  for (std::size_t i = 0; i < alive_; ++i) {
    if (!shaded_[i] || plain_[i]) continue;  // the vector path needs no more than the surface says
    const Vec3 wo = -load(rays_.direction, i);
    const Vec3 geometric = load(surfaces_.geometric_normal, i);
    const MaterialId id = surfaces_.material[i] == kDefaultMaterial ? MaterialId{} : MaterialId{surfaces_.material[i]};
    const SurfaceDetail detail = world_.detail(rays_, hits_, i, cone_width_[i] + cone_spread_[i] * hits_.t[i]);
    float u_mix = mix ? u1_[i] : 0.f;
    const MaterialId resolved = resolve_mix(scene, world_.textures(), id, detail.texture, u_mix);
    frame_[i] = perturb_frame(scene, world_.textures(), resolved, detail.texture, detail.frame, detail.dp_du, detail.dp_dv, detail.dn_du,
                              detail.dn_dv, geometric, wo);
    // A shading normal that faces away from the viewer would make the surface black or transparent: fall back to the geometric one.
    if (glm::dot(wo, frame_[i].normal) * glm::dot(wo, geometric) <= 0) frame_[i] = frame_from_normal_tangent(geometric, frame_[i].tangent);
    bsdf_[i] = make_bsdf(scene, world_.textures(), resolved, detail.texture, u_mix);
    surfaces_.material[i] = resolved.valid() ? resolved.index : kDefaultMaterial;
  }
}

void PathKernel::write_aovs(Frame& frame) {
  if (frame.aovs().bits() == AovSet().bits()) return;
  for (std::size_t i = 0; i < alive_; ++i) {
    if (!hits_.hit(i)) continue;
    const std::uint32_t pixel = pixel_[slot_[i]];
    const Vec3 position = load(surfaces_.position, i);
    const bool emitter = surfaces_.light[i] != kNoLight;
    frame.add(Aov::albedo, pixel, plain_[i] ? load(surfaces_.albedo, i) : bsdf_[i].albedo());
    frame.add(Aov::normal, pixel, plain_[i] ? load(surfaces_.shading_normal, i) : frame_[i].normal);
    frame.add(Aov::position, pixel, position);
    frame.add(Aov::depth, pixel, Vec3(glm::length(position - load(rays_.origin, i))));
    frame.add(Aov::surface, pixel, emitter ? Vec3(0, 1, 0) : Vec3(1, 0, 0));
    frame.add(Aov::alpha, pixel, Vec3(1));
  }
}

void PathKernel::scatter(std::uint32_t bounce) {
  gather_keys(bounce);
  // Plain surfaces have one lobe; its number, and the roulette's, are drawn only where someone reads them.
  if (!all_plain_ || static_cast<int>(bounce) >= options_.roulette_start)
    sobol_2d(scratch_key_.data(), scratch_index_.data(), pair_of(bounce, dimension::kLobe), alive_, u0_.data(), u1_.data());
  sobol_2d(scratch_key_.data(), scratch_index_.data(), pair_of(bounce, dimension::kDirection), alive_, u2_.data(), u3_.data());

  sample_lambert({&rays_, &surfaces_, &throughput_}, u2_.data(), u3_.data(), alive_, wi_, pdf_.data());

  std::size_t kept = 0;
  for (std::size_t i = 0; i < alive_; ++i) {
    if (!shaded_[i]) continue;
    const Vec3 direction = load(rays_.direction, i);
    const Vec3 geometric = load(surfaces_.geometric_normal, i);
    const Vec3 position = load(surfaces_.position, i);
    const std::uint32_t material_index = surfaces_.material[i];
    const Material* material = material_index < world_.scene().materials.size() ? &world_.scene().materials[material_index] : nullptr;

    Vec3 wi;
    Color throughput = load(throughput_, i);
    float pdf = -1;
    bool crosses = false;
    if (plain_[i]) {
      if (!(pdf_[i] > 0)) continue;
      wi = load(wi_, i), pdf = pdf_[i];
      throughput *= load(surfaces_.albedo, i);
    } else if (material && std::holds_alternative<InterfaceMaterial>(material->model)) {
      // What a mixture has made an interface.
      wi = direction, pdf = bsdf_pdf_[i], crosses = true;
    } else {
      const Vec3 wo_local = frame_[i].to_local(-direction);
      const std::optional<BsdfSample> sample = bsdf_[i].sample(wo_local, u0_[i], {u2_[i], u3_[i]});
      if (!sample) continue;
      wi = frame_[i].to_world(sample->wi);
      crosses = glm::dot(wi, geometric) * glm::dot(-direction, geometric) < 0;
      if (crosses != sample->is_transmission) continue;
      throughput *= sample->weight;
      pdf = sample->is_delta ? -1.f : sample->pdf;
    }
    if (is_black(throughput)) continue;

    // Russian roulette on the throughput that remains.
    if (static_cast<int>(bounce) >= options_.roulette_start) {
      const float survival = std::min(0.95f, max_component(throughput));
      if (u1_[i] >= survival) continue;
      throughput /= survival;
    }

    // Everything of path i moves to place `kept` <= i; nothing of i is read after this.
    const float width = cone_width_[i] + cone_spread_[i] * hits_.t[i];
    MediumId medium = medium_[i];
    if (crosses && material) medium = glm::dot(wi, geometric) < 0 ? material->interior : MediumId{};
    slot_[kept] = slot_[i];
    store(throughput_, kept, throughput);
    bsdf_pdf_[kept] = pdf;
    const bool passes = material && std::holds_alternative<InterfaceMaterial>(material->model);
    previous_[kept] = passes ? previous_[i] : position;
    previous_normal_[kept] = passes ? previous_normal_[i] : geometric;
    medium_[kept] = medium;
    cone_width_[kept] = width;
    // A rough bounce blurs what lies behind it: a wider cone, coarser texture levels.
    cone_spread_[kept] = pdf < 0 ? cone_spread_[i] : std::max(cone_spread_[i], 0.25f);
    rays_.set(kept, {offset_origin(position, geometric, surfaces_.error[i], wi), 0, wi, kInfinity});
    ++kept;
  }
  alive_ = kept;
  rays_.size = kept;
}

}  // namespace sightline
