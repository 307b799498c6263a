#include "visibility/cached/batch_keys.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

// Levels until cells are about one eye path wide. Deviation: [Popov2013, §3.6] ends at two, which saves few rays: see README.md.
constexpr float kFinestCell = 1.25f;

int levels_for(float ce, int depth) {
  const int most = static_cast<int>(VisibilityCounts::kMaxDepth);
  const int wanted = depth > 0 ? depth : 1 + static_cast<int>(std::ceil(std::log2(std::max(ce / kFinestCell, 1.f)) - 1e-5f));
  return std::clamp(wanted, 1, most);
}

}  // namespace

KeyFormat BatchKeys::format() const {
  return {settings_->hash == CacheHash::separable && settings_->refine != CacheRefinement::sixty_four, salt_};
}

void BatchKeys::make_groups(std::uint32_t present) {
  groups_.clear();
  const bool refine = settings_->refine != CacheRefinement::none && !connections_;
  for (std::uint32_t s = 0; s < 4; ++s) {
    if ((present & (1u << s)) == 0) continue;
    const float ce = settings_->ce_of(static_cast<QuerySemantic>(s), queries_->surface_ends);
    const auto same = std::find_if(groups_.begin(), groups_.end(), [&](const KeyGroup& g) { return g.ce == ce; });
    if (same != groups_.end()) {
      same->semantics |= 1u << s;
      continue;
    }
    KeyGroup group{ce, 1u << s};
    if (refine) group.eye_levels = levels_for(ce, settings_->depth);
    group.levels = group.eye_levels;
    groups_.push_back(group);
  }
  // Points and directions have no cells that could become smaller.
  constexpr std::uint32_t kWithCells =
      (1u << static_cast<int>(QuerySemantic::surface)) | (1u << static_cast<int>(QuerySemantic::solid_angle));
  for (KeyGroup& group : groups_) {
    if (refine && (group.semantics & kWithCells))
      group.levels = std::min(group.eye_levels + settings_->light_refine, static_cast<int>(VisibilityCounts::kMaxDepth));
  }
}

void BatchKeys::prepare(const QueryBatch& queries, CacheSalt salt) {
  queries_ = &queries;
  salt_ = salt;
  connections_ = queries.split == QuerySplit::symmetric;
  const GridConstants& grid = quantizer_->constants();
  for (Row& row : light_rows_) row.made = false;
  for (std::vector<Row>& rows : eye_rows_) {
    for (Row& row : rows) row.made = false;
  }
  locate_lanes(grid, queries.eye, eye_points_);
  std::uint32_t present = 0;
  if (connections_) {
    present = light_key_lanes(grid, queries.light, queries.semantic.data(), 0, {false, salt_}, light_words_);
  } else {
    if (light_rows_.empty()) light_rows_.resize(1);
    present = light_key_lanes(grid, queries.light, queries.semantic.data(), 0, format(), light_rows_[0].keys);
    light_rows_[0].made = true;
  }
  make_groups(present);
  if (eye_rows_.size() < groups_.size()) eye_rows_.resize(groups_.size());
  if (connections_) make_connections(queries);

  if (members_.size() < groups_.size()) members_.resize(groups_.size());
  for (AlignedVector<std::uint32_t>& list : members_) list.clear();
  if (groups_.size() < 2) return;
  std::array<std::size_t, 4> group_of{};
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    for (std::size_t s = 0; s < 4; ++s) {
      if (groups_[g].semantics & (1u << s)) group_of[s] = g;
    }
  }
  for (std::uint32_t i = 0; i < queries.size; ++i) {
    const std::uint32_t light = queries.light_of[i];
    if (light != kNoQuery) members_[group_of[queries.semantic[light] & 3]].push_back(i);
  }
}

void BatchKeys::make_connections(const QueryBatch& queries) {
  const GridConstants& grid = quantizer_->constants();
  locate_lanes(grid, queries.light, light_points_);
  ConnectionEnds ends{.eye = &eye_points_,
                      .light = &light_points_,
                      .light_words = &light_words_,
                      .semantic = queries.semantic.data(),
                      .eye_of = queries.eye_of.data(),
                      .light_of = queries.light_of.data(),
                      .eye_offset = {},
                      .symmetric_offset = 0};
  for (int s = 0; s < 4; ++s)
    ends.eye_offset[s] = quantizer_->eye_offset(settings_->ce_of(static_cast<QuerySemantic>(s), queries.surface_ends));
  ends.symmetric_offset = quantizer_->symmetric_offset(settings_->ce_of(QuerySemantic::surface, queries.surface_ends));
  if (light_rows_.empty()) light_rows_.resize(1);
  for (std::vector<Row>& rows : eye_rows_) {
    if (rows.empty()) rows.resize(1);
  }
  // Keys hold the C_E of their own semantic, so that all groups may share one row.
  if (eye_rows_.empty()) eye_rows_.resize(1), eye_rows_[0].resize(1);
  connection_key_lanes(grid, ends, queries.size, format(), eye_rows_[0][0].keys, light_rows_[0].keys);
  identity_.resize(padded(queries.size));
  for (std::uint32_t i = 0; i < queries.size; ++i) identity_[i] = queries.light_of[i] == kNoQuery ? kNoQuery : i;
}

LookUp BatchKeys::level(std::size_t group, int level) {
  const KeyGroup& own = groups_[group];
  LookUp look_up;
  look_up.hash = settings_->hash;
  look_up.salt = salt_;
  look_up.counters = settings_->counters > 0;
  look_up.rays_a_cell = static_cast<std::uint32_t>(std::max(settings_->counters, 1));
  look_up.last_level = level + 1 >= own.levels;
  look_up.neighbours = look_up.last_level ? CacheRefinement::none : settings_->refine;
  if (level == 0 && settings_->importance > 0 && !queries_->importance.empty()) {
    look_up.importance = queries_->importance.data();
    look_up.most_important = settings_->importance;
  }
  if (connections_) {
    look_up.eye_keys = &eye_rows_[0][0].keys;
    look_up.light_keys = &light_rows_[0].keys;
    return look_up;
  }
  const int at_eye = std::min(level, own.eye_levels - 1), at_light = level - at_eye;
  const GridConstants& grid = quantizer_->constants();
  std::vector<Row>& rows = eye_rows_[group];
  if (rows.size() <= static_cast<std::size_t>(at_eye)) rows.resize(static_cast<std::size_t>(at_eye) + 1);
  Row& eye = rows[static_cast<std::size_t>(at_eye)];
  if (!eye.made) {
    eye.keys.resize(queries_->eye.size, format().parts);
    eye_key_lanes(grid, eye_points_, 0, queries_->eye.size, quantizer_->eye_offset(std::ldexp(own.ce, -at_eye)), format().parts, eye.keys);
    eye.made = true;
  }
  if (light_rows_.size() <= static_cast<std::size_t>(at_light)) light_rows_.resize(static_cast<std::size_t>(at_light) + 1);
  Row& light = light_rows_[static_cast<std::size_t>(at_light)];
  if (!light.made) {
    const float shift = static_cast<float>(at_light) * grid.levels_per_octave;
    light_key_lanes(grid, queries_->light, queries_->semantic.data(), shift, format(), light.keys);
    light.made = true;
  }
  look_up.eye_keys = &eye.keys;
  look_up.light_keys = &light.keys;
  return look_up;
}

}  // namespace sightline
