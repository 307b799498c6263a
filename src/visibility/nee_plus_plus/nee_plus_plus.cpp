#include "visibility/nee_plus_plus/nee_plus_plus.h"

#include <algorithm>
#include <utility>

#include "base/sample/sobol.h"
#include "visibility/nee_plus_plus/settings.h"
#include "visibility/nee_plus_plus/visibility_map.h"
#include "visibility/query_rays.h"

namespace sightline {
namespace {

class NeePlusPlusWorker final : public VisibilityWorker {
 public:
  NeePlusPlusWorker(const World& world, VisibilityMap& map, bool learns_directions)
      : world_(world), map_(map), learns_directions_(learns_directions), tracer_(world) {}
  void begin(std::uint32_t) override {}
  void visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) override;

 private:
  void find_voxels(const QueryBatch& queries);
  std::uint64_t play(const QueryBatch& queries, std::span<float> weights);
  void trace_in_place(const QueryBatch& queries, RayCounts& rays);
  void learn(std::span<const std::uint8_t> occluded);

  const World& world_;
  VisibilityMap& map_;
  bool learns_directions_;
  QueryTracer tracer_;
  AlignedVector<std::uint32_t> eye_voxel_, light_cell_;  ///< by end: voxels; of infinite ends cells of directions
  std::vector<std::uint32_t> kept_, entry_;              ///< queries that are traced and their entries of the map, kNoQuery: none
  RayBatch batch_;
  AlignedVector<std::uint8_t> occluded_, packed_;
};

void NeePlusPlusWorker::find_voxels(const QueryBatch& queries) {
  const auto position = [](const QueryEnds& ends, std::size_t i) {
    return Vec3(ends.position.x[i], ends.position.y[i], ends.position.z[i]);
  };
  eye_voxel_.resize(std::max(eye_voxel_.size(), queries.eye.size));
  light_cell_.resize(std::max(light_cell_.size(), queries.light.size));
  for (std::size_t e = 0; e < queries.eye.size; ++e) eye_voxel_[e] = map_.voxel_of(position(queries.eye, e));
  for (std::size_t l = 0; l < queries.light.size; ++l) {
    if (!is_infinite(static_cast<QuerySemantic>(queries.semantic[l])))
      light_cell_[l] = map_.voxel_of(position(queries.light, l));
    else if (learns_directions_)
      light_cell_[l] = map_.direction_cell(position(queries.light, l));
  }
}

// Roulette: weights become what a visible answer is worth, 0 where nothing is traced; `kept_` lists the rest. Returns the queries asked.
std::uint64_t NeePlusPlusWorker::play(const QueryBatch& queries, std::span<float> weights) {
  kept_.clear(), entry_.clear();
  std::uint64_t asked = 0;
  std::uint32_t last_eye = kNoQuery, repeat = 0;
  for (std::size_t i = 0; i < queries.size; ++i) {
    weights[i] = 0;
    const std::uint32_t l = queries.light_of[i], e = queries.eye_of[i];
    if (l == kNoQuery) continue;
    ++asked;
    // An eye point may ask about a light without extent more than once: each time plays for itself.
    repeat = e == last_eye ? repeat + 1 : 0;
    last_eye = e;
    std::uint32_t entry = kNoQuery;
    std::uint8_t odds = 0;
    if (!is_infinite(static_cast<QuerySemantic>(queries.semantic[l])))
      entry = VisibilityMap::entry(eye_voxel_[e], light_cell_[l]);
    else if (learns_directions_)
      entry = map_.entry_of_direction(eye_voxel_[e], light_cell_[l]);
    if (entry != kNoQuery) odds = map_.odds(entry);
    if (odds > 0) {
      const std::uint32_t number = hash_combine(queries.eye.id[e] + 0x9e3779b9u * repeat, queries.light.id[l]) >> 24;
      if (number >= odds) continue;
    }
    weights[i] = odds > 0 ? 256.f / static_cast<float>(odds) : 1.f;
    kept_.push_back(static_cast<std::uint32_t>(i));
    entry_.push_back(entry);
  }
  return asked;
}

// The kept queries as lanes of the packets that the caller composed, all others inactive.
void NeePlusPlusWorker::trace_in_place(const QueryBatch& queries, RayCounts& rays) {
  packed_.resize(std::max(packed_.size(), padded(queries.size)));
  batch_.resize(queries.size);
  std::fill_n(batch_.t_near.begin(), queries.size, 0.f);
  std::fill_n(batch_.t_far.begin(), queries.size, -1.f);
  for (const std::uint32_t i : kept_) batch_.set(i, query_ray(queries, i));
  world_.tracer().occluded(batch_, packed_, queries.kind, rays);
  occluded_.resize(std::max(occluded_.size(), kept_.size()));
  for (std::size_t k = 0; k < kept_.size(); ++k) occluded_[k] = packed_[kept_[k]];
}

// Neighbouring queries mostly share their entry: one addition for each run of them.
void NeePlusPlusWorker::learn(std::span<const std::uint8_t> occluded) {
  for (std::size_t k = 0; k < entry_.size();) {
    const std::uint32_t entry = entry_[k];
    std::uint32_t tested = 0, visible = 0;
    for (; k < entry_.size() && entry_[k] == entry; ++k) ++tested, visible += occluded[k] == 0;
    if (entry != kNoQuery) map_.learn(entry, tested, visible);
  }
}

void NeePlusPlusWorker::visible(const QueryBatch& queries, std::span<float> weights, RayCounts& rays, VisibilityCounts& counts) {
  find_voxels(queries);
  const std::uint64_t asked = play(queries, weights);
  // Packets that the caller made coherent are worth more than full ones while most of their rays remain.
  std::span<const std::uint8_t> occluded;
  if (queries.kind == BatchKind::shadow && 4 * kept_.size() >= 3 * asked) {
    trace_in_place(queries, rays);
    counts.traced += kept_.size();
    occluded = std::span<const std::uint8_t>(occluded_).first(kept_.size());
  } else {
    occluded = tracer_.trace(queries, kept_, rays, counts);
  }
  for (std::size_t k = 0; k < kept_.size(); ++k) weights[kept_[k]] = occluded[k] ? 0.f : weights[kept_[k]];
  learn(occluded);
  counts.queries += asked;
  counts.cached += asked - kept_.size();
  counts.lookups += asked;
}

class NeePlusPlus final : public Visibility {
 public:
  NeePlusPlus(std::shared_ptr<const World> world, const NeePlusPlusSettings& settings)
      : world_(std::move(world)),
        limits_{static_cast<std::uint32_t>(settings.min_tests), settings.min_probability, settings.sure_from},
        learns_directions_(settings.directions > 0),
        map_(world_->bounds(), static_cast<std::uint32_t>(settings.resolution), static_cast<std::uint32_t>(settings.directions)) {}
  bool passes_are_independent() const override { return false; }
  bool binary() const override { return false; }
  void begin_pass(const VisibilityPass&, const Context& context) override { map_.freeze(limits_, context); }
  std::unique_ptr<VisibilityWorker> worker() override { return std::make_unique<NeePlusPlusWorker>(*world_, map_, learns_directions_); }
  std::uint64_t memory_bytes() const override { return map_.touched_bytes(); }

 private:
  std::shared_ptr<const World> world_;
  VisibilityMap::Limits limits_;
  bool learns_directions_;
  VisibilityMap map_;
};

}  // namespace

VisibilityInfo nee_plus_plus_visibility() {
  VisibilityInfo info;
  info.name = "nee++";
  info.help =
      "next event estimation++: Russian roulette of shadow rays with the probability, learnt in earlier passes, that two voxels see each "
      "other; unbiased";
  info.citation = "Guo2020";
  info.binary = false;
  info.settings = SettingsValue::of<NeePlusPlusSettings>();
  info.table_bytes = [](const SettingsValue& value, const Context&) {
    const auto& settings = value.as<NeePlusPlusSettings>();
    return VisibilityMap::bytes(static_cast<std::uint32_t>(settings.resolution), static_cast<std::uint32_t>(settings.directions));
  };
  info.make = [](std::shared_ptr<const World> world, const SettingsValue& settings, const Context&) -> std::unique_ptr<Visibility> {
    return std::make_unique<NeePlusPlus>(std::move(world), settings.as<NeePlusPlusSettings>());
  };
  return info;
}

}  // namespace sightline
