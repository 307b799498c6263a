// Which pixels can be interpolated.
#pragma once

#include <optional>

#include "methods/fragments/g_buffer.h"
#include "shade/analytic/analytic_bsdf.h"
#include "shade/bsdf.h"

namespace sightline {

/// Narrower lobes than this see so little of a light that 16 points of it do not tell what they see.
inline constexpr float kLeastAlpha = 0.02f;

/// Kind of a pixel whose surface has this BSDF and does not emit. `form` is its analytic form, if it has one and that may be used.
inline PixelKind kind_of(const Bsdf& bsdf, const std::optional<AnalyticBsdf>& form) {
  if (bsdf.lambert()) return PixelKind::diffuse;
  if (bsdf.is_delta()) return PixelKind::dark;
  return form && (!form->has_specular || form->ggx.alpha().x >= kLeastAlpha) ? PixelKind::analytic : PixelKind::general;
}

}  // namespace sightline
