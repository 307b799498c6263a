// Reads directives and hands them to the Builder, keeping the graphics state.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/context.h"
#include "scene/load/pbrt/builder.h"
#include "scene/load/pbrt/state.h"
#include "scene/load/pbrt/tokenizer.h"

namespace sightline::pbrt {

class Reader {
 public:
  /// `directory`: of the main file, where includes are looked up first, as pbrt does; nothing = includes are errors.
  Reader(Builder& builder, std::optional<std::filesystem::path> directory, const Context& context);

  void read_text(std::string_view text, const std::string& name);
  void read_file(const std::filesystem::path& path);
  /// Throws Error{input} if something is still open.
  void finish();

 private:
  using Handler = void (Reader::*)(Tokenizer&, const Place&);
  struct Directive {
    std::string_view name;
    Handler handle;
  };
  static std::span<const Directive> directives();

  struct Saved {
    GraphicsState state;
    enum class Opener { attribute, transform, object } opener;
    Place place;
  };

  void read(Tokenizer& tokens);
  std::string read_string(Tokenizer& tokens, std::string_view what);
  std::vector<double> read_numbers(Tokenizer& tokens, std::size_t count);
  ParameterList read_parameters(Tokenizer& tokens, const Place& place, std::string_view defaults = {});
  void transform(const Mat4d& m, const Place& place);
  void set_transform(const Mat4d& m, const Place& place);
  void push(Saved::Opener opener, const Place& place);
  void pop(Saved::Opener opener, const Place& place);
  void require_world(std::string_view what, const Place& place) const;
  /// False, with a warning, after WorldBegin.
  bool before_world(std::string_view what, const Place& place);
  void include(Tokenizer& tokens, const Place& place);

  // one function a directive (directives.cpp)
  void accelerator(Tokenizer&, const Place&);
  void active_transform(Tokenizer&, const Place&);
  void area_light_source(Tokenizer&, const Place&);
  void attribute(Tokenizer&, const Place&);
  void attribute_begin(Tokenizer&, const Place&);
  void attribute_end(Tokenizer&, const Place&);
  void camera(Tokenizer&, const Place&);
  void color_space(Tokenizer&, const Place&);
  void concat_transform(Tokenizer&, const Place&);
  void coordinate_system(Tokenizer&, const Place&);
  void coord_sys_transform(Tokenizer&, const Place&);
  void film(Tokenizer&, const Place&);
  void identity(Tokenizer&, const Place&);
  void import_file(Tokenizer&, const Place&);
  void include_file(Tokenizer&, const Place&);
  void integrator(Tokenizer&, const Place&);
  void light_source(Tokenizer&, const Place&);
  void look_at_directive(Tokenizer&, const Place&);
  void make_named_material(Tokenizer&, const Place&);
  void make_named_medium(Tokenizer&, const Place&);
  void material(Tokenizer&, const Place&);
  void medium_interface(Tokenizer&, const Place&);
  void named_material(Tokenizer&, const Place&);
  void object_begin(Tokenizer&, const Place&);
  void object_end(Tokenizer&, const Place&);
  void object_instance(Tokenizer&, const Place&);
  void option(Tokenizer&, const Place&);
  void pixel_filter(Tokenizer&, const Place&);
  void reverse_orientation(Tokenizer&, const Place&);
  void rotate(Tokenizer&, const Place&);
  void sampler(Tokenizer&, const Place&);
  void scale(Tokenizer&, const Place&);
  void shape(Tokenizer&, const Place&);
  void texture(Tokenizer&, const Place&);
  void transform_begin(Tokenizer&, const Place&);
  void transform_directive(Tokenizer&, const Place&);
  void transform_end(Tokenizer&, const Place&);
  void transform_times(Tokenizer&, const Place&);
  void translate(Tokenizer&, const Place&);
  void world_begin(Tokenizer&, const Place&);
  void world_end(Tokenizer&, const Place&);
  void unsupported(Tokenizer&, const Place&);

  Builder& builder_;
  std::optional<std::filesystem::path> directory_;
  const Context& context_;
  GraphicsState state_;
  std::vector<Saved> saved_;
  std::map<std::string, Mat4d, std::less<>> coordinate_systems_;
  bool in_world_ = false;
  Place end_;                                      ///< of the main file, for what is missing at its end
  std::vector<std::filesystem::path> open_files_;  ///< being read, outermost first
  std::map<std::string, std::uint64_t, std::less<>> bytes_included_;
  std::uint64_t included_bytes_ = 0, includes_ = 0;
};

}  // namespace sightline::pbrt
