// Shape, ObjectBegin and ObjectInstance.
#include <algorithm>
#include <cmath>

#include "base/settings/settings.h"
#include "scene/load/pbrt/builder.h"
#include "scene/load/pbrt/loop_subdivision.h"
#include "scene/load/pbrt/transform.h"

namespace sightline::pbrt {
namespace {

template <class V>
std::vector<V> to_vectors(std::span<const float> numbers) {
  constexpr std::size_t kComponents = sizeof(V) / sizeof(float);
  std::vector<V> result(numbers.size() / kComponents);
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (std::size_t c = 0; c < kComponents; ++c) result[i][static_cast<int>(c)] = numbers[i * kComponents + c];
  }
  return result;
}

/// Triangles that subdivision surfaces of one file may become.
constexpr std::uint64_t kMostSubdivided = 1 << 23;

/// The vertices of a mesh; pbrt-v3 has texture coordinates as "float uv" or "float st".
MeshArrays vertices_of(const ParameterList& parameters) {
  MeshArrays arrays;
  arrays.positions = to_vectors<Vec3>(parameters.numbers("P", "point3"));
  arrays.normals = to_vectors<Vec3>(parameters.numbers("N", "normal"));
  for (const std::string_view name : {"uv", "st"}) {
    if (arrays.uvs.empty() && parameters.has(name)) arrays.uvs = to_vectors<Vec2>(parameters.numbers(name, "point2 float"));
  }
  return arrays;
}

float positive(const ParameterList& parameters, std::string_view name, float fallback, const Place& place) {
  const float value = parameters.number(name, fallback);
  if (!(value > 0) || !std::isfinite(value)) throw error_at(place, fmt::format("\"float {}\" is not positive", name));
  return value;
}

float phi_max(const ParameterList& parameters) {
  const float degrees = parameters.number("phimax", 360);
  return glm::radians(degrees > 0 && degrees < 360 ? degrees : 360.f);
}

}  // namespace

Builder::Alpha Builder::alpha_parameter(const ParameterList& parameters) {
  Alpha alpha;
  if (const Parameter* const texture = parameters.find("alpha", "texture")) {
    alpha.texture = find_texture(*texture, false);
  } else {
    alpha.value = std::clamp(parameters.number("alpha", 1), 0.f, 1.f);
  }
  return alpha;
}

void Builder::shape(const std::string& type, const ParameterList& parameters, const GraphicsState& state, const Place& place) {
  ShapeEntry entry;
  entry.place = place;
  entry.name = type;
  entry.world_from_object = state.world_from_object;
  entry.reverse_orientation = state.reverse_orientation;
  entry.material = state.material;
  entry.area_light = state.area_light;
  entry.medium = state.inside_medium;
  entry.object = open_object_;
  entry.alpha = alpha_parameter(parameters);
  if (!state.outside_medium.empty()) {
    warn_once(place, fmt::format("medium '{}' outside of surfaces is not supported; only the inside of shapes absorbs",
                                 shown(state.outside_medium)));
  }
  if (entry.object != kNoSlot && entry.area_light != kNoSlot) {
    warn_once(place, "area lights inside object definitions do not emit, as in pbrt");
    entry.area_light = kNoSlot;
  }

  if (type == "plymesh") {
    const std::string file = parameters.text("filename", "");
    if (file.empty()) throw error_at(place, "a plymesh needs a \"string filename\"");
    if (parameters.has("displacement")) warn(place, "displacement of a plymesh is not supported");
    parameters.ignore({"displacement", "displacement.edgelength", "edgelength"});
    entry.file = resolve(file);
    entry.name = std::filesystem::path(file).stem().string();
    shapes_of_file_[entry.file.string()].push_back(shapes_.size());
    shapes_.push_back(std::move(entry));
  } else if (type == "trianglemesh") {
    triangle_mesh(std::move(entry), parameters);
  } else if (type == "loopsubdiv") {
    MeshArrays base = vertices_of(parameters);
    const std::span<const std::int32_t> indices = parameters.integers("indices");
    int levels = std::max(0, parameters.has("nlevels") ? parameters.integer("nlevels", 3) : parameters.integer("levels", 3));
    if (indices.size() % 3 != 0) throw error_at(place, fmt::format("{} indices are not whole triangles", indices.size()));
    parameters.ignore({"scheme"});
    const std::uint64_t room = kMostSubdivided - std::min(subdivided_, kMostSubdivided);
    const int wanted = levels;
    while (levels > 0 && (levels > 10 || ((indices.size() / 3) << (2 * levels)) > room)) --levels;
    if (levels < wanted) warn(place, fmt::format("{} levels of subdivision are too many; {} are done", wanted, levels));
    subdivided_ += (indices.size() / 3) << (2 * levels);
    add_mesh(std::move(entry), subdivide_loop(base.positions, indices, levels, place));
  } else if (type == "bilinearmesh") {
    bilinear_mesh(std::move(entry), parameters);
  } else if (type == "sphere") {
    sphere(std::move(entry), parameters);
  } else if (type == "disk") {
    const float radius = positive(parameters, "radius", 1, place);
    const float inner = std::clamp(parameters.number("innerradius", 0), 0.f, radius);
    const float height = parameters.number("height", 0);
    add_mesh(std::move(entry), disk_mesh(height, radius, inner, phi_max(parameters), fineness()));
  } else if (type == "cylinder") {
    const float radius = positive(parameters, "radius", 1, place);
    const float a = parameters.number("zmin", -1), b = parameters.number("zmax", 1);
    add_mesh(std::move(entry), cylinder_mesh(radius, std::min(a, b), std::max(a, b), phi_max(parameters), fineness()));
  } else {
    warn(place, fmt::format("shape '{}' is not supported; it is left out", shown(type)));
    for (const Parameter& parameter : parameters.all()) parameter.used = true;
  }
  report_unused(parameters, fmt::format("shape '{}'", shown(type)));
}

int Builder::fineness() const {
  // Coarser where a file has very many: what is made stays in proportion to what is read.
  return tessellated_ < (1 << 20) ? 96 : tessellated_ < (1 << 22) ? 32 : 12;
}

void Builder::add_mesh(ShapeEntry entry, MeshArrays arrays) {
  if (entry.name != "trianglemesh") tessellated_ += arrays.triangles.size();
  entry.mesh = bake(std::move(arrays), entry.world_from_object, entry.reverse_orientation, scene_.dropped_triangles);
  shapes_.push_back(std::move(entry));
}

void Builder::triangle_mesh(ShapeEntry entry, const ParameterList& parameters) {
  MeshArrays arrays = vertices_of(parameters);
  const std::span<const std::int32_t> indices = parameters.integers("indices");
  if (arrays.positions.empty()) throw error_at(entry.place, "a trianglemesh needs \"point3 P\"");
  if (indices.empty() && parameters.find("indices", "integer") == nullptr && arrays.positions.size() == 3) {
    arrays.triangles.emplace_back(0, 1, 2);  // pbrt's default for a single triangle
  } else if (indices.empty()) {
    throw error_at(entry.place, "a trianglemesh needs \"integer indices\"");
  }
  if (indices.size() % 3 != 0) {
    warn(entry.place, fmt::format("{} indices are not whole triangles; the rest is left out", indices.size()));
  }
  for (const auto& [name, count] : {std::pair<std::string_view, std::size_t>{"N", arrays.normals.size()}, {"uv", arrays.uvs.size()}}) {
    if (count != 0 && count != arrays.positions.size()) {
      warn(entry.place, fmt::format("{} '{}' for {} vertices; they are ignored", count, name, arrays.positions.size()));
    }
  }
  arrays.triangles.reserve(indices.size() / 3 + 1);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const UVec3 triangle(indices[i], indices[i + 1], indices[i + 2]);  // negative ones become too large
    for (int corner = 0; corner < 3; ++corner) {
      if (triangle[corner] < arrays.positions.size()) continue;
      throw error_at(entry.place, fmt::format("index {} is outside of the {} vertices", indices[i + static_cast<std::size_t>(corner)],
                                              arrays.positions.size()));
    }
    arrays.triangles.push_back(triangle);
  }
  parameters.ignore({"faceIndices"});
  add_mesh(std::move(entry), std::move(arrays));
}

void Builder::bilinear_mesh(ShapeEntry entry, const ParameterList& parameters) {
  MeshArrays arrays = vertices_of(parameters);
  const std::span<const std::int32_t> indices = parameters.integers("indices");
  std::vector<std::array<std::uint32_t, 4>> patches;
  if (indices.empty() && arrays.positions.size() == 4) patches.push_back({0, 1, 2, 3});
  if (patches.empty() && (indices.empty() || indices.size() % 4 != 0)) {
    throw error_at(entry.place, fmt::format("{} indices are not whole patches of four", indices.size()));
  }
  for (std::size_t i = 0; i + 3 < indices.size(); i += 4) {
    std::array<std::uint32_t, 4> patch{};
    for (std::size_t c = 0; c < 4; ++c) {
      patch[c] = static_cast<std::uint32_t>(indices[i + c]);
      if (patch[c] < arrays.positions.size()) continue;
      throw error_at(entry.place, fmt::format("index {} is outside of the {} vertices", indices[i + c], arrays.positions.size()));
    }
    patches.push_back(patch);
  }
  if (parameters.has("emissionfilename")) warn(entry.place, "emissionfilename is not supported");
  parameters.ignore({"emissionfilename", "faceIndices"});
  // Fewer pieces where there are many patches: what is made stays in proportion to what is read.
  const int steps = patches.size() <= 256 ? 16 : patches.size() <= 65536 ? 4 : 1;
  add_mesh(std::move(entry), bilinear_patches(arrays, patches, steps));
}

void Builder::sphere(ShapeEntry entry, const ParameterList& parameters) {
  const float radius = positive(parameters, "radius", 1, entry.place);
  const float z_min = parameters.number("zmin", -radius), z_max = parameters.number("zmax", radius);
  const float phi = phi_max(parameters);
  const bool is_whole = std::min(z_min, z_max) <= -radius && std::max(z_min, z_max) >= radius && phi >= 2 * kPi - 1e-5f;
  const std::optional<double> scale = uniform_scale(entry.world_from_object);
  if (!is_whole || !scale || entry.object != kNoSlot) {
    add_mesh(std::move(entry), sphere_mesh(radius, z_min, z_max, phi, fineness()));
    return;
  }
  Sphere sphere;
  sphere.name = entry.name;
  sphere.center = Vec3(entry.world_from_object[3]);
  sphere.radius = static_cast<float>(*scale) * radius;
  sphere.world_from_object = Mat4(entry.world_from_object);
  sphere.reverse_orientation = entry.reverse_orientation;
  if (!is_finite(sphere.center) || !std::isfinite(sphere.radius)) throw error_at(entry.place, "a sphere is not finite");
  entry.sphere = sphere;
  shapes_.push_back(std::move(entry));
}

void Builder::begin_object(const std::string& name, const Place& place) {
  objects_.push_back({name, place});
  open_object_ = static_cast<Slot>(objects_.size()) - 1;
  if (!object_names_.insert_or_assign(name, open_object_).second) {
    warn(place, fmt::format("object '{}' is defined again; instances that follow use this one", shown(name)));
  }
}

void Builder::instance(const std::string& name, const GraphicsState& state, const Place& place) {
  const auto found = object_names_.find(name);
  if (found == object_names_.end()) {
    std::vector<std::string> known;
    known.reserve(object_names_.size());
    for (const auto& [known_name, slot] : object_names_) known.push_back(known_name);
    const std::string nearest = nearest_name(name, known);
    warn(place,
         fmt::format("there is no object '{}'{}", shown(name), nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest)));
    return;
  }
  instances_.push_back({found->second, state.world_from_object});
}

}  // namespace sightline::pbrt
