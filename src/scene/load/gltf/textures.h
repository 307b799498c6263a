// Images, samplers and texture references of materials.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "scene/load/gltf/import.h"

namespace sightline::gltf {

/// Collects the textures that materials ask for, then decodes their images together.
class TextureImporter {
 public:
  explicit TextureImporter(Import& import) : import_(import) {}

  /// The texture that a textureInfo object refers to, with its KHR_texture_transform; invalid if it has no image that can be read.
  TextureId add(const JsonView& texture_info, ColorEncoding encoding);
  /// Decodes all images, in parallel. What cannot be read becomes neutral (white; a flat normal map), with a warning.
  void decode_images();
  /// Declares a texture to be a normal map, whose neutral value is not white.
  void mark_normal_map(TextureId texture) { normal_maps_.push_back(texture); }

 private:
  struct Source {
    std::string name;
    std::span<const std::byte> bytes;    ///< encoded picture, unless it is a file
    std::vector<std::byte> owned_bytes;  ///< holds `bytes` of data URIs
    std::filesystem::path file;
  };
  /// One scene image a glTF image, and one for all glTF images that share a buffer view.
  ImageId image(std::size_t gltf_image);
  Source read_source(const JsonView& image);
  std::shared_ptr<const Image> decode(const Source& source, Scene& warnings) const;

  Import& import_;
  std::map<std::size_t, ImageId> image_ids_;
  std::map<std::pair<const void*, std::size_t>, ImageId> ids_by_content_;
  std::map<std::string, ImageId> ids_by_file_;
  std::vector<Source> sources_;
  std::vector<TextureId> normal_maps_;
  std::map<std::string, TextureId> texture_ids_;
};

/// The texture coordinate set that a textureInfo object uses (KHR_texture_transform may override it).
std::uint64_t texture_coordinate_set(const JsonView& texture_info);

}  // namespace sightline::gltf
