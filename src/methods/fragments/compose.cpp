#include "methods/fragments/compose.h"

#include <span>

#include "base/math/vec3_batch.h"

namespace sightline {
namespace {

// What of a convex polygon lies above the plane through `point` [Sutherland1974].
void cut_by_plane(std::span<const Vec3> polygon, const Vec3& point, const Vec3& normal, std::vector<Vec3>& above) {
  above.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 a = polygon[i] - point, b = polygon[(i + 1) % polygon.size()] - point;
    const float height_a = glm::dot(a, normal), height_b = glm::dot(b, normal);
    if (height_a >= 0) above.push_back(polygon[i]);
    if ((height_a > 0 && height_b < 0) || (height_a < 0 && height_b > 0))
      above.push_back(point + a + (b - a) * (height_a / (height_a - height_b)));
  }
}

const GlossyPoint& glossy_point(const GBuffer& g, std::uint32_t at) {
  const auto stride = static_cast<std::uint32_t>(g.stride);
  return g.glossy_at(static_cast<int>(at % stride), static_cast<int>(at / stride));
}

}  // namespace

void Composer::add(const GBuffer& g, const RootTile& tile, const AreaLight& light, std::span<const float* const> signal,
                   Vec3Batch& radiance) {
  pixels_.clear(), cut_.clear(), glossy_.clear();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (std::size_t at = g.at(tile.x0, y); at < g.at(tile.x1, y); ++at) {
      const bool lit = signal.size() == 1 ? signal[0][at] > 0 : true;
      if (!lit || (g.kind[at] != PixelKind::diffuse && g.kind[at] != PixelKind::analytic)) continue;
      const Vec3 normal = load(g.geometric_normal, at);
      const bool cut = signal.size() == 1 && normal != load(g.shading_normal, at) && !light.above(load(g.position, at), normal);
      (cut ? cut_ : g.kind[at] == PixelKind::analytic ? glossy_ : pixels_).push_back(static_cast<std::uint32_t>(at));
    }
  }
  if (signal.size() == 3) {
    for (const std::uint32_t at : pixels_)
      sightline::add(radiance, at, load(g.albedo, at) * Color(signal[0][at], signal[1][at], signal[2][at]));
    return;
  }
  add_cut(g, light, signal[0], radiance);
  add_glossy(g, light, signal[0], radiance);
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

// Facets of smooth surfaces that see only a part of the light: the rest lies below them, though not below the shading normal's horizon.
void Composer::add_cut(const GBuffer& g, const AreaLight& light, const float* signal, Vec3Batch& radiance) {
  for (const std::uint32_t at : cut_) {
    const Vec3 position = load(g.position, at), normal = load(g.geometric_normal, at);
    for (const AreaLight::Member& member : light.members) {
      cut_by_plane(member.polygon, position, normal, polygon_);
      if (polygon_.size() < 3) continue;
      if (g.kind[at] == PixelKind::analytic) {
        const GlossyPoint& point = glossy_point(g, at);
        const AnalyticLobes lobes = analytic_lobes(point.form, glm::dot(point.wo, point.frame.normal));
        const PolygonReflection reflected = reflect_polygon(polygon_, position, point.frame.normal, point.wo, lobes, member.sides);
        sightline::add(radiance, at, (reflected.diffuse + reflected.specular) * member.radiance * signal[at]);
        continue;
      }
      const auto form_factor = static_cast<float>(polygon_irradiance(polygon_, position, load(g.shading_normal, at), member.sides));
      sightline::add(radiance, at, load(g.albedo, at) * member.radiance * (signal[at] * form_factor));
    }
  }
}

// The visible share of a glossy pixel weighs light points by all that they contribute there: it goes with the sum of both lobes.
void Composer::add_glossy(const GBuffer& g, const AreaLight& light, const float* signal, Vec3Batch& radiance) {
  const std::size_t n = glossy_.size();
  if (n == 0) return;
  position_.resize(n), normal_.resize(n), wo_.resize(n), diffuse_.resize(n), specular_.resize(n), lobes_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const GlossyPoint& point = glossy_point(g, glossy_[i]);
    store(position_, i, load(g.position, glossy_[i]));
    store(normal_, i, point.frame.normal), store(wo_, i, point.wo);
    lobes_.set(i, analytic_lobes(point.form, glm::dot(point.wo, point.frame.normal)));
  }
  for (const AreaLight::Member& member : light.members) {
    reflect_polygon(member.polygon, {position_, normal_, wo_, lobes_}, n, diffuse_, specular_, member.sides);
    for (std::size_t i = 0; i < n; ++i)
      sightline::add(radiance, glossy_[i], (load(diffuse_, i) + load(specular_, i)) * member.radiance * signal[glossy_[i]]);
  }
}

}  // namespace sightline
