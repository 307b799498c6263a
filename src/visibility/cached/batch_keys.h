// Keys of one batch: parts of both ends for each level of refinement, made when first asked for.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "visibility/cached/key_lanes.h"
#include "visibility/cached/look_up_lanes.h"

namespace sightline {

/// Queries whose light ends have the same C_E.
struct KeyGroup {
  float ce = 8;
  std::uint32_t semantics = 0;  ///< bit 1 << QuerySemantic
  int eye_levels = 1;           ///< levels until eye cells are smallest
  int levels = 1;               ///< and those at the light after them
};

class BatchKeys {
 public:
  BatchKeys(const Quantizer& quantizer, const CachedVisibilitySettings& settings) : quantizer_(&quantizer), settings_(&settings) {}

  /// Takes in a batch, which must live as long as keys are asked for.
  void prepare(const QueryBatch& queries, CacheSalt salt);
  const std::vector<KeyGroup>& groups() const { return groups_; }
  /// Queries of a group in order, where there are several groups; gaps are in none.
  const AlignedVector<std::uint32_t>& members(std::size_t group) const { return members_[group]; }

  /// Look-up of level `level` for queries of `group`, but for which queries.
  LookUp level(std::size_t group, int level);
  /// Ends of all queries as the keys count them.
  const std::uint32_t* eye_of() const { return connections_ ? identity_.data() : queries_->eye_of.data(); }
  const std::uint32_t* light_of() const { return connections_ ? identity_.data() : queries_->light_of.data(); }

 private:
  struct Row {
    EndKeys keys;
    bool made = false;
  };
  void make_groups(std::uint32_t present);
  void make_connections(const QueryBatch& queries);
  KeyFormat format() const;

  const Quantizer* quantizer_;
  const CachedVisibilitySettings* settings_;
  const QueryBatch* queries_ = nullptr;
  CacheSalt salt_;
  bool connections_ = false;  ///< each query has keys of its own
  std::vector<KeyGroup> groups_;
  std::vector<AlignedVector<std::uint32_t>> members_;
  GridPoints eye_points_, light_points_;
  std::vector<std::vector<Row>> eye_rows_;  ///< by group and level
  std::vector<Row> light_rows_;             ///< by levels at the light
  EndKeys light_words_;
  AlignedVector<std::uint32_t> identity_;
};

}  // namespace sightline
