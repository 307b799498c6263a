// Absorbing media along rays: which one a ray runs through, what it takes away, and the interfaces that only bound it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "film/view.h"
#include "trace/ray_batch.h"
#include "world/world.h"

namespace sightline {

/// What every path of a scene needs to know about its media. Media lie behind surfaces (Material::interior) and do not overlap: who leaves
/// one is in none. Cheap to make; without media nothing but any() need ever be called.
class Media {
 public:
  explicit Media(const World& world);

  /// Whether anything absorbs.
  bool any() const { return any_; }
  /// Whether rays meet surfaces that only bound media.
  bool any_interface() const { return any_interface_; }
  bool is_interface(std::uint32_t material) const { return material < is_interface_.size() && is_interface_[material] != 0; }
  /// Beer-Lambert over `distance`.
  Color transmittance(MediumId medium, float distance) const;
  /// Behind hit `i` for a ray in `direction`.
  MediumId behind(const SurfaceBatch& surfaces, std::size_t i, const Vec3& direction) const;
  /// On the side of a surface towards `leaving`: of the path that arrived from `arrived_from` through `medium`, or behind the surface.
  static MediumId towards(const Vec3& leaving, const Vec3& arrived_from, const Vec3& normal, MediumId medium, MediumId interior) {
    const float side = glm::dot(leaving, normal);
    if (side * glm::dot(arrived_from, normal) > 0) return medium;
    return side < 0 ? interior : MediumId{};
  }

 private:
  const World& world_;
  bool any_ = false, any_interface_ = false;
  std::vector<std::uint8_t> is_interface_;  ///< by material
};

/// Rays through media. Buffers of one thread.
class MediumRays {
 public:
  explicit MediumRays(const World& world) : world_(world), media_(world) {}
  const Media& media() const { return media_; }

  /// The media that rays with t_far infinity begin in, as far as closed surfaces bound them: for cameras and lights.
  void find(const RayBatch& rays, std::span<MediumId> medium, RayCounts& counts);
  MediumId around_camera(const View& view);

  /// Goes on behind interfaces: `hits` and `surfaces`, those of `rays`, become the first ones that are no interface; hits.t still counts
  /// from the ray's own origin. `medium`, one a ray, is what the ray leaves through; what it arrives through afterwards. The answer is what
  /// absorption on the way leaves of its light, one a ray, valid until the next call; a last stretch without end absorbs nothing.
  std::span<const Color> travel(const RayBatch& rays, HitBatch& hits, SurfaceBatch& surfaces, std::span<MediumId> medium,
                                RayCounts& counts);

  /// What absorption leaves of light along unoccluded rays with t_far 1 or infinity, the k-th of which begins in medium[k].
  std::span<const Color> attenuate(const RayBatch& rays, std::span<const MediumId> medium, RayCounts& counts);

 private:
  /// A ray on its way beyond an interface.
  struct Pending {
    std::uint32_t ray;
    float travelled;  ///< up to where it goes on; in attenuate(), from the interface to there
  };

  const World& world_;
  Media media_;
  std::vector<Color> left_;
  std::vector<MediumId> medium_;
  std::vector<Pending> pending_;
  std::vector<int> entered_;
  RayBatch onward_;
  HitBatch hits_;
  SurfaceBatch surfaces_;
};

}  // namespace sightline
