#pragma once

#include <vector>

namespace sightline {

/// Middle value of a sorted copy; the upper one of two. 0 for nothing.
double median(std::vector<double> values);

}  // namespace sightline
