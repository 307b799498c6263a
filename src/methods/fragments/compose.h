// From the signal of a light to radiance: the last stage.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "methods/fragments/area_light.h"
#include "methods/fragments/g_buffer.h"
#include "methods/fragments/reach.h"
#include "shade/analytic/reflection.h"

namespace sightline {

/// How lobes reflect a light without shadows.
enum class GlossyTerm {
  quadrature,  ///< GGX itself, summed over the light
  ltc,         ///< linearly transformed cosines
};

/// Buffers of one thread.
class Composer {
 public:
  void set_glossy_term(GlossyTerm term) { glossy_term_ = term; }
  /// radiance += light of `light` at the pixels of `tile`; signal[c] is laid out as `g`: one channel is the visible share of the analytic
  /// term, three are irradiance / pi. Albedo comes last.
  void add(const GBuffer& g, const RootTile& tile, const AreaLight& light, std::span<const float* const> signal, Vec3Batch& radiance);

 private:
  /// 16 pixels of a row, and what they take of the analytic term: 0 for those that are done otherwise.
  struct Group {
    std::uint32_t at;
    std::array<float, kLanes> share;
  };
  /// What a pixel that is not plain takes.
  void sort_in(const GBuffer& g, std::uint32_t at, bool cut);
  void add_irradiance(const GBuffer& g, const RootTile& tile, std::span<const float* const> signal, Vec3Batch& radiance);
  void add_plain(const GBuffer& g, const AreaLight& light, Vec3Batch& radiance);
  void add_cut(const GBuffer& g, const AreaLight& light, const float* signal, Vec3Batch& radiance);
  void add_lobes(const GBuffer& g, const AreaLight& light, const float* signal, Vec3Batch& radiance);
  void add_glossy(const GBuffer& g, const AreaLight& light, const float* signal, Vec3Batch& radiance);
  std::vector<Group> groups_;
  GlossyTerm glossy_term_ = GlossyTerm::quadrature;
  std::vector<std::uint32_t> cut_, glossy_, lobes_of_;
  std::vector<Vec3> polygon_;
  Vec3Batch position_, normal_;
  AlignedVector<float> form_factor_;
  // Of glossy pixels.
  Vec3Batch wo_, geometric_normal_, diffuse_, specular_;
  AlignedVector<float> alpha_;
  AnalyticLobesBatch lobes_;
};

}  // namespace sightline
