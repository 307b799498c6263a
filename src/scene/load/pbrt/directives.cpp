// One function a directive.
#include <array>

#include "scene/load/pbrt/reader.h"
#include "scene/load/pbrt/transform.h"

namespace sightline::pbrt {

std::span<const Reader::Directive> Reader::directives() {
  // In alphabetical order, for the binary search.
  static constexpr std::array kDirectives = {
      Directive{"Accelerator", &Reader::accelerator},
      Directive{"ActiveTransform", &Reader::active_transform},
      Directive{"AreaLightSource", &Reader::area_light_source},
      Directive{"Attribute", &Reader::attribute},
      Directive{"AttributeBegin", &Reader::attribute_begin},
      Directive{"AttributeEnd", &Reader::attribute_end},
      Directive{"Camera", &Reader::camera},
      Directive{"ColorSpace", &Reader::color_space},
      Directive{"ConcatTransform", &Reader::concat_transform},
      Directive{"CoordSysTransform", &Reader::coord_sys_transform},
      Directive{"CoordinateSystem", &Reader::coordinate_system},
      Directive{"Film", &Reader::film},
      Directive{"Identity", &Reader::identity},
      Directive{"Import", &Reader::import_file},
      Directive{"Include", &Reader::include_file},
      Directive{"Integrator", &Reader::integrator},
      Directive{"LightSource", &Reader::light_source},
      Directive{"LookAt", &Reader::look_at_directive},
      Directive{"MakeNamedMaterial", &Reader::make_named_material},
      Directive{"MakeNamedMedium", &Reader::make_named_medium},
      Directive{"Material", &Reader::material},
      Directive{"MediumInterface", &Reader::medium_interface},
      Directive{"NamedMaterial", &Reader::named_material},
      Directive{"ObjectBegin", &Reader::object_begin},
      Directive{"ObjectEnd", &Reader::object_end},
      Directive{"ObjectInstance", &Reader::object_instance},
      Directive{"Option", &Reader::option},
      Directive{"PixelFilter", &Reader::pixel_filter},
      Directive{"Renderer", &Reader::unsupported},
      Directive{"ReverseOrientation", &Reader::reverse_orientation},
      Directive{"Rotate", &Reader::rotate},
      Directive{"Sampler", &Reader::sampler},
      Directive{"Scale", &Reader::scale},
      Directive{"SearchPath", &Reader::unsupported},
      Directive{"Shape", &Reader::shape},
      Directive{"SurfaceIntegrator", &Reader::unsupported},
      Directive{"Texture", &Reader::texture},
      Directive{"Transform", &Reader::transform_directive},
      Directive{"TransformBegin", &Reader::transform_begin},
      Directive{"TransformEnd", &Reader::transform_end},
      Directive{"TransformTimes", &Reader::transform_times},
      Directive{"Translate", &Reader::translate},
      Directive{"Volume", &Reader::unsupported},
      Directive{"VolumeIntegrator", &Reader::unsupported},
      Directive{"WorldBegin", &Reader::world_begin},
      Directive{"WorldEnd", &Reader::world_end},
  };
  return kDirectives;
}

// Transformations

void Reader::identity(Tokenizer&, const Place& place) { set_transform(Mat4d(1), place); }

void Reader::translate(Tokenizer& tokens, const Place& place) {
  const std::vector<double> v = read_numbers(tokens, 3);
  transform(translation({v[0], v[1], v[2]}), place);
}

void Reader::scale(Tokenizer& tokens, const Place& place) {
  const std::vector<double> v = read_numbers(tokens, 3);
  transform(scaling({v[0], v[1], v[2]}), place);
}

void Reader::rotate(Tokenizer& tokens, const Place& place) {
  const std::vector<double> v = read_numbers(tokens, 4);
  transform(rotation(v[0], {v[1], v[2], v[3]}), place);
}

void Reader::look_at_directive(Tokenizer& tokens, const Place& place) {
  const std::vector<double> v = read_numbers(tokens, 9);
  bool degenerate = false;
  const Mat4d m = look_at({v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}, &degenerate);
  if (degenerate) throw error_at(place, "LookAt: the up vector is parallel to the direction of view, or eye and target coincide");
  transform(m, place);
}

void Reader::transform_directive(Tokenizer& tokens, const Place& place) { set_transform(matrix(read_numbers(tokens, 16)), place); }
void Reader::concat_transform(Tokenizer& tokens, const Place& place) { transform(matrix(read_numbers(tokens, 16)), place); }

void Reader::coordinate_system(Tokenizer& tokens, const Place&) {
  coordinate_systems_.insert_or_assign(read_string(tokens, "a name"), state_.world_from_object);
}

void Reader::coord_sys_transform(Tokenizer& tokens, const Place& place) {
  const std::string name = read_string(tokens, "a name");
  const auto found = coordinate_systems_.find(name);
  if (found != coordinate_systems_.end())
    set_transform(found->second, place);
  else
    builder_.warn(place, fmt::format("there is no coordinate system '{}'", shown(name)));
}

void Reader::active_transform(Tokenizer& tokens, const Place& place) {
  const Token token = tokens.next();
  if (token.text != "StartTime" && token.text != "EndTime" && token.text != "All") {
    throw error_at(tokens.place(token), fmt::format("'{}' is none of StartTime, EndTime, All", shown(token.text)));
  }
  builder_.warn_once(place, "motion is not supported; everything stands as at the shutter's opening");
  state_.transforms_at_start = token.text != "EndTime";
}

void Reader::transform_times(Tokenizer& tokens, const Place&) { read_numbers(tokens, 2); }

// Attributes

void Reader::attribute_begin(Tokenizer&, const Place& place) { push(Saved::Opener::attribute, place); }
void Reader::attribute_end(Tokenizer&, const Place& place) { pop(Saved::Opener::attribute, place); }
// As in pbrt-v4, where it is an old name of AttributeBegin.
void Reader::transform_begin(Tokenizer&, const Place& place) { push(Saved::Opener::transform, place); }
void Reader::transform_end(Tokenizer&, const Place& place) { pop(Saved::Opener::transform, place); }

void Reader::attribute(Tokenizer& tokens, const Place& place) {
  constexpr std::size_t kMostDefaults = 64;
  const std::string target = read_string(tokens, "what the attribute is for");
  const ParameterList parameters = read_parameters(tokens, place);
  if (target != "shape" && target != "light" && target != "material" && target != "medium" && target != "texture") {
    builder_.warn(place, fmt::format("there are no attributes for '{}'", shown(target)));
    return;
  }
  auto defaults = std::make_shared<DefaultParameters>(state_.defaults ? *state_.defaults : DefaultParameters());
  std::vector<Parameter>& list = (*defaults)[target];
  for (const Parameter& parameter : parameters.all()) {
    std::erase_if(list, [&](const Parameter& old) { return old.name == parameter.name; });
    list.push_back(parameter);
  }
  if (list.size() > kMostDefaults) throw error_at(place, fmt::format("more than {} default parameters", kMostDefaults));
  state_.defaults = std::move(defaults);
}

void Reader::reverse_orientation(Tokenizer&, const Place&) { state_.reverse_orientation = !state_.reverse_orientation; }

void Reader::color_space(Tokenizer& tokens, const Place& place) {
  const std::string name = read_string(tokens, "the name of a colour space");
  const std::optional<ColorSpace> space = parse_color_space(name);
  if (!space) builder_.warn(place, fmt::format("colour space '{}' is unknown; srgb is used", shown(name)));
  state_.color_space = space.value_or(ColorSpace::srgb);
}

// Before WorldBegin

void Reader::camera(Tokenizer& tokens, const Place& place) {
  const std::string type = read_string(tokens, "a camera type");
  const ParameterList parameters = read_parameters(tokens, place);
  if (!before_world("Camera", place)) return;
  builder_.camera(type, parameters, state_.world_from_object, place);
  coordinate_systems_.insert_or_assign("camera", glm::inverse(state_.world_from_object));
}

void Reader::film(Tokenizer& tokens, const Place& place) {
  const std::string type = read_string(tokens, "a film type");
  const ParameterList parameters = read_parameters(tokens, place);
  if (before_world("Film", place)) builder_.film(type, parameters, place);
}

void Reader::integrator(Tokenizer& tokens, const Place& place) {
  const std::string type = read_string(tokens, "an integrator type");
  const ParameterList parameters = read_parameters(tokens, place);
  if (before_world("Integrator", place)) builder_.integrator(type, parameters, place);
}

void Reader::sampler(Tokenizer& tokens, const Place& place) {
  const std::string type = read_string(tokens, "a sampler type");
  const ParameterList parameters = read_parameters(tokens, place);
  if (before_world("Sampler", place)) builder_.sampler(type, parameters, place);
}

// How Sightline filters and traces is its own business.
void Reader::pixel_filter(Tokenizer& tokens, const Place& place) {
  read_string(tokens, "a filter type");
  read_parameters(tokens, place);
}

void Reader::accelerator(Tokenizer& tokens, const Place& place) {
  read_string(tokens, "an accelerator type");
  read_parameters(tokens, place);
}

void Reader::option(Tokenizer& tokens, const Place& place) {
  const ParameterList parameters = read_parameters(tokens, place);
  for (const Parameter& parameter : parameters.all()) {
    builder_.warn(parameter.place, fmt::format("option '{}' is ignored", shown(parameter.name)));
  }
}

void Reader::world_begin(Tokenizer&, const Place& place) {
  if (in_world_) throw error_at(place, "a second WorldBegin");
  in_world_ = true;
  state_.world_from_object = Mat4d(1);
  state_.transforms_at_start = true;
  coordinate_systems_.insert_or_assign("world", Mat4d(1));
}

// What follows has no meaning in pbrt-v4; pbrt-v3 demands it at the end.
void Reader::world_end(Tokenizer&, const Place& place) { require_world("WorldEnd", place); }

void Reader::unsupported(Tokenizer& tokens, const Place& place) {
  read_string(tokens, "a type");
  read_parameters(tokens, place);
  builder_.warn(place, "this directive of older pbrt versions is ignored");
}

// The world

void Reader::material(Tokenizer& tokens, const Place& place) {
  const std::string type = read_string(tokens, "a material type");
  state_.material = builder_.material(type, read_parameters(tokens, place, "material"), state_, place);
}

void Reader::make_named_material(Tokenizer& tokens, const Place& place) {
  const std::string name = read_string(tokens, "a name");
  builder_.named_material(name, read_parameters(tokens, place, "material"), state_, place);
}

void Reader::named_material(Tokenizer& tokens, const Place& place) {
  state_.material = builder_.use_named_material(read_string(tokens, "a name"), place);
}

void Reader::make_named_medium(Tokenizer& tokens, const Place& place) {
  const std::string name = read_string(tokens, "a name");
  builder_.named_medium(name, read_parameters(tokens, place, "medium"), state_, place);
}

void Reader::medium_interface(Tokenizer& tokens, const Place&) {
  state_.inside_medium = read_string(tokens, "the name of a medium");
  const bool has_outside = tokens.peek().kind == Token::Kind::string;
  state_.outside_medium = has_outside ? read_string(tokens, "the name of a medium") : state_.inside_medium;
}

void Reader::texture(Tokenizer& tokens, const Place& place) {
  const std::string name = read_string(tokens, "a name"), kind = read_string(tokens, "'float' or 'spectrum'");
  const std::string type = read_string(tokens, "a texture type");
  builder_.texture(name, kind, type, read_parameters(tokens, place, "texture"), state_, place);
}

void Reader::light_source(Tokenizer& tokens, const Place& place) {
  const std::string type = read_string(tokens, "a light type");
  const ParameterList parameters = read_parameters(tokens, place, "light");
  require_world("LightSource", place);
  builder_.light(type, parameters, state_, place);
}

void Reader::area_light_source(Tokenizer& tokens, const Place& place) {
  const std::string type = read_string(tokens, "a light type");
  const ParameterList parameters = read_parameters(tokens, place, "light");
  require_world("AreaLightSource", place);
  state_.area_light = builder_.area_light(type, parameters, state_, place);
}

void Reader::shape(Tokenizer& tokens, const Place& place) {
  const std::string type = read_string(tokens, "a shape type");
  const ParameterList parameters = read_parameters(tokens, place, "shape");
  require_world("Shape", place);
  builder_.shape(type, parameters, state_, place);
}

void Reader::object_begin(Tokenizer& tokens, const Place& place) {
  const std::string name = read_string(tokens, "a name");
  require_world("ObjectBegin", place);
  if (builder_.in_object()) throw error_at(place, "an object inside an object");
  push(Saved::Opener::object, place);
  builder_.begin_object(name, place);
}

void Reader::object_end(Tokenizer&, const Place& place) {
  pop(Saved::Opener::object, place);
  builder_.end_object();
}

void Reader::object_instance(Tokenizer& tokens, const Place& place) {
  const std::string name = read_string(tokens, "a name");
  require_world("ObjectInstance", place);
  if (builder_.in_object()) throw error_at(place, "an instance inside an object definition");
  builder_.instance(name, state_, place);
}

// Other files

void Reader::include_file(Tokenizer& tokens, const Place& place) { include(tokens, place); }

void Reader::import_file(Tokenizer& tokens, const Place& place) {
  // Unlike an included file, an imported one leaves the state as it was.
  const GraphicsState before = state_;
  const std::size_t open_blocks = saved_.size();
  include(tokens, place);
  if (saved_.size() != open_blocks) throw error_at(place, "the imported file leaves a block open or closes one that it did not open");
  state_ = before;
}

}  // namespace sightline::pbrt
