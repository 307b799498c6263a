// The camera as the other end of light paths: where on the film a point appears, and how densely camera rays pass there.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "film/view.h"

namespace sightline::bidirectional {

class CameraImportance {
 public:
  explicit CameraImportance(const View& view);

  /// A film whose pixels are points cannot be hit from the scene.
  bool has_light_image() const { return !filter_.empty(); }
  bool is_orthographic() const { return orthographic_; }
  /// Where on the lens rays start; the position of a pinhole.
  Vec3 lens_point(const Vec2& u) const;

  /// Density with which a camera ray from `origin` takes unit `direction` if its place on the film is uniform over all pixels: by solid
  /// angle; by area across the beam for orthographic cameras. Beyond the film's edge the same formula goes on.
  double pdf(const Vec3& origin, const Vec3& direction) const;

  struct Projection {
    Vec2 film{0};              ///< pixels from the top left corner
    Vec3 direction{0, 0, -1};  ///< unit, the camera ray's
    Vec3 origin{0};            ///< of the camera ray
    float distance = 0;        ///< from there to the point
    double pdf = 0;            ///< as above
  };
  /// The camera ray from the lens point that meets `point`; nothing behind the camera or farther from the film than filters reach.
  std::optional<Projection> project(const Vec3& lens_point, const Vec3& point) const;

  /// One pixel's share in light that arrives at a film position.
  struct Share {
    std::uint32_t pixel;
    float weight;  ///< density of the pixel's filter, per pixel²
  };
  static constexpr int kMaxShares = 16;
  /// All shares of a film position; the number written.
  int shares(const Vec2& film, Share* out) const;

 private:
  struct Plane {
    Vec3 x, y, origin;  ///< rays from the lens point go along origin + film.x x + film.y y
  };
  Plane plane_from(const Vec3& lens_point) const;
  float filter_density(float offset) const;

  int width_, height_;
  bool orthographic_;
  float lens_radius_, focal_distance_;
  Vec3 position_, axis_x_, axis_y_;
  Plane plane_;             ///< at depth 1; of the rays' origins for orthographic cameras
  Vec3 view_direction_{0};  ///< orthographic
  double determinant_ = 1;  ///< orthographic: area of a pixel across the beam
  /// Offsets between which lies the same part of a pixel's samples; empty if all are at the centre.
  std::vector<float> filter_;
  std::vector<std::uint32_t> filter_guide_;  ///< where to begin looking in filter_, for equal steps of the offset
};

}  // namespace sightline::bidirectional
