// The matrices of pbrt's transform directives.
#pragma once

#include <span>

#include "scene/load/pbrt/state.h"

namespace sightline::pbrt {

/// Camera-from-world of pbrt's left-handed LookAt: +z from the eye to the target, +x = up × z. Identity where they are degenerate.
Mat4d look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up, bool* degenerate);
Mat4d rotation(double degrees, const Vec3d& axis);
Mat4d scaling(const Vec3d& factors);
Mat4d translation(const Vec3d& offset);
/// Sixteen numbers column by column, as Transform lists them.
Mat4d matrix(std::span<const double> columns);

bool is_finite_transform(const Mat4d& m);
/// Determinant of the linear part.
double determinant(const Mat4d& m);
bool is_identity(const Mat4d& m);
/// The factor if the linear part is a rotation (or reflection) times a uniform scale.
std::optional<double> uniform_scale(const Mat4d& m);

}  // namespace sightline::pbrt
