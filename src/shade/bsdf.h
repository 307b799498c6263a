// A BSDF as a value: one of the reflectance models with its parameters already looked up.
#pragma once

#include <optional>
#include <variant>

#include "shade/bsdf_types.h"
#include "shade/coated_diffuse.h"
#include "shade/conductor.h"
#include "shade/cook_torrance.h"
#include "shade/dielectric.h"
#include "shade/diffuse_transmission.h"
#include "shade/lambert.h"
#include "shade/measured_brdf.h"
#include "shade/metallic_roughness.h"
#include "shade/phong.h"
#include "shade/ward.h"

namespace sightline {

/// Small, trivially copyable; made by make_bsdf for one shading point.
class Bsdf {
 public:
  using Model = std::variant<Lambert, MetallicRoughness, Conductor, Dielectric, CoatedDiffuse, Phong, DiffuseTransmission, Ward,
                             CookTorrance, MeasuredBrdf>;

  Bsdf() = default;
  explicit Bsdf(const Model& model) : model_(model) {}

  BsdfEval evaluate(const Vec3& wo, const Vec3& wi, TransportMode mode = TransportMode::radiance) const {
    return std::visit([&](const auto& m) { return m.evaluate(wo, wi, mode); }, model_);
  }
  std::optional<BsdfSample> sample(const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode = TransportMode::radiance) const {
    return std::visit([&](const auto& m) { return m.sample(wo, u_lobe, u, mode); }, model_);
  }
  /// All delta parts at once, for those who follow every branch.
  DeltaLobes delta_lobes(const Vec3& wo, TransportMode mode = TransportMode::radiance) const {
    return std::visit([&](const auto& m) { return m.delta_lobes(wo, mode); }, model_);
  }
  /// For vector code that evaluates towards many directions, where the model has that shape.
  std::optional<SurfaceLobes> lobes(const Vec3& wo) const {
    return std::visit(
        [&](const auto& m) -> std::optional<SurfaceLobes> {
          if constexpr (requires { m.lobes(wo); }) return m.lobes(wo);
          return std::nullopt;
        },
        model_);
  }
  /// Tells the model a direction that many evaluations will share. Changes no value, only how often it is worked out.
  void prepare(const Vec3& w) {
    if (CoatedDiffuse* coated = std::get_if<CoatedDiffuse>(&model_)) coated->prepare(w);
  }
  Color albedo() const {
    return std::visit([](const auto& m) { return m.albedo(); }, model_);
  }
  bool is_delta() const {
    return std::visit([](const auto& m) { return m.is_delta(); }, model_);
  }
  /// Whether it looks the same however it is turned about the normal.
  bool is_isotropic() const {
    return std::visit([](const auto& m) { return m.is_isotropic(); }, model_);
  }
  /// The Lambert model if that is all there is: batches of these take the vector path.
  const Lambert* lambert() const { return std::get_if<Lambert>(&model_); }
  const Model& model() const { return model_; }

 private:
  Model model_;
};

}  // namespace sightline
