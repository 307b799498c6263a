// Flat convex things, floors and walls, as exact occluders of what moves above them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "scene/scene.h"

namespace sightline::square_lights {

struct LightSet;

/// A convex polygon in world space.
class PlanarOccluder {
 public:
  /// The hull of points that lie in one plane and whose `area` fills it; nothing for anything else.
  static std::optional<PlanarOccluder> fit(std::span<const Vec3> points, float area);

  /// The polygon from one place: what many directions are asked about.
  class Seen {
   public:
    /// As distance() has it, if less than `most`; else `most`. Where the square is hidden to its last corner, no more than minus `most`.
    float distance(const Vec3& c, float most) const;
    /// The same for all lights, `most` being r times `plane_scale`; as long as the lights are padded.
    void distances(const LightSet& lights, float plane_scale, std::span<float> distances) const;
    bool is_edge_on() const { return out_.empty(); }

   private:
    friend class PlanarOccluder;
    std::vector<Vec3> out_;  ///< unit normals of the great circles through the edges, pointing out
  };
  void see(const Vec3& position, Seen& seen) const;
  /// Distance, in plane units at the pole of the disk (angle over root 2), of unit direction `c` from the polygon's outline as seen from
  /// `position`: positive outside, negative where the polygon hides c. kNoOccluder where it is seen edge on.
  float distance(const Vec3& position, const Vec3& c) const;
  /// How far along unit `c` its plane is; infinite where it lies behind.
  float along(const Vec3& position, const Vec3& c) const;

 private:
  std::vector<Vec3> corners_;  ///< counter-clockwise about normal_
  Vec3 normal_{0, 1, 0};
};

}  // namespace sightline::square_lights
