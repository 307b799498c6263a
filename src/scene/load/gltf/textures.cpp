#include "scene/load/gltf/textures.h"

#include <cmath>

#include "base/core/error.h"
#include "base/parallel/parallel.h"
#include "image/io/image_io.h"
#include "scene/load/gltf/uri.h"
#include "scene/load/load.h"

namespace sightline::gltf {
namespace {

Wrap wrap_of(const JsonView& sampler, std::string_view key) {
  switch (sampler.unsigned_or(key, 10497)) {
    case 33071:
      return Wrap::clamp;
    case 33648:
      return Wrap::mirror;
    default:
      return Wrap::repeat;
  }
}

/// glTF filters are OpenGL's: a magnification filter, and a minification filter that may have MIP levels.
TextureFilter filter_of(const JsonView& sampler) {
  constexpr std::uint64_t kNearest = 9728, kLinear = 9729;
  if (sampler.unsigned_or("magFilter", kLinear) == kNearest) return TextureFilter::nearest;
  const std::uint64_t minification = sampler.unsigned_or("minFilter", 0);
  return minification == kNearest || minification == kLinear ? TextureFilter::linear : TextureFilter::trilinear;
}

/// KHR_texture_transform scales, rotates, then moves. v points down, so that a counter-clockwise turn has its sines the other way
/// round than in a plane whose y points up.
UvTransform uv_transform_of(const JsonView& transform) {
  Vec2 offset{0}, scale{1};
  transform.vector_or("offset", {&offset.x, 2});
  transform.vector_or("scale", {&scale.x, 2});
  const float angle = transform.number_or("rotation", 0);
  const float c = std::cos(angle), s = std::sin(angle);
  return {.matrix = glm::mat2(scale.x * Vec2(c, -s), scale.y * Vec2(s, c)), .offset = offset};
}

}  // namespace

std::uint64_t texture_coordinate_set(const JsonView& texture_info) {
  const std::uint64_t set = texture_info.unsigned_or("texCoord", 0);
  const std::optional<JsonView> transform = texture_info.extension("KHR_texture_transform");
  return transform ? transform->unsigned_or("texCoord", set) : set;
}

TextureId TextureImporter::add(const JsonView& texture_info, ColorEncoding encoding) {
  const std::size_t index = import_.document.resolve("textures", texture_info.require("index"));
  const JsonView texture = import_.document.element("textures", index);
  const std::optional<JsonView> source = texture.find("source");
  if (!source) {
    import_.warn(fmt::format("{}: the texture has no image in a format that is read; it is left out", texture.path()));
    return {};
  }

  ImageTexture node;
  node.encoding = encoding;
  if (const std::optional<JsonView> reference = texture.find("sampler")) {
    const JsonView sampler = import_.document.element("samplers", import_.document.resolve("samplers", *reference));
    node.wrap_u = wrap_of(sampler, "wrapS");
    node.wrap_v = wrap_of(sampler, "wrapT");
    node.filter = filter_of(sampler);
  }
  if (const std::optional<JsonView> transform = texture_info.extension("KHR_texture_transform")) node.uv = uv_transform_of(*transform);
  node.image = image(import_.document.resolve("images", *source));

  // Materials often share a texture: one node for each combination of image, sampler, encoding and transform.
  const std::string key =
      fmt::format("{} {} {} {} {} {} {} {} {} {} {}", node.image.index, static_cast<int>(encoding), static_cast<int>(node.wrap_u),
                  static_cast<int>(node.wrap_v), static_cast<int>(node.filter), node.uv.matrix[0].x, node.uv.matrix[0].y,
                  node.uv.matrix[1].x, node.uv.matrix[1].y, node.uv.offset.x, node.uv.offset.y);
  const auto [found, is_new] = texture_ids_.try_emplace(key, TextureId(import_.scene.textures.size()));
  if (is_new) import_.scene.textures.push_back({.name = texture.name(), .node = node});
  return found->second;
}

ImageId TextureImporter::image(std::size_t gltf_image) {
  if (const auto found = image_ids_.find(gltf_image); found != image_ids_.end()) return found->second;
  Source source = read_source(import_.document.element("images", gltf_image));
  const ImageId next(sources_.size());
  ImageId id = next;
  if (!source.file.empty()) {
    id = ids_by_file_.try_emplace(source.file.string(), next).first->second;
  } else if (source.owned_bytes.empty()) {
    id = ids_by_content_.try_emplace({source.bytes.data(), source.bytes.size()}, next).first->second;
  }
  if (id == next) sources_.push_back(std::move(source));
  return image_ids_[gltf_image] = id;
}

TextureImporter::Source TextureImporter::read_source(const JsonView& image) {
  Source source;
  source.name = image.name();
  if (const std::optional<JsonView> reference = image.find("bufferView")) {
    source.bytes = import_.document.buffer_view(import_.document.resolve("bufferViews", *reference)).bytes;
    import_.document.charge(source.bytes.size(), image.path());
    return source;
  }
  const JsonView uri_member = image.require("uri");
  const std::string& uri = uri_member.as_string();
  if (is_data_uri(uri)) {
    std::optional<std::vector<std::byte>> data = decode_data_uri(uri);
    if (!data) throw input_error("the data URI is malformed").at(uri_member.path());
    source.owned_bytes = std::move(*data);
    source.bytes = source.owned_bytes;
    return source;
  }
  if (import_.document.folder() == nullptr) {
    throw input_error(fmt::format("external file '{}' is refused: only memory is read here", uri)).at(uri_member.path());
  }
  const std::optional<std::filesystem::path> file = file_of_uri(uri, *import_.document.folder());
  if (!file) throw input_error(fmt::format("'{}' is no file in the folder of the scene", uri)).at(uri_member.path());
  source.name = uri;
  source.file = *file;
  return source;
}

std::shared_ptr<const Image> TextureImporter::decode(const Source& source, Scene& warnings) const {
  if (!source.file.empty()) return load_texture_image(source.file, warnings, import_.context);
  const std::string place = fmt::format("{}: image '{}'", import_.name, source.name);
  try {
    return std::make_shared<const Image>(parse_image(source.bytes, place));
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) throw;
    add_warning(warnings, import_.context, fmt::format("{} (the image is left out)", error.what()));
    return nullptr;
  }
}

void TextureImporter::decode_images() {
  std::vector<std::shared_ptr<const Image>> decoded(sources_.size());
  std::vector<Scene> warnings(sources_.size());
  parallel_for(import_.context, sources_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) decoded[i] = decode(sources_[i], warnings[i]);
  });

  const auto white = std::make_shared<const Image>(Image{.width = 1, .height = 1, .channels = 1, .data = Image::Bytes{255}});
  Scene& scene = import_.scene;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    scene.images.push_back({.name = sources_[i].name, .image = decoded[i] ? decoded[i] : white});
    for (std::string& warning : warnings[i].warnings) scene.warnings.push_back(std::move(warning));
  }
  // A texture without its picture must not change what it multiplies.
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const auto* node = std::get_if<ImageTexture>(&scene.textures[i].node);
    if (node == nullptr || decoded[node->image.index]) continue;
    const bool is_normal_map = std::find(normal_maps_.begin(), normal_maps_.end(), TextureId(i)) != normal_maps_.end();
    scene.textures[i].node = ConstantTexture{is_normal_map ? Vec4(0.5f, 0.5f, 1, 1) : Vec4(1)};
  }
}

}  // namespace sightline::gltf
