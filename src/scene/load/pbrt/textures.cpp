// Texture directives.
#include <cmath>

#include "scene/load/pbrt/builder.h"

#include "base/settings/settings.h"

namespace sightline::pbrt {
namespace {

// A texture that is made of textures is evaluated recursively, so both the depth and the number of visits must stay bounded whatever
// a file says.
constexpr int kMaxTextureDepth = 32;
constexpr std::uint64_t kMaxTextureCost = 4096;

}  // namespace

TextureId Builder::add_texture(Texture texture, TextureInfo info) {
  scene_.textures.push_back(std::move(texture));
  texture_info_.push_back(info);
  return TextureId(scene_.textures.size() - 1);
}

TextureId Builder::constant_texture(const Vec4& value) { return add_texture({"", ConstantTexture{value}}, {}); }

TextureId Builder::find_texture(const Parameter& parameter, bool spectrum) {
  const std::string name = parameter.strings.empty() ? std::string() : parameter.strings.front();
  const auto& textures = spectrum ? spectrum_textures_ : float_textures_;
  if (const auto found = textures.find(name); found != textures.end()) return found->second;
  std::vector<std::string> known;
  known.reserve(textures.size());
  for (const auto& [known_name, id] : textures) known.push_back(known_name);
  const std::string nearest = nearest_name(name, known);
  warn(parameter.place, fmt::format("there is no {} texture '{}'{}; mid-grey is used", spectrum ? "spectrum" : "float", shown(name),
                                    nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest)));
  return constant_texture(Vec4(0.5f, 0.5f, 0.5f, 1));
}

TextureId Builder::texture_child(const ParameterList& parameters, std::string_view name, float fallback, bool spectrum, ColorSpace space) {
  if (const Parameter* const texture = parameters.find(name, "texture")) return find_texture(*texture, spectrum);
  const Color value = spectrum ? surface_color(parameters, name, Color(fallback), space) : Color(parameters.number(name, fallback));
  return constant_texture(Vec4(value, 1));
}

Builder::TextureInfo Builder::combined(std::initializer_list<TextureId> children, const Place& place) const {
  TextureInfo result;
  for (const TextureId child : children) {
    result.cost += texture_info_[child.index].cost;
    result.depth = std::max(result.depth, texture_info_[child.index].depth + 1);
  }
  if (result.depth > kMaxTextureDepth || result.cost > kMaxTextureCost) throw error_at(place, "textures are nested too deeply");
  return result;
}

UvTransform Builder::uv_transform(const ParameterList& parameters, bool image_rows, const Place& place) {
  if (const std::string mapping = parameters.text("mapping", "uv"); mapping != "uv") {
    warn(place, fmt::format("texture mapping '{}' is not supported; the surface's own coordinates are used", shown(mapping)));
    parameters.ignore({"v1", "v2"});
  }
  const Vec2 scale(parameters.number("uscale", 1), parameters.number("vscale", 1));
  const Vec2 delta(parameters.number("udelta", 0), parameters.number("vdelta", 0));
  // pbrt: (s, t) = scale (u, v) + delta with v = 0 at the bottom; images are looked up at 1 - t. Ours has v' = 1 - v.
  UvTransform result;
  if (image_rows) {
    result.matrix = glm::mat2(scale.x, 0, 0, scale.y);
    result.offset = {delta.x, 1 - scale.y - delta.y};
  } else {
    result.matrix = glm::mat2(scale.x, 0, 0, -scale.y);
    result.offset = {delta.x, scale.y + delta.y};
  }
  return result;
}

Slot Builder::add_image(const std::string& name, const Place& place) {
  const std::filesystem::path path = resolve(name);
  const auto [found, is_new] = image_slots_.try_emplace(path.string(), static_cast<Slot>(images_.size()));
  if (is_new) images_.push_back({path, place, nullptr, {}, {}});
  return found->second;
}

std::optional<Texture> Builder::image_texture(const ParameterList& parameters, const Place& place, bool spectrum) {
  const std::string file = parameters.text("filename", "");
  ImageTexture node;
  node.uv = uv_transform(parameters, true, place);
  node.scale = parameters.number("scale", 1);
  node.invert = parameters.boolean("invert", false);

  const std::string filter = parameters.text("filter", "bilinear");
  if (filter == "point") {
    node.filter = TextureFilter::nearest;
  } else if (filter == "bilinear") {
    node.filter = TextureFilter::linear;
  } else if (filter == "trilinear" || filter == "EWA" || filter == "ewa") {
    node.filter = TextureFilter::trilinear;
  } else {
    warn(place, fmt::format("texture filter '{}' is unknown; bilinear is used", shown(filter)));
    node.filter = TextureFilter::linear;
  }

  const std::string wrap = parameters.text("wrap", "repeat");
  if (wrap == "black") {
    node.wrap_u = node.wrap_v = Wrap::black;
  } else if (wrap == "clamp") {
    node.wrap_u = node.wrap_v = Wrap::clamp;
  } else if (wrap != "repeat") {
    warn(place, fmt::format("texture wrap mode '{}' is not supported; repeat is used", shown(wrap)));
  }

  // Like pbrt, 8-bit data is sRGB unless said otherwise, also for float textures; float formats are always linear (the sampler knows).
  const std::string encoding = parameters.text("encoding", "sRGB");
  if (encoding == "linear") {
    node.encoding = ColorEncoding::linear;
  } else if (encoding != "sRGB") {
    warn(place, fmt::format("texture encoding '{}' is read as sRGB", shown(encoding)));
  }
  parameters.ignore({"maxanisotropy"});
  if (!spectrum) parameters.ignore({"trilinear"});
  if (file.empty()) {
    warn(place, "an imagemap without a filename; mid-grey is used");
    return std::nullopt;
  }
  // Until images are loaded, the id is the slot in images_.
  node.image = ImageId(static_cast<std::size_t>(add_image(file, place)));
  return Texture{"", node};
}

void Builder::texture(const std::string& name, const std::string& kind, const std::string& type, const ParameterList& parameters,
                      const GraphicsState& state, const Place& place) {
  const bool spectrum = kind == "spectrum" || kind == "color";
  if (!spectrum && kind != "float") throw error_at(place, fmt::format("a texture is 'float' or 'spectrum', not '{}'", shown(kind)));
  std::map<std::string, TextureId, std::less<>>& textures = spectrum ? spectrum_textures_ : float_textures_;
  const auto child = [&](std::string_view child_name, float fallback) {
    return texture_child(parameters, child_name, fallback, spectrum, state.color_space);
  };

  Texture texture{name, ConstantTexture{Vec4(0.5f, 0.5f, 0.5f, 1)}};
  TextureInfo info;
  if (type == "imagemap") {
    if (std::optional<Texture> image = image_texture(parameters, place, spectrum)) texture.node = image->node;
  } else if (type == "constant") {
    const Color value = spectrum ? surface_color(parameters, "value", Color(1), state.color_space) : Color(parameters.number("value", 1));
    texture.node = ConstantTexture{Vec4(value, 1)};
  } else if (type == "scale") {
    const bool old_names = parameters.has("tex1") || parameters.has("tex2");
    ScaleTexture node;
    node.texture = child(old_names ? "tex1" : "tex", 1);
    if (old_names) {
      node.factor = child("tex2", 1);
    } else {
      // The factor is a float texture also where colours are scaled.
      node.factor = texture_child(parameters, "scale", 1, false, state.color_space);
    }
    info = combined({node.texture, node.factor}, place);
    texture.node = node;
  } else if (type == "mix") {
    MixTexture node{child("tex1", 0), child("tex2", 1), texture_child(parameters, "amount", 0.5f, false, state.color_space)};
    info = combined({node.first, node.second, node.amount}, place);
    texture.node = node;
  } else if (type == "checkerboard" && parameters.integer("dimension", 2) == 2) {
    CheckerboardTexture node{child("tex1", 1), child("tex2", 0), uv_transform(parameters, false, place)};
    info = combined({node.even, node.odd}, place);
    texture.node = node;
    parameters.ignore({"aamode"});
  } else {
    warn(place, fmt::format("texture type '{}' is not supported{}; mid-grey is used", shown(type),
                            type == "checkerboard" ? " in three dimensions" : ""));
    for (const Parameter& parameter : parameters.all()) parameter.used = true;
  }
  report_unused(parameters, fmt::format("texture type '{}'", shown(type)));
  textures.insert_or_assign(name, add_texture(std::move(texture), info));
}

bool Builder::has_transparency(TextureId texture) const {
  const auto* const node = std::get_if<ImageTexture>(&scene_.textures[texture.index].node);
  if (node == nullptr || !node->image.valid()) return false;
  const Image& image = *scene_.images[node->image.index].image;
  if (image.channels != 4 && image.channels != 2) return false;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.value(x, y, image.channels - 1) < 1) return true;
    }
  }
  return false;
}

}  // namespace sightline::pbrt
