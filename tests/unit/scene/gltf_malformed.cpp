// Hostile files: each ends in an Error that names the place, or in a scene, and never takes more memory than a small multiple of its size.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/core/error.h"
#include "gltf_file.h"

namespace sightline::test {
namespace {

/// A file that uses most features, to be damaged.
GltfFile rich_file() {
  GltfFile file;
  const int positions = file.add_triangle_positions();
  const int indices = file.add_array<std::uint16_t>({0, 1, 2}, kUnsignedShort, 3, "SCALAR");
  const int times = file.add_array<float>({0, 1}, kFloat, 2, "SCALAR");
  const int values = file.add_array<float>({0, 0, 0, 1, 2, 3}, kFloat, 2, "VEC3");
  file.push("images", {{"bufferView", file.add_view<std::uint8_t>({1, 2, 3, 4})}, {"mimeType", "image/png"}});
  file.push("textures", {{"source", 0}});
  file.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  file.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.6}, {"znear", 0.1}}}});
  const int joints = file.add_array<std::uint8_t>({0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, kUnsignedByte, 3, "VEC4");
  const int weights = file.add_array<float>({1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}, kFloat, 3, "VEC4");
  const int inverse = file.add_array<float>(
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1}, kFloat, 2, "MAT4");
  file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}},
                                         {"targets", {{{"POSITION", positions}}, {{"NORMAL", positions}}}},
                                         {"indices", indices},
                                         {"material", 0}})},
                 {"skin", 0},
                 {"camera", 0}});
  file.add_root({{"name", "bone"}});
  file.push("skins", {{"joints", {0, 1}}, {"inverseBindMatrices", inverse}});
  file.push("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  return file;
}

TEST(GltfMalformed, EveryTruncationOfAGlbIsAnError) {
  const std::vector<std::byte> glb = rich_file().glb();
  Context context;
  ASSERT_NO_THROW(parse_gltf(glb, "whole.glb", context));
  for (std::size_t size = 0; size < glb.size(); ++size) {
    try {
      parse_gltf(std::span(glb).first(size), "part.glb", context);
      ADD_FAILURE() << size << " of " << glb.size() << " bytes were accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_TRUE(error.place().starts_with("part.glb: byte ")) << error.what();
    }
  }
}

TEST(GltfMalformed, EveryFlippedByteEndsInASceneOrAnError) {
  const std::vector<std::byte> glb = rich_file().glb();
  Context context;
  std::size_t errors = 0;
  for (std::size_t i = 0; i < glb.size(); ++i) {
    for (const int flip : {0x01, 0x80, 0x10}) {
      std::vector<std::byte> damaged = glb;
      damaged[i] ^= static_cast<std::byte>(flip);
      try {
        parse_gltf(damaged, "flipped.glb", context);
      } catch (const Error& error) {
        ++errors;
        EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
        EXPECT_TRUE(error.place().starts_with("flipped.glb")) << error.what();
      }
    }
  }
  EXPECT_GT(errors, glb.size() / 4);
}

TEST(GltfMalformed, HugeNumbersAreErrorsBeforeMemoryIsTaken) {
  const std::string clean = rich_file().text();
  ASSERT_EQ(error_of(clean), "");
  const std::uint64_t hostile[] = {std::uint64_t{1} << 31, std::uint64_t{1} << 32, (std::uint64_t{1} << 32) + 1,
                                   std::uint64_t{1} << 52, std::uint64_t{1} << 62, std::uint64_t{1} << 63,
                                   ~std::uint64_t{0},      0x5555555555555556u /* x 12 wraps to 8 */};
  for (const std::uint64_t number : hostile) {
    const auto damaged = [&](const char* pointer) {
      GltfFile file = rich_file();
      file.json[nlohmann::json::json_pointer(pointer)] = number;
      return error_of(file);
    };
    for (const char* pointer :
         {"/accessors/0/count", "/accessors/1/count", "/accessors/2/count", "/accessors/0/byteOffset", "/bufferViews/0/byteLength",
          "/bufferViews/0/byteOffset", "/bufferViews/0/byteStride", "/bufferViews/0/buffer", "/nodes/0/mesh", "/nodes/0/camera",
          "/scenes/0/nodes/0", "/scene", "/textures/0/source", "/meshes/0/primitives/0/indices", "/meshes/0/primitives/0/material",
          "/meshes/0/primitives/0/mode", "/animations/0/channels/0/sampler", "/animations/0/samplers/0/input", "/images/0/bufferView"}) {
      EXPECT_NE(damaged(pointer), "") << pointer << " = " << number;
    }
  }
}

TEST(GltfMalformed, AccessorsStayInsideTheirView) {
  // The buffer goes on behind the view, so that only the view's own end can stop these.
  const auto error_with = [](const nlohmann::json& accessor, int stride) {
    GltfFile file;
    const int view = file.add_view<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, stride);
    file.add_view<float>({1, 2, 3, 4, 5, 6, 7, 8, 9});
    const int positions = file.add_accessor(view, kFloat, 3, "VEC3");
    file.json["accessors"][positions].update(accessor);
    file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", positions}}}})}});
    return error_of(file);
  };
  EXPECT_EQ(error_with(nlohmann::json::object(), 0), "");
  EXPECT_EQ(error_with({{"count", 3}}, 12), "");
  for (const std::string& error : {error_with({{"count", 4}}, 0), error_with({{"byteOffset", 4}}, 0), error_with({{"byteOffset", 37}}, 0),
                                   error_with({{"count", 3}}, 16), error_with({{"type", "VEC3"}, {"count", 1}, {"byteOffset", 28}}, 0)}) {
    EXPECT_TRUE(error.starts_with("test.gltf: /accessors/0: ")) << error;
  }
  EXPECT_TRUE(error_with({{"count", 3}}, 8).starts_with("test.gltf: /bufferViews/0/byteStride: "));
}

TEST(GltfMalformed, SparseElementsStayInsideTheirAccessor) {
  const auto error_with = [](std::uint16_t index, int count, std::size_t values) {
    GltfFile file;
    const int positions = file.add_triangle_positions();
    std::vector<float> moved(3 * values, 1);
    file.json["accessors"][positions]["sparse"] = {
        {"count", count},
        {"indices", {{"bufferView", file.add_view<std::uint16_t>({0, index})}, {"componentType", kUnsignedShort}}},
        {"values", {{"bufferView", file.add_view_bytes(std::as_bytes(std::span(moved)))}}}};
    file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", positions}}}})}});
    return error_of(file);
  };
  EXPECT_EQ(error_with(2, 2, 2), "");
  EXPECT_NE(error_with(3, 2, 2).find("/accessors/0/sparse/indices"), std::string::npos);
  EXPECT_NE(error_with(2, 3, 3).find("/accessors/0/sparse/indices"), std::string::npos);
  EXPECT_NE(error_with(2, 2, 1).find("/accessors/0/sparse/values"), std::string::npos);
  EXPECT_NE(error_with(2, 4, 4).find("/accessors/0/sparse"), std::string::npos);
}

TEST(GltfMalformed, CountsWithoutDataAreBoundedByTheFile) {
  GltfFile file;
  file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", file.add_accessor(-1, kFloat, 100'000'000, "VEC3")}}}})}});
  EXPECT_NE(error_of(file).find("far more than the file holds"), std::string::npos) << error_of(file);
}

TEST(GltfMalformed, ManyAccessorsOverOneViewAreBoundedByTheFile) {
  // 300 primitives, each with an accessor of its own over the same 1 MB: 300 MB from a file of 1.4 MB.
  GltfFile file;
  std::vector<float> many(250'000);
  const int view = file.add_view_bytes(std::as_bytes(std::span(many)));
  nlohmann::json primitives;
  for (int i = 0; i < 300; ++i)
    primitives.push_back({{"attributes", {{"POSITION", file.add_accessor(view, kFloat, many.size() / 3, "VEC3")}}}});
  file.push("meshes", {{"primitives", primitives}});
  file.add_root({{"mesh", 0}});
  EXPECT_NE(error_of(file).find("far more than the file holds"), std::string::npos);
}

TEST(GltfMalformed, ManyUsesOfManyPartsAreBoundedByTheFile) {
  // 2000 nodes that show a mesh of 2000 primitives: four million instances from 150 kB.
  GltfFile file;
  const int positions = file.add_triangle_positions();
  nlohmann::json primitives;
  for (int i = 0; i < 2000; ++i) primitives.push_back({{"attributes", {{"POSITION", positions}}}});
  file.push("meshes", {{"primitives", primitives}, {"name", std::string(10'000, 'n')}});
  for (int i = 0; i < 2000; ++i) file.add_root({{"mesh", 0}});
  EXPECT_NE(error_of(file).find("far more than the file holds"), std::string::npos);
}

TEST(GltfMalformed, NestingDeeperThanTheCallStackIsHarmless) {
  const std::string deep(1'000'000, '[');
  EXPECT_NE(error_of(R"({"asset":{"version":"2.0"},"extras":)" + deep), "");
  EXPECT_EQ(error_of(R"({"asset":{"version":"2.0"},"extras":)" + deep + std::string(deep.size(), ']') + "}"), "");
}

TEST(GltfMalformed, WrongTypesNameTheirJsonPath) {
  const auto error_with = [](const char* pointer, nlohmann::json value) {
    GltfFile file = rich_file();
    file.json[nlohmann::json::json_pointer(pointer)] = std::move(value);
    return error_of(file);
  };
  for (const auto& [pointer, value] :
       std::initializer_list<std::pair<const char*, nlohmann::json>>{{"/meshes/0/primitives", nlohmann::json::object()},
                                                                     {"/accessors/0/type", "VEC9"},
                                                                     {"/accessors/0/type", 3},
                                                                     {"/accessors/0/componentType", 5124},
                                                                     {"/accessors/0/count", -1},
                                                                     {"/accessors/0/count", 2.5},
                                                                     {"/nodes/0/mesh", "first"},
                                                                     {"/nodes/0/translation", {1, 2}},
                                                                     {"/nodes/0/rotation", {1, 2, 3, "x"}},
                                                                     {"/nodes/0/matrix", {1, 2, 3}},
                                                                     {"/cameras/0/type", "fisheye"},
                                                                     {"/cameras/0/perspective/yfov", -1},
                                                                     {"/cameras/0/perspective/yfov", 4},
                                                                     {"/materials/0/alphaMode", "GLASS"},
                                                                     {"/materials/0/pbrMetallicRoughness/baseColorFactor", {1, 2, 3}},
                                                                     {"/animations/0/samplers/0/interpolation", "BEZIER"}}) {
    const std::string error = error_with(pointer, value);
    EXPECT_NE(error.find(std::string("test.gltf: ") + pointer), std::string::npos) << pointer << ": " << error;
  }
}

TEST(GltfMalformed, SyntaxErrorsNameTheirByte) {
  EXPECT_TRUE(error_of(R"({"asset":{"version":"2.0"},})").starts_with("test.gltf: byte 27")) << error_of(R"({"asset":{"version":"2.0"},})");
  EXPECT_TRUE(error_of("").starts_with("test.gltf: byte 0"));
  EXPECT_NE(error_of(R"({"asset":{"version":"1.0"}})"), "");
  EXPECT_NE(error_of("[]"), "");
}

TEST(GltfMalformed, ExternalFilesAreRefusedInMemory) {
  GltfFile file = rich_file();
  file.json["buffers"] = {{{"byteLength", 36}, {"uri", "other.bin"}}};
  EXPECT_NE(error_of(file).find("/buffers/0/uri"), std::string::npos) << error_of(file);
}

TEST(GltfMalformed, FilesOutsideTheFolderAreRefused) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / ("gltf_confined_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder / "inner");
  const float triangle[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  for (const std::filesystem::path& path : {folder / "secret.bin", folder / "inner" / "a b.bin"}) {
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(triangle), sizeof triangle);
  }
  std::error_code ignored;
  std::filesystem::create_symlink(folder / "secret.bin", folder / "inner" / "link.bin", ignored);
  Context context;
  const auto load_with = [&](const std::string& uri) {
    GltfFile file;
    file.add_root({{"mesh", file.add_mesh({{"attributes", {{"POSITION", file.add_triangle_positions()}}}})}});
    file.json["buffers"] = {{{"byteLength", 36}, {"uri", uri}}};
    std::ofstream(folder / "inner" / "scene.gltf") << file.text();
    return load_gltf(folder / "inner" / "scene.gltf", {}, context);
  };
  EXPECT_EQ(load_with("a%20b.bin").meshes.size(), 1u);
  EXPECT_EQ(load_with("./x/../a b.bin").meshes.size(), 1u);
  for (const std::string& uri :
       {std::string("../secret.bin"), std::string("%2e%2e/secret.bin"), (folder / "secret.bin").string(), std::string("file:///etc/passwd"),
        std::string("link.bin"), std::string("."), std::string("missing.bin")}) {
    EXPECT_THROW(load_with(uri), Error) << uri;
  }
}

}  // namespace
}  // namespace sightline::test
