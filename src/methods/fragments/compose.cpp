#include "methods/fragments/compose.h"

#include "base/math/vec3_batch.h"

namespace sightline {

void Composer::add(const GBuffer& g, const RootTile& tile, const AreaLight& light, std::span<const float* const> signal,
                   Vec3Batch& radiance) {
  pixels_.clear();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (std::size_t at = g.at(tile.x0, y); at < g.at(tile.x1, y); ++at) {
      const bool lit = signal.size() == 1 ? signal[0][at] > 0 : true;
      if (lit && (g.kind[at] == PixelKind::diffuse || g.kind[at] == PixelKind::analytic)) pixels_.push_back(static_cast<std::uint32_t>(at));
    }
  }
  if (signal.size() == 3) {
    for (const std::uint32_t at : pixels_)
      sightline::add(radiance, at, load(g.albedo, at) * Color(signal[0][at], signal[1][at], signal[2][at]));
    return;
  }
  const std::size_t n = pixels_.size();
  position_.resize(n), normal_.resize(n), form_factor_.resize(padded(n));
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t at = pixels_[i];
    position_.x[i] = g.position.x[at], position_.y[i] = g.position.y[at], position_.z[i] = g.position.z[at];
    normal_.x[i] = g.shading_normal.x[at], normal_.y[i] = g.shading_normal.y[at], normal_.z[i] = g.shading_normal.z[at];
  }
  for (const AreaLight::Member& member : light.members) {
    polygon_irradiance(member.polygon, position_, normal_, n, form_factor_.data(), member.sides);
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint32_t at = pixels_[i];
      const float share = signal[0][at] * form_factor_[i];
      radiance.x[at] += share * member.radiance.x * g.albedo.x[at];
      radiance.y[at] += share * member.radiance.y * g.albedo.y[at];
      radiance.z[at] += share * member.radiance.z * g.albedo.z[at];
    }
  }
}

}  // namespace sightline
