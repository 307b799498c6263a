#include "scene/load/pbrt/transform.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace sightline::pbrt {

Mat4d look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up, bool* degenerate) {
  const Vec3d forward = glm::normalize(target - eye);
  const Vec3d side = glm::cross(glm::normalize(up), forward);
  *degenerate = !(glm::length(side) > 1e-9);
  if (*degenerate) return Mat4d(1);
  const Vec3d right = glm::normalize(side);
  const Vec3d above = glm::cross(forward, right);
  return glm::inverse(Mat4d(glm::dvec4(right, 0), glm::dvec4(above, 0), glm::dvec4(forward, 0), glm::dvec4(eye, 1)));
}

Mat4d rotation(double degrees, const Vec3d& axis) {
  const double length = glm::length(axis);
  return length > 0 ? glm::rotate(Mat4d(1), glm::radians(degrees), axis / length) : Mat4d(1);
}

Mat4d scaling(const Vec3d& factors) { return glm::scale(Mat4d(1), factors); }
Mat4d translation(const Vec3d& offset) { return glm::translate(Mat4d(1), offset); }

Mat4d matrix(std::span<const double> columns) {
  Mat4d m(1);
  for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = columns[static_cast<std::size_t>(i)];
  return m;
}

bool is_finite_transform(const Mat4d& m) {
  for (int i = 0; i < 16; ++i) {
    if (!std::isfinite(m[i / 4][i % 4])) return false;
  }
  return true;
}

double determinant(const Mat4d& m) { return glm::determinant(Mat3d(m)); }

bool is_identity(const Mat4d& m) { return m == Mat4d(1); }

std::optional<double> uniform_scale(const Mat4d& m) {
  const Mat3d linear(m);
  const Mat3d gram = glm::transpose(linear) * linear;
  const double squared = (gram[0][0] + gram[1][1] + gram[2][2]) / 3;
  if (!(squared > 0) || !std::isfinite(squared)) return std::nullopt;
  for (int i = 0; i < 9; ++i) {
    if (std::fabs(gram[i / 3][i % 3] - (i / 3 == i % 3 ? squared : 0)) > 1e-4 * squared) return std::nullopt;
  }
  return std::sqrt(squared);
}

}  // namespace sightline::pbrt
