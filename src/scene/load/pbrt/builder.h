// Turns directives into a Scene. The reader calls one function a directive; finish() loads meshes and images in parallel and puts
// everything together.
#pragma once

#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "base/core/context.h"
#include "scene/load/pbrt/geometry.h"
#include "scene/load/pbrt/parameters.h"
#include "scene/load/pbrt/spectrum.h"
#include "scene/load/pbrt/state.h"
#include "scene/scene.h"

namespace sightline::pbrt {

class Builder {
 public:
  /// `directory`: where relative file names are looked up; nothing = no other file may be read.
  Builder(std::optional<std::filesystem::path> directory, const Context& context);

  void warn(const Place& place, std::string_view message);
  /// The same, but the message appears once however often it is given.
  void warn_once(const Place& place, const std::string& message);
  /// Warns of every parameter that nobody asked for.
  void report_unused(const ParameterList& parameters, std::string_view directive);

  void film(const std::string& type, const ParameterList& parameters, const Place& place);
  void camera(const std::string& type, const ParameterList& parameters, const Mat4d& camera_from_world, const Place& place);
  void integrator(const std::string& type, const ParameterList& parameters, const Place& place);
  void sampler(const std::string& type, const ParameterList& parameters, const Place& place);

  void texture(const std::string& name, const std::string& kind, const std::string& type, const ParameterList& parameters,
               const GraphicsState& state, const Place& place);
  Slot material(const std::string& type, const ParameterList& parameters, const GraphicsState& state, const Place& place);
  void named_material(const std::string& name, const ParameterList& parameters, const GraphicsState& state, const Place& place);
  Slot use_named_material(const std::string& name, const Place& place);
  void named_medium(const std::string& name, const ParameterList& parameters, const GraphicsState& state, const Place& place);

  void light(const std::string& type, const ParameterList& parameters, const GraphicsState& state, const Place& place);
  Slot area_light(const std::string& type, const ParameterList& parameters, const GraphicsState& state, const Place& place);
  void shape(const std::string& type, const ParameterList& parameters, const GraphicsState& state, const Place& place);

  void begin_object(const std::string& name, const Place& place);
  void end_object() { open_object_ = kNoSlot; }
  bool in_object() const { return open_object_ != kNoSlot; }
  void instance(const std::string& name, const GraphicsState& state, const Place& place);

  /// Where a file named in the scene is; empty if no files may be read.
  std::filesystem::path resolve(const std::string& name) const;

  Scene finish();

 private:
  struct MaterialEntry {
    Material material;
    bool defined = true;
    Place place;  ///< of the definition, or of the first use while undefined
    Slot mix_first = kNoSlot, mix_second = kNoSlot;
    int depth = 0;  ///< of nested mixes
  };
  struct AreaLight {
    Color radiance{1};
    float power = -1;  ///< W for each triangle or sphere, as pbrt has it; < 0: not given
    bool two_sided = false;
    TextureId image;
    Place place;
  };
  struct Alpha {
    float value = 1;
    TextureId texture;
    auto operator<=>(const Alpha&) const = default;
  };
  struct ShapeEntry {
    Place place;
    std::string name;
    Mesh mesh;               ///< in world space (or the object's); of a file used twice or more: in its own space
    bool is_shared = false;  ///< the latter
    std::uint64_t dropped = 0;
    std::exception_ptr error;    ///< what went wrong while the file was read
    std::filesystem::path file;  ///< plymesh
    Mat4d world_from_object{1};
    bool reverse_orientation = false;
    std::optional<Sphere> sphere;
    Slot material = kNoSlot, area_light = kNoSlot, object = kNoSlot;
    std::string medium;
    Alpha alpha;
  };
  struct ObjectEntry {
    std::string name;
    Place place;
  };
  struct InstanceEntry {
    Slot object;
    Mat4d world_from_object;
  };
  struct TextureInfo {
    std::uint64_t cost = 1;  ///< nodes visited by one look-up
    int depth = 1;
  };
  struct ImageEntry {
    std::filesystem::path path;
    Place place;
    std::shared_ptr<const Image> image;
    ImageId id;  ///< in the finished scene
    std::vector<std::string> warnings;
  };
  struct EnvironmentEntry {
    std::optional<Slot> image;  ///< in images_
    Color scale{1};
    float illuminance = -1;
    Mat4d world_from_object{1};
    Place place;
  };
  struct MaterialKey {
    Slot material, area_light;
    std::string medium;
    Alpha alpha;
    Slot shape;  ///< of a light whose radiance follows from its own area
    auto operator<=>(const MaterialKey&) const = default;
  };

  // spectra
  struct SpectrumValue {
    std::optional<Spectrum> spectrum;  ///< or
    Color rgb{0};
  };
  std::optional<SpectrumValue> spectrum_value(const ParameterList& parameters, std::string_view name, ColorSpace space);
  Color light_color(const ParameterList& parameters, std::string_view name, const GraphicsState& state);
  Color surface_color(const ParameterList& parameters, std::string_view name, Color fallback, ColorSpace space);

  // textures
  TextureId add_texture(Texture texture, TextureInfo info);
  TextureId constant_texture(const Vec4& value);
  TextureId find_texture(const Parameter& parameter, bool spectrum);
  /// Child of a texture node: named texture or constant.
  TextureId texture_child(const ParameterList& parameters, std::string_view name, float fallback, bool spectrum, ColorSpace space);
  TextureInfo combined(std::initializer_list<TextureId> children, const Place& place) const;
  std::optional<Texture> image_texture(const ParameterList& parameters, const Place& place, bool spectrum);
  UvTransform uv_transform(const ParameterList& parameters, bool image_rows, const Place& place);
  Slot add_image(const std::string& name, const Place& place);
  bool has_transparency(TextureId texture) const;

  // material parameters
  ColorParam color_parameter(const ParameterList& parameters, std::string_view name, Color fallback, ColorSpace space);
  FloatParam float_parameter(const ParameterList& parameters, std::string_view name, float fallback);
  float dielectric_index(const ParameterList& parameters, const Place& place, ColorSpace space, std::string_view name = "eta");
  ConductorMaterial conductor(const ParameterList& parameters, const std::string& prefix, ColorSpace space, const Place& place);
  MaterialEntry make_material(const std::string& type, const ParameterList& parameters, const GraphicsState& state, const Place& place);
  std::optional<SurfaceModel> legacy_model(const std::string& type, const ParameterList& parameters, ColorSpace space, const Place& place);
  void roughness(const ParameterList& parameters, const std::string& prefix, FloatParam& alpha_u, FloatParam& alpha_v);

  // shapes
  void add_mesh(ShapeEntry entry, MeshArrays arrays);
  void triangle_mesh(ShapeEntry entry, const ParameterList& parameters);
  void bilinear_mesh(ShapeEntry entry, const ParameterList& parameters);
  void sphere(ShapeEntry entry, const ParameterList& parameters);
  int fineness() const;
  Alpha alpha_parameter(const ParameterList& parameters);

  // finish
  void load_files();
  void load_meshes_of(const std::vector<std::size_t>& shapes);
  void resolve_images();
  void resolve_environment();
  void add_shapes();
  void add_objects(const std::vector<std::vector<std::size_t>>& shapes_of_object);
  MaterialId material_of(std::size_t shape_index);
  MaterialId resolve_material(const MaterialKey& key, double area);
  MediumId medium_for(const std::string& name, const Place& place);

  std::optional<std::filesystem::path> directory_;
  const Context& context_;
  Scene scene_;
  float imaging_ratio_ = 1;
  std::set<std::string> said_;

  std::vector<MaterialEntry> materials_;
  std::map<std::string, Slot, std::less<>> material_names_;
  std::map<MaterialKey, MaterialId> resolved_materials_;
  std::vector<AreaLight> area_lights_;
  std::map<std::string, TextureId, std::less<>> float_textures_, spectrum_textures_;
  std::vector<TextureInfo> texture_info_;
  std::vector<ImageEntry> images_;
  std::map<std::string, Slot, std::less<>> image_slots_;
  std::map<std::string, MediumId, std::less<>> media_;
  std::vector<ShapeEntry> shapes_;
  std::map<std::string, std::vector<std::size_t>> shapes_of_file_;
  std::vector<ObjectEntry> objects_;
  std::map<std::string, Slot, std::less<>> object_names_;
  std::vector<InstanceEntry> instances_;
  std::optional<EnvironmentEntry> environment_;
  Slot open_object_ = kNoSlot;
  std::uint64_t tessellated_ = 0, subdivided_ = 0;  ///< triangles made so far
};

}  // namespace sightline::pbrt
