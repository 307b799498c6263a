#include "methods/visibility_cache/eye_paths.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/media.h"
#include "methods/shadow_terminator.h"
#include "methods/visibility_cache/ray_differential.h"
#include "shade/material_eval.h"

namespace sightline {
namespace {

using dimension::pair_of;

constexpr int kBlockSize = 4;             // a block of 4x4 pixels makes a packet of 16 rays
constexpr std::size_t kPathBatch = 1024;  // paths traced together, a multiple of kLanes
constexpr float kLeastCosine = 0.05f;     // grazing surfaces are not let grow without bound

// For `count` rays, keeping what is there: batches grow and shrink from wave to wave.
void reserve(RayBatch& rays, std::size_t count) {
  if (rays.t_far.size() < padded(count)) rays.resize(count);
}

// A shading normal that faces away from the viewer would make the surface black or transparent: it gives way to the geometric one.
bool sees_alike(const Vec3& shading, const Vec3& geometric, const Vec3& direction) {
  return glm::dot(direction, shading) * glm::dot(direction, geometric) > 0;
}

}  // namespace

struct EyePaths::Impl {
  /// What a branch of a path carries from one surface to the next.
  struct Branch {
    Color throughput{1};
    float radiance_scale = 1;  ///< product of the eta² by which refraction divided the throughput
    float cone_width = 0;
    std::uint32_t slot = 0, turns = 0;  ///< EyeSample::slot, branch
    MediumId medium;
    RayDifferential pixel, lens;
  };

  Impl(const World& w, const View& v, const EyePathOptions& o);

  void start(const Tile& tile, SampleRange range, TilePaths& paths);
  void start_rays(const TilePaths& paths, std::size_t count);
  void draw_mix_numbers(int depth, const TilePaths& paths);
  void visit(int depth, TilePaths& paths, Frame& frame);
  Branch first_branch(std::size_t i) const;
  void visit_plain_first_hit(std::size_t i, const TilePaths& paths, Frame& frame);
  void visit_surface(int depth, std::size_t i, Branch& branch, TilePaths& paths, Frame& frame);
  void follow(std::size_t i, const Branch& branch, const SurfaceDetail& detail, MaterialId material, const Frame3& shading,
              const BsdfSample& lobe, const Vec3& wi, std::uint32_t lobe_number);
  void add_sample(std::size_t i, float cross_section, const Frame3& shading, const Bsdf& bsdf, const Color& weight, const TilePaths& paths,
                  std::uint32_t slot, std::uint32_t turns, MediumId medium, MediumId beyond);
  float bounded(float area) const { return area > least_area_ ? std::min(area, largest_area_) : least_area_; }
  void write_aovs(std::size_t i, std::uint32_t pixel, const Color& albedo, const Vec3& normal, Frame& frame) const;
  void sort_by_path(std::size_t first_sample);

  const World& world_;
  const View& view_;
  EyePathOptions options_;
  bool mixes_ = false;
  bool shines_ = false;   ///< rays may meet a light or a background
  bool travels_ = false;  ///< there are media, or interfaces to pass
  float least_area_ = 0, largest_area_ = 0;

  void travel(int depth, RayCounts& rays);

  MediumRays medium_rays_;
  MediumId camera_medium_;
  ShadowTerminator terminator_;
  std::vector<MediumId> medium_;
  std::span<const Color> left_;  ///< by absorption on the way to each hit
  CameraDifferential camera_;
  std::size_t first_path_ = 0, path_count_ = 0;  ///< of the batch
  AlignedVector<std::uint32_t> path_key_;        ///< of the tile
  std::vector<Branch> branches_, next_branches_;
  RayBatch rays_, next_rays_;
  HitBatch hits_;
  SurfaceBatch surfaces_;
  AlignedVector<std::uint32_t> key_, index_;
  AlignedVector<float> u0_, u1_, u2_, u3_;
  std::vector<EyeSample>* samples_ = nullptr;
  std::vector<EyeSample> unsorted_;
  std::vector<std::uint32_t> begin_of_path_;
};

EyePaths::Impl::Impl(const World& w, const View& v, const EyePathOptions& o)
    : world_(w), view_(v), options_(o), medium_rays_(w), camera_medium_(medium_rays_.around_camera(v)), terminator_(w), camera_(v, 1) {
  travels_ = medium_rays_.media().any() || medium_rays_.media().any_interface();
  shines_ = world_.lights().has_environment();
  for (const Material& material : world_.scene().materials) {
    mixes_ |= std::holds_alternative<MixMaterial>(material.model);
    shines_ |= !is_black(material.emission.value);
  }
  const float radius = world_.bounds().half_diagonal();
  largest_area_ = radius * radius, least_area_ = 1e-12f * largest_area_;
  reserve(rays_, kPathBatch), u0_.resize(kPathBatch), u1_.resize(kPathBatch), u2_.resize(kPathBatch), u3_.resize(kPathBatch);
}

// All paths of the tile. The packet that a camera ray travels in is made of its block and sample alone.
void EyePaths::Impl::start(const Tile& tile, SampleRange range, TilePaths& paths) {
  const auto blocks = [](int from, int to) { return static_cast<std::size_t>((to - from + kBlockSize - 1) / kBlockSize); };
  paths.samples = range.count();
  paths.count = blocks(tile.x0, tile.x1) * blocks(tile.y0, tile.y1) * paths.samples * kLanes;
  paths.pixel.resize(paths.count), paths.sample.resize(paths.count), paths.inside.resize(paths.count), path_key_.resize(paths.count);
  paths.emitted.resize(paths.count);
  for (AlignedVector<float>* axis : {&paths.emitted.x, &paths.emitted.y, &paths.emitted.z}) std::fill(axis->begin(), axis->end(), 0.f);

  std::size_t at = 0;
  for (int y0 = tile.y0; y0 < tile.y1; y0 += kBlockSize) {
    for (int x0 = tile.x0; x0 < tile.x1; x0 += kBlockSize) {
      std::array<std::uint32_t, kLanes> pixel, key;
      std::array<std::uint8_t, kLanes> inside;
      for (int i = 0; i < static_cast<int>(kLanes); ++i) {
        const int x = x0 + i % kBlockSize, y = y0 + i / kBlockSize;
        inside[i] = x < tile.x1 && y < tile.y1;
        pixel[i] = static_cast<std::uint32_t>(std::min(y, tile.y1 - 1) * view_.width() + std::min(x, tile.x1 - 1));
        key[i] = pixel_key(options_.seed, pixel[i]);
      }
      for (std::uint32_t sample = range.begin; sample < range.end; ++sample, at += kLanes) {
        const auto to = static_cast<std::ptrdiff_t>(at);
        std::copy(pixel.begin(), pixel.end(), paths.pixel.begin() + to);
        std::copy(key.begin(), key.end(), path_key_.begin() + to);
        std::copy(inside.begin(), inside.end(), paths.inside.begin() + to);
        std::fill_n(paths.sample.begin() + to, kLanes, sample);
      }
    }
  }
}

// Camera rays of the batch.
void EyePaths::Impl::start_rays(const TilePaths& paths, std::size_t count) {
  path_count_ = rays_.size = count;
  const std::uint32_t *key = path_key_.data() + first_path_, *sample = paths.sample.data() + first_path_;
  sobol_2d(key, sample, dimension::kPixel, count, u0_.data(), u1_.data());
  if (view_.has_lens()) sobol_2d(key, sample, dimension::kLens, count, u2_.data(), u3_.data());
  view_.primary_rays(paths.pixel.data() + first_path_, u0_.data(), u1_.data(), u2_.data(), u3_.data(), count,
                     {rays_.origin.x.data(), rays_.origin.y.data(), rays_.origin.z.data(), rays_.direction.x.data(),
                      rays_.direction.y.data(), rays_.direction.z.data()});
  for (std::size_t i = 0; i < count; ++i) rays_.t_far[i] = paths.inside[first_path_ + i] ? kInfinity : -1.f;
  std::fill_n(rays_.t_near.data(), count, 0.f);
}

// Random numbers u1_ that resolve mix materials at this depth: the reference's.
void EyePaths::Impl::draw_mix_numbers(int depth, const TilePaths& paths) {
  const std::size_t count = rays_.size;
  for (AlignedVector<float>* u : {&u0_, &u1_}) u->resize(std::max(u->size(), padded(count)));
  const std::uint32_t pair = pair_of(static_cast<std::uint32_t>(depth), dimension::kLightPick);
  if (depth == 0) {
    sobol_2d(path_key_.data() + first_path_, paths.sample.data() + first_path_, pair, count, u0_.data(), u1_.data());
    return;
  }
  key_.resize(std::max(key_.size(), padded(count))), index_.resize(key_.size());
  for (std::size_t i = 0; i < count; ++i) key_[i] = path_key_[branches_[i].slot], index_[i] = paths.sample[branches_[i].slot];
  sobol_2d(key_.data(), index_.data(), pair, count, u0_.data(), u1_.data());
}

EyePaths::Impl::Branch EyePaths::Impl::first_branch(std::size_t i) const {
  Branch branch;
  branch.slot = static_cast<std::uint32_t>(first_path_ + i);
  branch.cone_width = view_.cone_width();
  return branch;
}

// The sample at hit i, made in place: copying what was just written would wait for it.
void EyePaths::Impl::add_sample(std::size_t i, float cross_section, const Frame3& shading, const Bsdf& bsdf, const Color& weight,
                                const TilePaths& paths, std::uint32_t slot, std::uint32_t turns, MediumId medium, MediumId beyond) {
  const Vec3 direction = load(rays_.direction, i), geometric = load(surfaces_.geometric_normal, i);
  const float cosine = glm::dot(direction, geometric);
  const float area = bounded(cross_section / std::fmax(std::fabs(cosine), kLeastCosine));
  const std::uint32_t path_id = hash_combine(path_key_[slot], paths.sample[slot]), id = turns == 0 ? path_id : hash_combine(path_id, turns);
  // A member more belongs into this list, at its place.
  static_assert(sizeof(EyeSample) ==
                3 * sizeof(Vec3) + sizeof(Frame3) + sizeof(Bsdf) + sizeof(Color) + 5 * sizeof(float) + 2 * sizeof(MediumId));
  samples_->emplace_back(load(surfaces_.position, i), cosine > 0 ? -geometric : geometric, -direction, shading, bsdf, weight,
                         surfaces_.error[i], area, slot, turns, id, medium, beyond);
}

void EyePaths::Impl::write_aovs(std::size_t i, std::uint32_t pixel, const Color& albedo, const Vec3& normal, Frame& frame) const {
  if (frame.aovs().bits() == AovSet().bits()) return;
  const Vec3 position = load(surfaces_.position, i);
  frame.add(Aov::albedo, pixel, albedo);
  frame.add(Aov::normal, pixel, normal);
  frame.add(Aov::position, pixel, position);
  frame.add(Aov::depth, pixel, Vec3(glm::length(position - load(rays_.origin, i))));
  frame.add(Aov::surface, pixel, surfaces_.light[i] != kNoLight ? Vec3(0, 1, 0) : Vec3(1, 0, 0));
  frame.add(Aov::alpha, pixel, Vec3(1));
}

// Untextured Lambert surfaces that the camera sees: the greater part of most pictures.
void EyePaths::Impl::visit_plain_first_hit(std::size_t i, const TilePaths& paths, Frame& frame) {
  const std::size_t path = first_path_ + i;
  const Vec3 direction = load(rays_.direction, i), geometric = load(surfaces_.geometric_normal, i);
  const Vec3 shading = load(surfaces_.shading_normal, i);
  const Color albedo = load(surfaces_.albedo, i);
  add_sample(i, camera_.cross_section(direction, hits_.t[i]),
             frame_from_normal(sees_alike(shading, geometric, direction) ? shading : geometric), Bsdf(Lambert{albedo}), Color(1), paths,
             static_cast<std::uint32_t>(path), 0, {}, {});
  write_aovs(i, paths.pixel[path], albedo, shading, frame);
}

// Any surface, at any depth.
void EyePaths::Impl::visit_surface(int depth, std::size_t i, Branch& branch, TilePaths& paths, Frame& frame) {
  const Scene& scene = world_.scene();
  const Vec3 direction = load(rays_.direction, i), geometric = load(surfaces_.geometric_normal, i), wo = -direction;
  const float t = hits_.t[i];
  if (travels_) branch.throughput *= left_[i], branch.medium = medium_[i];

  const bool plain = surfaces_.plain[i] != 0;
  SurfaceDetail detail;
  if (!plain) detail = world_.detail(rays_, hits_, i, branch.cone_width + view_.cone_spread() * t);
  if (surfaces_.light[i] != kNoLight) {
    const Color emission = world_.lights().emission(surfaces_.light[i], detail.texture, glm::dot(geometric, direction) < 0);
    add(paths.emitted, branch.slot, branch.throughput * emission);
  }
  if (depth > options_.max_depth) return;

  Frame3 shading;
  Bsdf bsdf;
  MaterialId material = surfaces_.material[i] == kDefaultMaterial ? MaterialId{} : MaterialId{surfaces_.material[i]};
  if (plain) {
    const Vec3 normal = load(surfaces_.shading_normal, i);
    shading = frame_from_normal(sees_alike(normal, geometric, direction) ? normal : geometric);
    bsdf = Bsdf(Lambert{load(surfaces_.albedo, i)});
    if (depth == 0) write_aovs(i, paths.pixel[branch.slot], load(surfaces_.albedo, i), normal, frame);
  } else {
    float u_mix = mixes_ ? u1_[i] : 0.f;
    material = resolve_mix(scene, world_.textures(), material, detail.texture, u_mix);
    shading = perturb_frame(scene, world_.textures(), material, detail.texture, detail.frame, detail.dp_du, detail.dp_dv, detail.dn_du,
                            detail.dn_dv, geometric, wo);
    if (!sees_alike(shading.normal, geometric, direction)) shading = frame_from_normal_tangent(geometric, shading.tangent);
    bsdf = make_bsdf(scene, world_.textures(), material, detail.texture, u_mix);
    if (depth == 0) write_aovs(i, paths.pixel[branch.slot], bsdf.albedo(), shading.normal, frame);
  }

  // The camera's differentials in closed form; made out only for those who go on.
  const bool lens = camera_.has_lens();
  if (!bsdf.is_delta()) {
    float cross_section = depth == 0 ? camera_.cross_section(direction, t) : branch.pixel.cross_section(direction, t);
    if (depth > 0 && lens) cross_section += branch.lens.cross_section(direction, t);
    const bool enters = glm::dot(direction, geometric) < 0;
    const MediumId beyond = enters && material.index < scene.materials.size() ? scene.materials[material.index].interior : MediumId{};
    add_sample(i, cross_section, shading, bsdf, branch.throughput, paths, branch.slot, branch.turns, branch.medium, beyond);
  }
  if (plain) return;
  const bool passes = is_interface(scene, material);
  const DeltaLobes lobes = passes ? DeltaLobes() : bsdf.delta_lobes(shading.to_local(wo));
  if (!passes && lobes.size() == 0) return;
  if (depth == 0) {
    branch.pixel = camera_.pixel(direction);
    if (lens) branch.lens = camera_.lens(direction);
  }
  branch.pixel = branch.pixel.transferred(direction, t, geometric);
  if (lens) branch.lens = branch.lens.transferred(direction, t, geometric);
  branch.cone_width += view_.cone_spread() * t;
  if (passes) {
    BsdfSample through;
    through.weight = Color(1), through.is_transmission = true;
    follow(i, branch, detail, material, shading, through, direction, 0);
    return;
  }
  for (std::size_t l = 0; l < lobes.size(); ++l) {
    const Vec3 wi = glm::normalize(shading.to_world(lobes[l].wi));
    follow(i, branch, detail, material, shading, lobes[l], wi, lobes[l].is_transmission ? 2 : 1);
  }
}

// A branch that leaves hit i along unit `wi`, if it carries enough.
void EyePaths::Impl::follow(std::size_t i, const Branch& branch, const SurfaceDetail& detail, MaterialId material, const Frame3& shading,
                            const BsdfSample& lobe, const Vec3& wi, std::uint32_t lobe_number) {
  const Vec3 direction = load(rays_.direction, i), geometric = load(surfaces_.geometric_normal, i);
  const float leaving = glm::dot(wi, geometric);
  const bool crosses = leaving * glm::dot(direction, geometric) > 0;
  if (crosses != lobe.is_transmission) return;
  Branch next = branch;
  next.throughput *= lobe.weight;
  next.radiance_scale *= lobe.eta * lobe.eta;
  const float weight = max_component(next.throughput);
  if (!(weight > 0) || weight * next.radiance_scale < options_.least_weight) return;

  const auto turn = [&](RayDifferential& d) {
    if (!lobe.is_transmission)
      d = reflected(d, direction, shading.normal, normal_change(detail, d));
    else if (lobe.eta != 1)
      d = refracted(d, direction, wi, shading.normal, lobe.eta, normal_change(detail, d));
  };
  turn(next.pixel);
  if (camera_.has_lens()) turn(next.lens);
  if (crosses && material.valid())
    next.medium =
        leaving < 0 && material.index < world_.scene().materials.size() ? world_.scene().materials[material.index].interior : MediumId{};
  if (lobe_number > 0) next.turns = hash_combine(branch.turns, lobe_number);
  const Vec3 origin = offset_origin(load(surfaces_.position, i), geometric, surfaces_.error[i], wi);
  next_rays_.set(next_branches_.size(), {origin, 0, wi, kInfinity});
  next_branches_.push_back(next);
}

// Beer-Lambert on the way, and on behind what only bounds a medium.
void EyePaths::Impl::travel(int depth, RayCounts& rays) {
  medium_.assign(rays_.size, camera_medium_);
  for (std::size_t i = 0; depth > 0 && i < rays_.size; ++i) medium_[i] = branches_[i].medium;
  left_ = medium_rays_.travel(rays_, hits_, surfaces_, medium_, rays);
}

// All rays of a wave.
void EyePaths::Impl::visit(int depth, TilePaths& paths, Frame& frame) {
  const LightTable& lights = world_.lights();
  const bool background = lights.has_environment();
  next_branches_.clear();
  bool ready = false;
  for (std::size_t i = 0; i < rays_.size; ++i) {
    if (!hits_.hit(i)) {
      const std::size_t path = depth == 0 ? first_path_ + i : branches_[i].slot;
      if (!background || !paths.inside[path]) continue;
      Color radiance = lights.environment(load(rays_.direction, i));
      if (travels_) radiance *= left_[i];
      add(paths.emitted, path, depth == 0 ? radiance : branches_[i].throughput * radiance);
      continue;
    }
    if (depth == 0 && surfaces_.plain[i] && surfaces_.light[i] == kNoLight && !travels_) {
      visit_plain_first_hit(i, paths, frame);
      continue;
    }
    if (!ready) {
      // Only now is it clear that somebody needs these.
      if (mixes_) draw_mix_numbers(depth, paths);
      reserve(next_rays_, 2 * rays_.size);
      ready = true;
    }
    if (depth == 0) {
      Branch branch = first_branch(i);
      visit_surface(depth, i, branch, paths, frame);
    } else {
      visit_surface(depth, i, branches_[i], paths, frame);
    }
  }
  next_rays_.size = next_branches_.size();
}

// The waves of a batch found each path's samples one after the other: brings together what belongs to a path.
void EyePaths::Impl::sort_by_path(std::size_t first_sample) {
  begin_of_path_.assign(path_count_ + 1, 0);
  unsorted_.assign(samples_->begin() + static_cast<std::ptrdiff_t>(first_sample), samples_->end());
  for (const EyeSample& sample : unsorted_) ++begin_of_path_[sample.slot - first_path_ + 1];
  for (std::size_t i = 1; i <= path_count_; ++i) begin_of_path_[i] += begin_of_path_[i - 1];
  for (const EyeSample& sample : unsorted_) (*samples_)[first_sample + begin_of_path_[sample.slot - first_path_]++] = sample;
}

EyePaths::EyePaths(const World& world, const View& view, const EyePathOptions& options)
    : impl_(std::make_unique<Impl>(world, view, options)) {}
EyePaths::~EyePaths() = default;

void EyePaths::trace(const Tile& tile, SampleRange range, std::uint32_t pass_samples, TilePaths& paths, std::vector<EyeSample>& eye_samples,
                     Frame& frame, RayCounts& rays) {
  Impl& impl = *impl_;
  impl.camera_ = CameraDifferential(impl.view_, pass_samples);
  impl.samples_ = &eye_samples;
  eye_samples.clear();
  impl.start(tile, range, paths);
  for (impl.first_path_ = 0; impl.first_path_ < paths.count; impl.first_path_ += kPathBatch) {
    impl.start_rays(paths, std::min(kPathBatch, paths.count - impl.first_path_));
    const std::size_t first_sample = eye_samples.size();
    std::size_t after_first_wave = first_sample;
    const int last = impl.options_.max_depth + (impl.shines_ ? 1 : 0);
    for (int depth = 0; depth <= last && impl.rays_.size > 0; ++depth) {
      impl.world_.tracer().intersect(impl.rays_, impl.hits_, depth == 0 ? BatchKind::primary : BatchKind::bounce, rays);
      impl.world_.surfaces(impl.rays_, impl.hits_, impl.surfaces_);
      if (impl.travels_) impl.travel(depth, rays);
      impl.terminator_.apply(impl.rays_, impl.surfaces_, impl.rays_.size);
      impl.visit(depth, paths, frame);
      std::swap(impl.branches_, impl.next_branches_), std::swap(impl.rays_, impl.next_rays_);
      if (depth == 0) after_first_wave = eye_samples.size();
    }
    reserve(impl.rays_, kPathBatch);
    if (eye_samples.size() > after_first_wave) impl.sort_by_path(first_sample);
  }
}

}  // namespace sightline
