#include "texture/texture_set.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "base/parallel/parallel.h"
#include "texture/mip_map.h"
#include "texture/texture_program.h"

namespace sightline {
namespace {

void check_image(const Scene& scene, const ImageTexture& texture, std::string_view place) {
  if (!texture.image.valid() || texture.image.index >= scene.images.size()) {
    throw input_error(fmt::format("image {} does not exist; the scene has {}", texture.image.index, scene.images.size())).at(place);
  }
  const ImageAsset& asset = scene.images[texture.image.index];
  if (!asset.image) throw input_error("the image has not been loaded").at(asset.name).during(place);
  const Image& image = *asset.image;
  const std::size_t values = std::visit([](const auto& v) { return v.size(); }, image.data);
  constexpr int kMaxSize = 1 << 24;  // texel indices in float arithmetic
  if (image.width <= 0 || image.height <= 0 || image.width > kMaxSize || image.height > kMaxSize || image.channels < 1 ||
      image.channels > 4 || values != image.pixel_count() * static_cast<std::size_t>(image.channels)) {
    throw input_error(fmt::format("an image of {} x {} pixels with {} channels and {} values cannot be a texture", image.width,
                                  image.height, image.channels, values))
        .at(asset.name)
        .during(place);
  }
}

}  // namespace

struct TextureSet::Impl {
  std::vector<std::shared_ptr<const MipMap>> maps;  ///< by texture; null for nodes without image
  std::vector<TextureProgram> programs;             ///< by texture
  std::uint64_t memory_bytes = 0;
};

TextureSet::TextureSet() : impl_(std::make_shared<const Impl>()) {}

TextureSet::TextureSet(const Scene& scene, const Context& context) {
  auto impl = std::make_shared<Impl>();
  impl->maps.resize(scene.textures.size());

  // Textures that show one image in one encoding share its levels.
  using Key = std::tuple<const Image*, ColorEncoding, bool>;
  struct Job {
    std::shared_ptr<const Image> image;
    ColorEncoding encoding;
    bool with_levels;
    std::vector<std::size_t> users;
  };
  std::map<Key, std::size_t> job_of;
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const auto* node = std::get_if<ImageTexture>(&scene.textures[i].node);
    if (!node) continue;
    check_image(scene, *node, fmt::format("texture {} '{}'", i, scene.textures[i].name));
    const std::shared_ptr<const Image>& image = scene.images[node->image.index].image;
    const bool with_levels = node->filter == TextureFilter::trilinear;
    const auto [found, is_new] = job_of.try_emplace({image.get(), node->encoding, with_levels}, jobs.size());
    if (is_new) jobs.push_back({image, node->encoding, with_levels, {}});
    jobs[found->second].users.push_back(i);
  }
  std::vector<std::shared_ptr<const MipMap>> built(jobs.size());
  parallel_for(context, jobs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      built[i] = std::make_shared<const MipMap>(jobs[i].image, jobs[i].encoding, jobs[i].with_levels);
  });
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    impl->memory_bytes += built[i]->memory_bytes();
    for (const std::size_t user : jobs[i].users) impl->maps[user] = built[i];
  }

  impl->programs.reserve(scene.textures.size());
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    impl->programs.push_back(TextureProgram::compile(scene.textures, impl->maps, TextureId(i)));
    impl->memory_bytes += impl->programs.back().memory_bytes();
  }
  impl_ = std::move(impl);
}

Vec4 TextureSet::sample(TextureId texture, const TexturePoint& point) const {
  return texture.index < impl_->programs.size() ? impl_->programs[texture.index].evaluate(point) : Vec4(1);
}

void TextureSet::sample(TextureId texture, std::span<const TexturePoint> points, std::span<Vec4> values) const {
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = sample(texture, points[i]);
}

float TextureSet::sample(const FloatParam& param, const TexturePoint& point) const {
  if (!param.texture.valid()) return param.value;
  const Vec4 value = sample(param.texture, point);
  if (param.channel >= 0 && param.channel < 4) return param.value * value[param.channel];
  return param.value * (value.x + value.y + value.z) * (1.f / 3);
}

Vec4 TextureSet::mean(TextureId texture) const {
  return texture.index < impl_->programs.size() ? impl_->programs[texture.index].mean() : Vec4(1);
}

std::uint64_t TextureSet::memory_bytes() const { return impl_->memory_bytes; }

}  // namespace sightline
