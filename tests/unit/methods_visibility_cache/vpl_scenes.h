// Rooms for virtual point lights, and their indirect light by path tracing.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "film/view.h"
#include "methods/visibility_cache/virtual_point_lights.h"
#include "world/world.h"

namespace sightline::test {

struct Room {
  std::string name;
  std::shared_ptr<const World> world;
  Camera camera;
};

enum class RoomLight { area, point, directional, environment };
/// A box of edge 2 around the origin with coloured walls and a block in it; directional light and environment come in by a window.
Room make_room(RoomLight light);
/// The block is gone, the walls are white, the light hangs from the ceiling; nothing leaves.
Room make_closed_box(float reflectance, const Color& radiance, float light_size);
/// A closed box with a ball and a sheet of the given material, whose normals are not those of the sheet; a point light.
Room make_room_of(const SurfaceModel& model);
/// A lamp shines on a ceiling, also by way of a mirror; or the mirror is a hole and the lamp's image stands behind it.
Room make_mirror_room(bool mirror);
/// The box with a slit in a wall, on wide ground in the sun: hardly any light gets in.
Room make_slit_room();

struct Receiver {
  Vec3 position, normal;
};
/// Points of the walls of rooms, on the floor and at a wall.
std::vector<Receiver> receivers();

struct Mean {
  Color value{0}, error{0};
};
/// Irradiance by light that was reflected once up to `max_bounces` times, by paths from the receiver with a light sample at each surface.
/// Surfaces are Lambert where max_bounces is above 1.
Mean path_traced_irradiance(const World& world, const Receiver& receiver, int max_bounces, int paths, std::uint32_t seed);
/// The same by virtual point lights with exact visibility.
Color virtual_irradiance(const World& world, const Receiver& receiver, const VirtualPointLights& lights);
/// Mean over seeds [first_seed, first_seed + seeds).
std::vector<Mean> mean_virtual_irradiance(const Room& room, const std::vector<Receiver>& at, VirtualPointLightOptions options, int seeds);

}  // namespace sightline::test
