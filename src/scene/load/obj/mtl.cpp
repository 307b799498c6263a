#include "scene/load/obj/mtl.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "scene/load/load.h"
#include "scene/load/obj/line_reader.h"
#include "scene/load/warnings.h"

namespace sightline::obj {
namespace {

/// A texture as an MTL line names it.
struct Map {
  std::string file;
  Vec2 scale{1}, offset{0};
  float bump = 1;
  bool clamp = false;
};

/// One newmtl section, as said.
struct Description {
  std::string name;
  Color diffuse{0.7f}, specular{0}, emission{0};
  float exponent = 0, eta = 1.5f, opacity = 1;
  int illum = 2;
  Map diffuse_map, specular_map, emission_map, alpha_map, bump_map, normal_map;
};

Color read_color(LineReader& line) {
  const float r = line.require_number();
  const float g = line.number().value_or(r);
  const float b = line.number().value_or(g);
  return {r, g, b};
}

/// Options come before the file name, which may hold spaces.
Map read_map(LineReader& line) {
  Map map;
  for (;;) {
    LineReader ahead = line;
    const std::string_view option = ahead.word();
    if (option.size() < 2 || option[0] != '-') break;
    line = ahead;
    const auto vec2 = [&](float otherwise) {
      const float u = line.number().value_or(otherwise), v = line.number().value_or(otherwise);
      line.number();
      return Vec2(u, v);
    };
    if (option == "-s") {
      map.scale = vec2(1);
    } else if (option == "-o") {
      map.offset = vec2(0);
    } else if (option == "-t") {
      vec2(0);
    } else if (option == "-bm") {
      map.bump = line.number().value_or(1);
    } else if (option == "-clamp") {
      map.clamp = line.word() == "on";
    } else if (option == "-mm") {
      line.number();
      line.number();
    } else {
      line.word();  // -blendu, -blendv, -boost, -cc, -imfchan, -texres, -type: one value each
    }
  }
  map.file = line.rest();
  std::replace(map.file.begin(), map.file.end(), '\\', '/');
  return map;
}

class Builder {
 public:
  Builder(const std::filesystem::path& directory, Scene& scene, MaterialNames& names, const Context& context)
      : directory_(directory), scene_(scene), names_(names), context_(context) {}

  void add(const Description& d) {
    if (names_.contains(d.name)) return;
    Material material;
    material.name = d.name;
    material.model = model(d);
    material.emission = emission(d);
    if (TextureId map = texture(d.normal_map, ColorEncoding::linear); map.valid()) material.normal_map = map;
    if (TextureId map = texture(d.bump_map, ColorEncoding::linear); map.valid()) {
      // Height maps are grey; what is mostly blue is a normal map under the wrong keyword.
      if (looks_like_normals(map)) {
        material.normal_map = map;
      } else {
        material.bump = map;
        material.bump_scale = d.bump_map.bump;
      }
    }
    if (TextureId map = texture(d.alpha_map, ColorEncoding::linear); map.valid()) {
      material.alpha_mode = AlphaMode::mask;
      material.alpha.texture = map;
    } else if (d.opacity < 1 && !is_glass(d)) {
      material.alpha_mode = AlphaMode::blend;
      material.alpha = d.opacity;
    }
    names_[d.name] = MaterialId(scene_.materials.size());
    scene_.materials.push_back(std::move(material));
  }

 private:
  /// Illumination models 4, 6, 7 and 9 ask for refraction.
  static bool is_glass(const Description& d) { return d.illum == 4 || d.illum == 6 || d.illum == 7 || d.illum == 9; }
  /// Models 3, 5 and 8 ask for mirror reflection; many exporters write 3 for plain plastics, which keep their diffuse part.
  static bool is_mirror(const Description& d) {
    return (d.illum == 3 || d.illum == 5 || d.illum == 8) && is_black(d.diffuse) && d.diffuse_map.file.empty() && !is_black(d.specular);
  }

  SurfaceModel model(const Description& d) {
    if (is_glass(d) && d.eta > 1) return DielectricMaterial{.eta = d.eta};
    if (is_mirror(d)) {
      ConductorMaterial mirror;  // a purely imaginary index reflects all: Ks alone is the reflectance
      mirror.eta = Color(0);
      mirror.k = Color(1);
      mirror.reflectance_tint = glm::min(d.specular, Color(1));
      return mirror;
    }
    ColorParam diffuse = d.diffuse, specular = d.specular;
    diffuse.texture = texture(d.diffuse_map, ColorEncoding::srgb);
    specular.texture = texture(d.specular_map, ColorEncoding::srgb);
    const bool glossy = d.illum >= 2 && !is_black(d.specular) && d.exponent > 0;
    // Together the two may not reflect more than they receive.
    const float total = max_component(diffuse.value + (glossy ? specular.value : Color(0)));
    if (total > 1) {
      diffuse.value /= total;
      specular.value /= total;
    }
    if (!glossy) return DiffuseMaterial{.reflectance = diffuse};
    return PhongMaterial{.diffuse = diffuse, .specular = specular, .exponent = d.exponent};
  }

  ColorParam emission(const Description& d) {
    ColorParam emission = d.emission;
    emission.texture = texture(d.emission_map, ColorEncoding::srgb);
    if (emission.texture.valid() && is_black(emission.value)) emission.value = Color(1);
    return emission;
  }

  TextureId texture(const Map& map, ColorEncoding encoding) {
    if (map.file.empty()) return {};
    const ImageId image = find_image(map.file);
    if (!image.valid()) return {};
    ImageTexture node;
    node.image = image;
    node.encoding = encoding;
    node.wrap_u = node.wrap_v = map.clamp ? Wrap::clamp : Wrap::repeat;
    // The file's transform acts on v upwards; ours counts from the top: v' = 1 - (scale (1 - v) + offset).
    node.uv.matrix = glm::mat2(map.scale.x, 0, 0, map.scale.y);
    node.uv.offset = {map.offset.x, 1 - map.scale.y - map.offset.y};
    scene_.textures.push_back({.name = map.file, .node = node});
    return TextureId(scene_.textures.size() - 1);
  }

  ImageId find_image(const std::string& file) {
    const auto [entry, is_new] = images_.try_emplace(file);
    if (is_new) {
      std::filesystem::path path = directory_ / file;
      std::error_code ignored;
      const std::filesystem::path beside = directory_ / path.filename();
      if (!std::filesystem::exists(path, ignored) && std::filesystem::exists(beside, ignored)) path = beside;
      if (const auto image = load_texture_image(path, scene_, context_)) {
        entry->second = ImageId(scene_.images.size());
        scene_.images.push_back({.name = file, .image = image});
      }
    }
    return entry->second;
  }

  bool looks_like_normals(TextureId id) const {
    const Image& image = *scene_.images[std::get<ImageTexture>(scene_.textures[id.index].node).image.index].image;
    if (image.channels < 3 || image.pixel_count() == 0) return false;
    constexpr int kProbes = 16;
    Color sum(0);
    for (int j = 0; j < kProbes; ++j) {
      for (int i = 0; i < kProbes; ++i) {
        const int x = i * image.width / kProbes, y = j * image.height / kProbes;
        sum += Color(image.value(x, y, 0), image.value(x, y, 1), image.value(x, y, 2));
      }
    }
    sum /= float{kProbes * kProbes};
    return sum.z > 0.7f && std::fabs(sum.x - 0.5f) < 0.15f && std::fabs(sum.y - 0.5f) < 0.15f;
  }

  std::filesystem::path directory_;
  Scene& scene_;
  MaterialNames& names_;
  const Context& context_;
  std::map<std::string, ImageId> images_;
};

/// One line of a material; false if the keyword is not known.
bool read_statement(std::string_view keyword, LineReader& line, Description& d) {
  if (keyword == "Kd") {
    d.diffuse = read_color(line);
  } else if (keyword == "Ks") {
    d.specular = read_color(line);
  } else if (keyword == "Ke") {
    d.emission = read_color(line);
  } else if (keyword == "Ns") {
    d.exponent = line.require_number();
  } else if (keyword == "Ni") {
    d.eta = line.require_number();
  } else if (keyword == "d") {
    if (LineReader ahead = line; ahead.word() == "-halo") line = ahead;
    d.opacity = line.require_number();
  } else if (keyword == "Tr") {
    d.opacity = 1 - line.require_number();
  } else if (keyword == "illum") {
    d.illum = static_cast<int>(std::clamp(line.require_number(), 0.f, 10.f));
  } else if (keyword == "map_Kd") {
    d.diffuse_map = read_map(line);
  } else if (keyword == "map_Ks") {
    d.specular_map = read_map(line);
  } else if (keyword == "map_Ke") {
    d.emission_map = read_map(line);
  } else if (keyword == "map_d") {
    d.alpha_map = read_map(line);
  } else if (keyword == "map_bump" || keyword == "map_Bump" || keyword == "bump") {
    d.bump_map = read_map(line);
  } else if (keyword == "norm" || keyword == "map_Kn") {
    d.normal_map = read_map(line);
  } else {
    // Ambient light and what only rasterisers use.
    static constexpr std::array<std::string_view, 6> kIgnored{"Ka", "map_Ka", "Tf", "sharpness", "map_Ns", "refl"};
    return std::find(kIgnored.begin(), kIgnored.end(), keyword) != kIgnored.end();
  }
  return true;
}

bool is_sane(const Color& c) { return is_finite(c) && c.x >= 0 && c.y >= 0 && c.z >= 0; }

}  // namespace

void parse_mtl(std::string_view text, const std::string& name, const std::filesystem::path& directory, Scene& scene, MaterialNames& names,
               const Context& context) {
  Builder builder(directory, scene, names, context);
  std::optional<Description> current;
  std::set<std::string, std::less<>> unknown;
  const auto finish = [&] {
    if (!current) return;
    for (Color* c : {&current->diffuse, &current->specular, &current->emission}) {
      if (is_sane(*c)) continue;
      add_warning(scene, context,
                  fmt::format("{}: material '{}' has a negative or non-finite colour, taken as black", name, current->name));
      *c = Color(0);
    }
    if (!std::isfinite(current->exponent)) current->exponent = 0;
    if (!std::isfinite(current->eta)) current->eta = 1.5f;
    // Exporters disagree on whether Tr is transparency or opacity; a material that nobody could see is meant to be opaque.
    if (!(current->opacity > 0 && current->opacity <= 1)) current->opacity = 1;
    builder.add(*current);
  };
  LineReader line(text, name);
  while (line.next_line()) {
    const std::string_view keyword = line.word();
    if (keyword.empty()) continue;
    if (keyword == "newmtl") {
      finish();
      current = Description{};
      current->name = line.rest();
    } else if (current && !read_statement(keyword, line, *current) && unknown.size() < 16 && unknown.emplace(keyword).second) {
      add_warning(scene, context, fmt::format("{}: '{}' is not understood", line.place(), LineReader::printable(keyword)));
    }
  }
  finish();
}

}  // namespace sightline::obj
