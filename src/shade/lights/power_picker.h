// Lights chosen in proportion to their power.
#pragma once

#include <span>

#include "base/sample/alias_table.h"
#include "shade/light_table.h"

namespace sightline {

class PowerPicker final : public LightPicker {
 public:
  explicit PowerPicker(std::span<const float> powers) : table_(powers) {}
  Pick pick(const Vec3& position, const Vec3& normal, float u) const override;
  float probability(const Vec3& position, const Vec3& normal, std::uint32_t light) const override;
  const AliasTable& table() const { return table_; }

 private:
  AliasTable table_;
};

}  // namespace sightline
