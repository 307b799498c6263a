// Which pixels can be interpolated.
#pragma once

#include "methods/fragments/g_buffer.h"
#include "shade/bsdf.h"

namespace sightline {

/// Kind of a pixel whose surface has this BSDF and does not emit.
inline PixelKind kind_of(const Bsdf& bsdf) {
  if (bsdf.lambert()) return PixelKind::diffuse;
  if (bsdf.is_delta()) return PixelKind::dark;
  return PixelKind::general;
}
inline Color lambert_albedo(const Bsdf& bsdf) { return bsdf.lambert() ? bsdf.lambert()->albedo() : Color(0); }

}  // namespace sightline
