#include "methods/visibility_cache/kernel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/math/vec3_batch.h"
#include "base/sample/sobol.h"
#include "methods/visibility_cache/pixel_order.h"

namespace sightline {
namespace {

// Light samples worked off at a time: they, their ends and their answers stay in the L2 cache beside the visibility's table. Without a
// table there is room for more, and the more eye points share a light, the better its rays trace together.
constexpr std::size_t kShadowBatch = 4096, kExactBatch = 16384;
// Directions of the environment from which each of an eye point's samples is chosen. To draw one anew costs several reads of tables far
// larger than the L2 cache; a tile's set stays in it, and its ends are shared by many queries.
constexpr std::uint32_t kSkyChoices = 64;

using dimension::pair_of;

void copy(const Vec3Batch& from, std::size_t count, Vec3Batch& to) {
  std::copy_n(from.x.data(), count, to.x.data());
  std::copy_n(from.y.data(), count, to.y.data());
  std::copy_n(from.z.data(), count, to.z.data());
}
std::uint8_t byte(QuerySemantic semantic) { return static_cast<std::uint8_t>(semantic); }

}  // namespace

EyeLights::EyeLights(const LightTable& table)
    : area(table.subset(LightSubset::kArea)),
      environment(table.subset(LightSubset::kEnvironment)),
      punctual(table.subset(LightSubset::kPunctual).entries),
      area_of_entry(table.size(), 0.f) {
  for (const std::uint32_t light : area.entries) area_of_entry[light] = table.area(light) / area.choice.probability(light);
}

EyeKernel::EyeKernel(const World& world, const View& view, Visibility& visibility, const VisibilityCacheSettings& settings,
                     const Context& context, const EyeLights& lights)
    : world_(world),
      settings_(settings),
      seed_(context.seed),
      context_(context),
      lights_(lights),
      first_segment_(visibility.cluster_edge() * visibility.cluster_edge()),
      eye_paths_(world, view, {settings.specular_depth, settings.least_weight, context.seed}),
      absorption_(world),
      worker_(visibility.worker()) {}

void EyeKernel::render_tile(const Tile& tile, SampleRange range, const EyePass& pass, Frame& frame, PassStatistics& statistics) {
  // First-hit layers go to the frame with the eye paths: then the tile must be finished.
  AovSet late;
  for (const Aov aov : {Aov::direct, Aov::indirect, Aov::variance}) late.add(aov);
  may_stop_ = (frame.aovs().bits() & ~late.bits()) == 0;
  eye_paths_.trace(tile, range, pass.samples, paths_, eye_samples_, frame, statistics.rays);
  for (EyeSample& e : eye_samples_) e.bsdf.prepare(e.frame.to_local(e.wo));
  worker_->begin(tile.index);
  spatial_order_ = worker_->exact();
  put_in_order(tile);
  direct_.resize(paths_.count), indirect_.resize(paths_.count);
  fill(direct_, 0, paths_.count, Color(0)), fill(indirect_, 0, paths_.count, Color(0));
  if (!lights_.punctual.empty()) in_chunks(lights_.punctual.size(), [&](EyeRange chunk) { shade_punctual(chunk, statistics); });
  const auto n = static_cast<std::size_t>(pass.light_samples);
  if (!lights_.area.empty()) in_chunks(n, [&](EyeRange chunk) { shade_area(chunk, pass, statistics); });
  if (!lights_.environment.empty()) draw_environment(tile, range, pass);
  if (!lights_.environment.empty()) in_chunks(n, [&](EyeRange chunk) { shade_environment(chunk, pass, statistics); });
  if (pass.virtual_lights.size > 0) in_chunks(pass.virtual_lights.size, [&](EyeRange chunk) { shade_virtual(chunk, pass, statistics); });
  write(frame);
}

// Sample by sample, and within a sample in the pixels' order: the first sample of all pixels is spread out, later ones find its answers.
void EyeKernel::put_in_order(const Tile& tile) {
  order_.resize(eye_samples_.size());
  if (spatial_order_) return std::iota(order_.begin(), order_.end(), 0u);
  const IVec2 size(tile.x1 - tile.x0, tile.y1 - tile.y0);
  const auto pixels = static_cast<std::size_t>(tile.pixel_count());
  if (ranked_size_ != size) {
    const double first = std::max(1.0, static_cast<double>(pixels) / static_cast<double>(first_segment_));
    const std::vector<std::uint32_t> order = settings_.order == VisibilityCacheSettings::Order::scanline
                                                 ? scanline_order(size.x, size.y)
                                                 : halton_order(size.x, size.y, first, static_cast<double>(settings_.order_growth));
    rank_.resize(pixels);
    for (std::uint32_t i = 0; i < pixels; ++i) rank_[order[i]] = i;
    ranked_size_ = size;
  }
  // Counting sort; stable, so that a path's branches keep their order.
  const auto bucket_of = [&](const EyeSample& eye) {
    const auto lane = static_cast<int>(eye.slot % kLanes);
    const auto group = static_cast<int>(eye.slot / kLanes);
    const int sample = group % static_cast<int>(paths_.samples), block = group / static_cast<int>(paths_.samples);
    const int blocks_x = (size.x + 3) / 4;
    const int x = block % blocks_x * 4 + lane % 4, y = block / blocks_x * 4 + lane / 4;
    const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x);
    return static_cast<std::size_t>(sample) * pixels + rank_[pixel];
  };
  bucket_.assign(pixels * paths_.samples + 1, 0);
  for (const EyeSample& eye : eye_samples_) ++bucket_[bucket_of(eye) + 1];
  std::partial_sum(bucket_.begin(), bucket_.end(), bucket_.begin());
  for (std::uint32_t i = 0; i < eye_samples_.size(); ++i) order_[bucket_[bucket_of(eye_samples_[i])]++] = i;
}

template <class Shade>
void EyeKernel::in_chunks(std::size_t per_eye, Shade shade) {
  const std::size_t chunk = std::clamp<std::size_t>((spatial_order_ ? kExactBatch : kShadowBatch) / per_eye, 1, 1024);
  contributions_.resize(chunk * per_eye);
  weights_.resize(padded(chunk * per_eye) + kLanes);
  for (auto* numbers : {&u0_, &u1_, &u2_}) numbers->resize(padded(chunk * per_eye));
  for (auto* numbers : {&key_, &index_, &entry_}) numbers->resize(padded(chunk * per_eye));
  position_.resize(chunk * per_eye), normal_.resize(chunk * per_eye);
  light_.resize(chunk * per_eye + kLanes);  // runs that begin anywhere are read in whole vectors
  for (std::size_t begin = 0; begin < order_.size(); begin += chunk) {
    if (may_stop_) context_.check_cancelled();
    shade({begin, std::min(begin + chunk, order_.size())});
  }
}

void EyeKernel::set_eye_ends(EyeRange chunk) {
  queries_.eye.resize(chunk.second - chunk.first);
  chunk_slot_.resize(queries_.eye.size);
  if (absorption_.any()) absorption_.begin(queries_.eye.size);
  for (std::size_t k = chunk.first; k < chunk.second; ++k) {
    const EyeSample& e = eye(k);
    queries_.eye.set(k - chunk.first, e.position, e.geometric_normal, e.error, e.area, e.id);
    chunk_slot_[k - chunk.first] = e.slot;
    if (absorption_.any()) absorption_.set_eye(k - chunk.first, e);
  }
}

// Random numbers, positions and normals for `per_eye` light samples a point: a pixel's samples continue one sequence.
void EyeKernel::draw_numbers(EyeRange chunk, std::size_t per_eye, std::uint32_t first_pair) {
  std::size_t lane = 0;
  for (std::size_t k = chunk.first; k < chunk.second; ++k, lane += per_eye) {
    const EyeSample& e = eye(k);
    std::uint32_t key = pixel_key(seed_, paths_.pixel[e.slot]);
    if (e.branch != 0) key = hash_combine(key, e.branch);
    std::fill_n(key_.data() + lane, per_eye, key);
    std::iota(index_.data() + lane, index_.data() + lane + per_eye, paths_.sample[e.slot] * static_cast<std::uint32_t>(per_eye));
    fill(position_, lane, per_eye, e.position);
    fill(normal_, lane, per_eye, e.geometric_normal);
  }
  sobol_2d(key_.data(), index_.data(), first_pair + dimension::kLightPoint, lane, u0_.data(), u1_.data());
  sobol_1d(key_.data(), index_.data(), first_pair + dimension::kLightPick, lane, u2_.data());
}

// All of them are asked: their ends are shared by the whole chunk.
void EyeKernel::shade_punctual(EyeRange chunk, PassStatistics& statistics) {
  const std::size_t count = lights_.punctual.size(), eyes = chunk.second - chunk.first;
  for (std::size_t k = 0; k < eyes; ++k) {
    std::copy(lights_.punctual.begin(), lights_.punctual.end(), entry_.data() + k * count);
    fill(position_, k * count, count, eye(chunk.first + k).position);
  }
  std::fill_n(u0_.data(), eyes * count, 0.5f), std::fill_n(u1_.data(), eyes * count, 0.5f);
  std::fill_n(u2_.data(), eyes * count, 1.f);  // the probability of each choice
  world_.lights().sample_entries(entry_, u2_, position_, u0_, u1_, eyes * count, light_);
  contributions_.size = 0;
  for (std::size_t k = 0; k < eyes; ++k)
    add_samples(eye(chunk.first + k), static_cast<std::uint32_t>(k), light_, k * count, count, 0, {}, contributions_);

  set_eye_ends(chunk);
  queries_.resize_lights(count);
  for (std::size_t j = 0; j < count; ++j) {
    // The first eye point's samples tell where each light is.
    const bool infinite = std::isinf(light_.distance[j]);
    queries_.light.set(j, infinite ? load(light_.wi, j) : load(light_.point, j), Vec3(0), light_.point_error[j], 0,
                       static_cast<std::uint32_t>(j));
    queries_.semantic[j] = byte(infinite ? QuerySemantic::direction : QuerySemantic::point);
  }
  queries_.kind = BatchKind::shadow;
  queries_.importance.clear();  // one light, one cell: a light that outshines others at one point does so at its neighbours
  ask(direct_, true, statistics);
}

void EyeKernel::shade_area(EyeRange chunk, const EyePass& pass, PassStatistics& statistics) {
  const auto n = static_cast<std::size_t>(pass.light_samples);
  const std::size_t eyes = chunk.second - chunk.first, lanes = eyes * n;
  draw_numbers(chunk, n, pair_of(0, dimension::kLightPick));
  world_.lights().sample(lights_.area, position_, normal_, u2_, u0_, u1_, lanes, light_);
  const SampleWeights weights{1 / static_cast<float>(n), 0, 0};
  contributions_.size = 0;
  for (std::size_t k = 0; k < eyes; ++k)
    add_samples(eye(chunk.first + k), static_cast<std::uint32_t>(k), light_, k * n, n, static_cast<std::uint32_t>(k * n), weights,
                contributions_);

  set_eye_ends(chunk);
  queries_.resize_lights(lanes);
  copy(light_.point, lanes, queries_.light.position);
  copy(light_.normal, lanes, queries_.light.normal);
  std::copy_n(light_.point_error.data(), lanes, queries_.light.error.data());
  std::fill_n(queries_.semantic.data(), lanes, byte(QuerySemantic::surface));
  std::copy_n(index_.data(), lanes, queries_.light.id.data());
  // N_S / (N_P P(p_l)): the light's area, shared out among its samples.
  for (std::size_t i = 0; i < lanes; ++i) {
    const std::uint32_t light = light_.light[i];
    queries_.light.cell_area[i] = light < lights_.area_of_entry.size() ? lights_.area_of_entry[light] * weights.scale : 0.f;
  }
  queries_.kind = BatchKind::shadow;
  queries_.surface_ends = SurfaceEnds::area_light;
  compute_importance();
  ask(direct_, false, statistics);
}

// A set of directions for the tile and these samples alone, drawn like any others: choosing one of them at random leaves each sample's
// density what it is.
void EyeKernel::draw_environment(const Tile& tile, SampleRange range, const EyePass& pass) {
  const auto count = static_cast<std::size_t>(pass.light_samples - environment_bsdf_samples(pass)) * kSkyChoices;
  key_.resize(padded(count)), index_.resize(padded(count));
  for (auto* numbers : {&u0_, &u1_, &u2_}) numbers->resize(padded(count));
  position_.resize(count), normal_.resize(count);
  std::fill_n(key_.data(), count, hash_combine(pixel_key(seed_, tile.index), hash32(range.begin ^ 0x5bd1e995u)));
  std::iota(index_.data(), index_.data() + count, 0u);
  sobol_2d(key_.data(), index_.data(), pair_of(1, dimension::kLightPoint), count, u0_.data(), u1_.data());
  fill(position_, 0, count, Vec3(0)), fill(normal_, 0, count, Vec3(0));
  world_.lights().sample(lights_.environment, position_, normal_, u2_, u0_, u1_, count, sky_);
  sky_size_ = count;
}

int EyeKernel::environment_bsdf_samples(const EyePass& pass) const {
  return static_cast<int>(std::floor(settings_.bsdf_share * static_cast<float>(pass.light_samples)));
}

// The environment's samples and the BSDF's, weighted against each other by the balance heuristic. Cells follow the density of both, with
// that of the BSDF taken as uniform over the hemisphere: keys of neighbours must not depend on where a lobe points.
void EyeKernel::shade_environment(EyeRange chunk, const EyePass& pass, PassStatistics& statistics) {
  const auto n = static_cast<std::size_t>(pass.light_samples), of_bsdf = static_cast<std::size_t>(environment_bsdf_samples(pass));
  const std::size_t of_light = n - of_bsdf, eyes = chunk.second - chunk.first;
  draw_numbers(chunk, n, pair_of(1, dimension::kLightPick));
  const SampleWeights weights{1 / static_cast<float>(of_light), static_cast<float>(of_light), static_cast<float>(of_bsdf)};
  light_.resize(n + kLanes);
  set_eye_ends(chunk);
  queries_.resize_lights(sky_size_ + eyes * of_bsdf);
  copy(sky_.wi, sky_size_, queries_.light.position);
  // Cells of both techniques' density.
  const float uniform = static_cast<float>(of_bsdf) / (2 * kPi);
  const auto cell_of = [&](float light_pdf) { return 1 / (static_cast<float>(of_light) * light_pdf + uniform + 1e-20f); };
  for (std::size_t i = 0; i < sky_size_; ++i) queries_.light.cell_area[i] = cell_of(sky_.pdf[i]);

  contributions_.size = 0;
  for (std::size_t k = 0; k < eyes; ++k) {
    const EyeSample& e = eye(chunk.first + k);
    const auto eye_index = static_cast<std::uint32_t>(k);
    const std::size_t first = k * n;
    // One direction of each group of kSkyChoices, gathered side by side.
    for (std::size_t i = 0; i < of_light; ++i) {
      const auto choice = static_cast<std::size_t>(u2_[first + i] * static_cast<float>(kSkyChoices));
      const std::size_t from = i + of_light * std::min<std::size_t>(choice, kSkyChoices - 1);
      entry_[i] = static_cast<std::uint32_t>(from);
      light_.wi.x[i] = sky_.wi.x[from], light_.wi.y[i] = sky_.wi.y[from], light_.wi.z[i] = sky_.wi.z[from];
      light_.radiance.x[i] = sky_.radiance.x[from], light_.radiance.y[i] = sky_.radiance.y[from];
      light_.radiance.z[i] = sky_.radiance.z[from], light_.pdf[i] = sky_.pdf[from];
    }
    const std::size_t before = contributions_.size;
    add_samples(e, eye_index, light_, 0, of_light, 0, weights, contributions_);
    for (std::size_t c = before; c < contributions_.size; ++c) contributions_.light[c] = entry_[contributions_.light[c]];
    for (std::size_t i = 0; i < of_bsdf; ++i) {
      const std::size_t lane = first + of_light + i, end = sky_size_ + k * of_bsdf + i;
      add_bsdf_sample(e, eye_index, u2_[lane], {u0_[lane], u1_[lane]}, weights, end, cell_of);
    }
  }
  fill(queries_.light.normal, 0, queries_.light.size, Vec3(0));
  std::fill_n(queries_.light.error.data(), queries_.light.size, 0.f);
  std::fill_n(queries_.semantic.data(), queries_.light.size, byte(QuerySemantic::solid_angle));
  std::iota(queries_.light.id.data(), queries_.light.id.data() + queries_.light.size, static_cast<std::uint32_t>(chunk.first));
  queries_.kind = BatchKind::shadow_diffuse;
  compute_importance();
  ask(direct_, false, statistics);
}

// A direction that the BSDF draws, as light end `end`.
template <class CellOf>
void EyeKernel::add_bsdf_sample(const EyeSample& e, std::uint32_t eye_index, float u_lobe, const Vec2& u, const SampleWeights& weights,
                                std::size_t end, CellOf cell_of) {
  QueryEnds& ends = queries_.light;
  ends.position.x[end] = ends.position.y[end] = 0, ends.position.z[end] = 1, ends.cell_area[end] = 0;
  const std::optional<BsdfSample> sample = e.bsdf.sample(e.frame.to_local(e.wo), u_lobe, u);
  if (!sample || sample->is_delta) return;
  const Vec3 wi = e.frame.to_world(sample->wi);
  if ((glm::dot(wi, e.geometric_normal) * glm::dot(e.wo, e.geometric_normal) < 0) != sample->is_transmission) return;
  const float light_pdf = world_.lights().environment_density(wi);
  const float share = sample->pdf / (weights.mis_bsdf * sample->pdf + weights.mis_light * light_pdf);
  const Color value = e.weight * sample->weight * world_.lights().environment(wi) * share;
  if (!(max_component(value) > 0)) return;
  ends.position.x[end] = wi.x, ends.position.y[end] = wi.y, ends.position.z[end] = wi.z, ends.cell_area[end] = cell_of(light_pdf);
  const std::size_t at = contributions_.size++;
  contributions_.color.x[at] = value.x, contributions_.color.y[at] = value.y, contributions_.color.z[at] = value.z;
  contributions_.eye[at] = eye_index, contributions_.light[at] = static_cast<std::uint32_t>(end);
}

void EyeKernel::shade_virtual(EyeRange chunk, const EyePass& pass, PassStatistics& statistics) {
  const VirtualPointLights& lights = pass.virtual_lights;
  contributions_.size = 0;
  set_eye_ends(chunk);
  send_radiance(lights, pass.general_virtual_lights, queries_.eye.position, queries_.eye.size, sent_);
  for (std::size_t k = chunk.first; k < chunk.second; ++k)
    add_virtual_lights(eye(k), static_cast<std::uint32_t>(k - chunk.first), lights, pass.general_virtual_lights, sent_, contributions_);

  queries_.resize_lights(lights.size);
  copy(lights.position, lights.size, queries_.light.position);
  copy(lights.normal, lights.size, queries_.light.normal);
  std::copy_n(lights.error.data(), lights.size, queries_.light.error.data());
  for (std::size_t j = 0; j < lights.size; ++j) queries_.light.cell_area[j] = lights.cell_area[j] * settings_.vpl_spread;
  std::iota(queries_.light.id.data(), queries_.light.id.data() + lights.size, 0u);
  std::fill_n(queries_.semantic.data(), lights.size, byte(QuerySemantic::surface));
  queries_.kind = BatchKind::shadow_diffuse;
  queries_.surface_ends = SurfaceEnds::virtual_light;
  compute_importance();
  ask(indirect_, true, statistics);
}

// Asks about all contributions and adds up those that arrive, eye point by eye point.
void EyeKernel::ask(Vec3Batch& radiance, bool shared_lights, PassStatistics& statistics) {
  const std::size_t count = contributions_.size;
  if (count == 0) return;
  queries_.resize_queries(count);
  if (spatial_order_ && shared_lights) {
    ask_by_light(statistics);
  } else {
    std::copy_n(contributions_.eye.data(), count, queries_.eye_of.data());
    std::copy_n(contributions_.light.data(), count, queries_.light_of.data());
    worker_->visible(queries_, weights_, statistics.rays, statistics.visibility);
  }
  if (absorption_.any()) absorption_.apply(queries_, weights_, contributions_, statistics.rays);
  for (std::size_t begin = 0; begin < count;) {
    const std::uint32_t k = contributions_.eye[begin];
    std::size_t end = begin + 1;
    while (end < count && contributions_.eye[end] == k) ++end;
    add(radiance, chunk_slot_[k], weighted_sum(contributions_, weights_.data(), begin, end));
    begin = end;
  }
}

// What each query carries, over the mean of the chunk: samples in a narrow lobe, or near a small light, are most of their pixel.
void EyeKernel::compute_importance() {
  queries_.importance.clear();
  if (spatial_order_) return;
  const std::size_t count = contributions_.size;
  const Vec3Batch& color = contributions_.color;
  queries_.importance.resize(padded(count));
  float* const importance = queries_.importance.data();
  double total = 0;
  for (std::size_t begin = 0; begin < count; begin += 256) {
    const std::size_t end = std::min(begin + 256, count);
    for (std::size_t i = begin; i < end; ++i) importance[i] = color.x[i] + color.y[i] + color.z[i];
    float sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += importance[i];
    total += static_cast<double>(sum);
  }
  const auto scale = static_cast<float>(static_cast<double>(count) / total);
  for (std::size_t i = 0; i < count; ++i) importance[i] *= scale;
}

// Where every query is a ray and lights are shared by many eye points, rays to one light trace fastest together.
void EyeKernel::ask_by_light(PassStatistics& statistics) {
  const std::size_t count = contributions_.size;
  light_begin_.assign(queries_.light.size + 1, 0);
  for (std::size_t i = 0; i < count; ++i) ++light_begin_[contributions_.light[i] + 1];
  std::partial_sum(light_begin_.begin(), light_begin_.end(), light_begin_.begin());
  place_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t light = contributions_.light[i], to = light_begin_[light]++;
    place_[i] = to, queries_.light_of[to] = light, queries_.eye_of[to] = contributions_.eye[i];
  }
  queries_.kind = BatchKind::shadow;
  sorted_weights_.resize(std::max(sorted_weights_.size(), padded(count)));
  worker_->visible(queries_, sorted_weights_, statistics.rays, statistics.visibility);
  for (std::size_t i = 0; i < count; ++i) weights_[i] = sorted_weights_[place_[i]];
}

void EyeKernel::write(Frame& frame) {
  const auto channels = [](const Vec3Batch& batch, std::size_t at) {
    return std::array<const float*, 3>{batch.x.data() + at, batch.y.data() + at, batch.z.data() + at};
  };
  const auto each_block = [&](auto&& take) {
    for (std::size_t at = 0; at < paths_.count; at += paths_.samples * kLanes)
      take(at, PixelBlock{
                   paths_.pixel.data() + at, paths_.inside.data() + at, paths_.sample[at], static_cast<std::uint32_t>(paths_.samples), {}});
  };
  const auto add_all = [&](const Vec3Batch& from, Vec3Batch& to) {
    for (std::size_t i = 0; i < paths_.count; ++i) to.x[i] += from.x[i], to.y[i] += from.y[i], to.z[i] += from.z[i];
  };
  add_all(paths_.emitted, direct_);
  each_block([&](std::size_t at, PixelBlock block) {
    block.channel = channels(direct_, at), frame.add(Aov::direct, block);
    block.channel = channels(indirect_, at), frame.add(Aov::indirect, block);
  });
  add_all(indirect_, direct_);
  each_block([&](std::size_t at, PixelBlock block) { block.channel = channels(direct_, at), frame.add_color(block); });
}

}  // namespace sightline
