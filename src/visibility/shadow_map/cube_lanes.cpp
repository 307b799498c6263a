#include "visibility/shadow_map/cube_lanes.h"

#include <algorithm>
#include <cmath>

#include "visibility/shadow_map/depth_map.h"

namespace sightline {

// The scalar definition is DepthMap::locate. No branches and no sizes but 32 bits, so that compilers make vectors of the loop.
void CubeLanes::locate(std::uint32_t resolution, std::uint32_t tiles_across) {
  const float count = static_cast<float>(resolution), last = static_cast<float>(resolution - 1), texel_size = 1 / count;
  const auto texels = static_cast<std::int32_t>(DepthMap::kTileTexels), tiles = static_cast<std::int32_t>(tiles_across);
  for (std::size_t i = 0; i < kSize; ++i) {
    const float dx = x[i], dy = y[i], dz = z[i], normal_x = nx[i], normal_y = ny[i], normal_z = nz[i];
    const float ax = std::fabs(dx), ay = std::fabs(dy), az = std::fabs(dz);
    // Of the largest component: first y against z, then x against both.
    const bool is_y = ay >= az, is_x = ax >= std::max(ay, az);
    const float along_yz = is_y ? dy : dz, b_yz = is_y ? dz : dx, c_yz = is_y ? dx : dy;
    const float along = is_x ? dx : along_yz, b = is_x ? dy : b_yz, c = is_x ? dz : c_yz;
    const float major = std::fabs(along), inverse = 1 / (major > 0 ? major : 1.f);
    float u = (0.5f * (b * inverse) + 0.5f) * count, v = (0.5f * (c * inverse) + 0.5f) * count;
    u = u > 0 ? u : 0.f, v = v > 0 ? v : 0.f;
    u = u < last ? u : last, v = v < last ? v : last;
    const auto column = static_cast<std::int32_t>(u), row = static_cast<std::int32_t>(v);
    const std::int32_t axis_yz = is_y ? 2 : 4, axis = is_x ? 0 : axis_yz, side = along < 0 ? 1 : 0, face = axis + side;
    const std::int32_t tile = (face * tiles + (row >> 5)) * tiles + (column >> 5);
    const std::int32_t within = (((row >> 2) & 7) << 7) | (((column >> 2) & 7) << 4) | ((row & 3) << 2) | (column & 3);
    texel[i] = static_cast<std::uint32_t>(tile * texels + within);
    const float squared = (dx * dx + dy * dy) + dz * dz;
    const float height = std::fabs((normal_x * dx + normal_y * dy) + normal_z * dz);
    const float normal_size = (std::fabs(normal_x) + std::fabs(normal_y)) + std::fabs(normal_z);
    const float below = squared - height * height;
    const float across = std::sqrt(below > 0 ? below : 0.f), least = 1e-4f * across, divisor = height > least ? height : least;
    // Without a normal, or on the axis through the light, nothing leans.
    const float leaning = normal_size * divisor;
    const float bends = 2 * major * texel_size * (across / (leaning > 0 ? divisor : 1.f));
    distance[i] = std::sqrt(squared);
    change[i] = leaning > 0 ? bends : 0.f;
  }
}

}  // namespace sightline
