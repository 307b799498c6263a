#include "shade/lights/power_picker.h"

namespace sightline {

LightPicker::Pick PowerPicker::pick(const Vec3&, const Vec3&, float u) const {
  if (!table_.can_sample()) return {};
  const AliasTable::Choice choice = table_.sample(u);
  return {choice.index, choice.probability, choice.u};
}

float PowerPicker::probability(const Vec3&, const Vec3&, std::uint32_t light) const {
  return light < table_.size() ? table_.probability(light) : 0.f;
}

}  // namespace sightline
