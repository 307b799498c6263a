// Are two noisy pictures pictures of the same thing? Replicates with independent seeds, and Student's t.
#pragma once

#include <string>
#include <vector>

#include "support/studio.h"

namespace sightline::test {

/// P(|T| > |t|) for Student's distribution.
double student_tail(double t, double degrees_of_freedom);

/// Pixel means of several renderings with independent seeds, and the standard errors that their scatter shows. Samples of one seed are
/// stratified against each other, so only the scatter between seeds is an honest error.
struct Replicates {
  int count = 0;
  std::vector<Vec3d> mean, error;  ///< a pixel
  Vec3d picture_mean{0}, picture_error{0};
};
Replicates replicate(const Shot& shot, Exposure exposure, int count);

/// Least p-value over all pixels and channels, corrected for their number, and that of the picture's mean.
struct PictureTest {
  double pixel_p = 1, mean_p = 1;
  std::string worst;  ///< for the failure message
};
PictureTest compare(const Replicates& a, const Replicates& b);
/// Against a known picture: `truth` has one colour a pixel.
PictureTest compare(const Replicates& a, const std::vector<Vec3d>& truth);

}  // namespace sightline::test
