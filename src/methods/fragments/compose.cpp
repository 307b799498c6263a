#include "methods/fragments/compose.h"

#include <algorithm>
#include <array>
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
  if (signal.size() == 3) {
    add_irradiance(g, tile, signal, radiance);
    return;
  }
  groups_.clear(), cut_.clear(), glossy_.clear(), lobes_of_.clear();
  std::array<std::uint8_t, kLanes> cut;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += static_cast<int>(kLanes)) {
      const std::size_t at = g.at(x, y);
      const float* share = signal[0] + at;
      float most = 0;
      for (std::size_t i = 0; i < kLanes; ++i) most = std::max(most, share[i]);
      if (most <= 0) continue;
      cut_pixels(g, at, kLanes, light, cut.data());
      Group group{static_cast<std::uint32_t>(at), {}};
      for (std::size_t i = 0; i < kLanes; ++i) {
        const PixelKind kind = g.kind[at + i];
        const bool lit = share[i] > 0 && (kind == PixelKind::diffuse || kind == PixelKind::analytic);
        const bool plain = lit && kind == PixelKind::diffuse && !cut[i];
        group.share[i] = plain ? share[i] : 0.f;
        if (lit && !plain) sort_in(g, static_cast<std::uint32_t>(at + i), cut[i]);
      }
      groups_.push_back(group);
    }
  }
  add_plain(g, light, radiance);
  add_cut(g, light, signal[0], radiance);
  add_glossy(g, light, signal[0], radiance);
  add_lobes(g, light, signal[0], radiance);
}

void Composer::sort_in(const GBuffer& g, std::uint32_t at, bool cut) {
  bool polygon = true;
  if (glossy_term_ == GlossyTerm::quadrature && g.kind[at] == PixelKind::analytic) {
    const AnalyticBsdf& form = glossy_point(g, at).form;
    polygon = !is_black(form.diffuse);
    if (form.has_specular) lobes_of_.push_back(at);
  }
  if (polygon) (cut ? cut_ : glossy_).push_back(at);
}

void Composer::add_irradiance(const GBuffer& g, const RootTile& tile, std::span<const float* const> signal, Vec3Batch& radiance) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (std::size_t at = g.at(tile.x0, y); at < g.at(tile.x1 - 1, y) + 1; ++at) {
      const float lit = g.kind[at] == PixelKind::diffuse ? 1.f : 0.f;
      radiance.x[at] += lit * g.albedo.x[at] * signal[0][at];
      radiance.y[at] += lit * g.albedo.y[at] * signal[1][at];
      radiance.z[at] += lit * g.albedo.z[at] * signal[2][at];
    }
  }
}

// Lambert's surfaces, 16 pixels of a row at a time.
void Composer::add_plain(const GBuffer& g, const AreaLight& light, Vec3Batch& radiance) {
  const std::size_t n = groups_.size() * kLanes;
  position_.resize(n), normal_.resize(n), form_factor_.resize(n);
  const auto gather = [&](const AlignedVector<float>& from, AlignedVector<float>& to) {
    for (std::size_t k = 0; k < groups_.size(); ++k) std::copy_n(from.data() + groups_[k].at, kLanes, to.data() + k * kLanes);
  };
  gather(g.position.x, position_.x), gather(g.position.y, position_.y), gather(g.position.z, position_.z);
  gather(g.shading_normal.x, normal_.x), gather(g.shading_normal.y, normal_.y), gather(g.shading_normal.z, normal_.z);
  for (const AreaLight::Member& member : light.members) {
    polygon_irradiance(member.polygon, position_, normal_, n, form_factor_.data(), member.sides);
    const auto scatter = [&](const AlignedVector<float>& albedo, float emitted, AlignedVector<float>& to) {
      for (std::size_t k = 0; k < groups_.size(); ++k) {
        const float *factor = form_factor_.data() + k * kLanes, *reflectance = albedo.data() + groups_[k].at;
        float* sum = to.data() + groups_[k].at;
        for (std::size_t i = 0; i < kLanes; ++i)
          sum[i] += groups_[k].share[i] > 0 ? groups_[k].share[i] * factor[i] * emitted * reflectance[i] : 0.f;
      }
    };
    scatter(g.albedo.x, member.radiance.x, radiance.x), scatter(g.albedo.y, member.radiance.y, radiance.y);
    scatter(g.albedo.z, member.radiance.z, radiance.z);
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
        AnalyticLobes lobes = analytic_lobes(point.form, glm::dot(point.wo, point.frame.normal));
        if (glossy_term_ == GlossyTerm::quadrature) lobes.specular = Color(0);
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
    AnalyticLobes lobes = analytic_lobes(point.form, glm::dot(point.wo, point.frame.normal));
    if (glossy_term_ == GlossyTerm::quadrature) lobes.specular = Color(0);
    lobes_.set(i, lobes);
  }
  for (const AreaLight::Member& member : light.members) {
    reflect_polygon(member.polygon, {position_, normal_, wo_, lobes_}, n, diffuse_, specular_, member.sides);
    for (std::size_t i = 0; i < n; ++i)
      sightline::add(radiance, glossy_[i], (load(diffuse_, i) + load(specular_, i)) * member.radiance * signal[glossy_[i]]);
  }
}

// GGX lobes by quadrature, of cut pixels too.
void Composer::add_lobes(const GBuffer& g, const AreaLight& light, const float* signal, Vec3Batch& radiance) {
  const std::size_t n = lobes_of_.size();
  if (n == 0) return;
  for (Vec3Batch* batch : {&position_, &normal_, &geometric_normal_, &wo_, &specular_}) batch->resize(n);
  lobes_.resize(n), alpha_.resize(padded(n));
  for (std::size_t i = 0; i < n; ++i) {
    const GlossyPoint& point = glossy_point(g, lobes_of_[i]);
    store(position_, i, load(g.position, lobes_of_[i])), store(geometric_normal_, i, load(g.geometric_normal, lobes_of_[i]));
    store(normal_, i, point.frame.normal), store(wo_, i, point.wo);
    alpha_[i] = point.form.ggx.alpha().x;
    lobes_.set(i, analytic_lobes(point.form, glm::dot(point.wo, point.frame.normal)));
  }
  for (const AreaLight::Member& member : light.members) {
    ggx_over_surface(member.surface, {position_, normal_, geometric_normal_, wo_, lobes_, alpha_}, n, specular_);
    for (std::size_t i = 0; i < n; ++i) {
      const AnalyticBsdf& form = glossy_point(g, lobes_of_[i]).form;
      sightline::add(radiance, lobes_of_[i], specular_of(form, load(specular_, i)) * member.radiance * signal[lobes_of_[i]]);
    }
  }
}

}  // namespace sightline
