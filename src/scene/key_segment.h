// Where a time falls between the keys of a track.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace sightline {

/// The key before a time and the fraction of the way to the next. Clamped at the ends.
struct KeySegment {
  std::size_t first = 0;
  float fraction = 0;
  float duration_s = 0;
};

inline KeySegment find_segment(std::span<const float> times_s, float time_s) {
  if (times_s.size() < 2 || !(time_s > times_s.front())) return {};
  if (time_s >= times_s.back()) return {times_s.size() - 1, 0, 0};
  const auto next = std::upper_bound(times_s.begin(), times_s.end(), time_s);
  const auto first = static_cast<std::size_t>(next - times_s.begin()) - 1;
  const float duration_s = times_s[first + 1] - times_s[first];
  return {first, (time_s - times_s[first]) / duration_s, duration_s};
}

/// Cubic Hermite spline over one segment [glTF2, Appendix C]: stored tangents are per second, hence the factor of its duration.
template <class T>
T hermite(const KeySegment& segment, const T& p0, const T& out_tangent0, const T& in_tangent1, const T& p1) {
  const T m0 = segment.duration_s * out_tangent0, m1 = segment.duration_s * in_tangent1;
  const float t = segment.fraction, t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * p0 + (t3 - 2 * t2 + t) * m0 + (3 * t2 - 2 * t3) * p1 + (t3 - t2) * m1;
}

}  // namespace sightline
