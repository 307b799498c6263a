// Helpers of the pbrt tests: scenes as strings.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "base/core/error.h"
#include "scene/load/load.h"

namespace sightline {

inline Scene parse_text(const std::string& text) {
  const Context context;
  return parse_pbrt(text, "test.pbrt", context);
}
/// What stands after WorldBegin on line 1.
inline Scene parse_world(const std::string& text) { return parse_text("WorldBegin\n" + text); }

inline bool warns_of(const Scene& scene, std::string_view part) {
  return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                     [&](const std::string& warning) { return warning.find(part) != std::string::npos; });
}

/// The message of the Error{input} that the text causes; empty if it causes none.
inline std::string error_of(const std::string& text) {
  try {
    parse_text(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
    return error.what();
  }
  return "";
}

inline constexpr const char* kTriangle =
    "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 0 0 1] \"integer indices\" [0 1 2]\n";

inline void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

inline Vec3 face_normal(const Mesh& mesh, std::size_t triangle = 0) {
  const UVec3& t = mesh.triangles[triangle];
  return glm::normalize(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

}  // namespace sightline
