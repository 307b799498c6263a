// Every reader survives every cut and many garblings of a small valid file: a result or an Error of the input kind that names the file,
// nothing else, within a bounded address space.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "base/core/error.h"
#include "film/frame_file.h"
#include "image/io/image_io.h"
#include "scene/load/load.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;
using Reader = std::function<void(std::span<const std::byte>, const std::string& name)>;

std::string_view text_of(std::span<const std::byte> bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// What a loader promises is what everything above relies on.
void expect_consistent(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    for (const UVec3& t : mesh.triangles) ASSERT_TRUE(std::max({t.x, t.y, t.z}) < mesh.positions.size());
    for (const MaterialId id : mesh.materials) ASSERT_LT(id.index, scene.materials.size());
  }
  for (const Instance& instance : scene.instances) ASSERT_LT(instance.mesh.index, scene.meshes.size());
}

const std::map<std::string, Reader>& readers() {
  static const Context context{.threads = 1};
  static const Reader image = [](auto bytes, auto& name) { static_cast<void>(parse_image(bytes, name)); };
  static const std::map<std::string, Reader> table = {
      {".png", image},
      {".jpg", image},
      {".tga", image},
      {".bmp", image},
      {".hdr", image},
      {".pfm", image},
      {".exr",
       [](auto bytes, auto& name) {
         static_cast<void>(parse_exr(bytes, name));
         image(bytes, name);
       }},
      {".gltf", [](auto bytes, auto& name) { expect_consistent(parse_gltf(bytes, name, context)); }},
      {".glb", [](auto bytes, auto& name) { expect_consistent(parse_gltf(bytes, name, context)); }},
      {".pbrt", [](auto bytes, auto& name) { expect_consistent(parse_pbrt(text_of(bytes), name, context)); }},
      {".obj", [](auto bytes, auto& name) { expect_consistent(parse_obj(text_of(bytes), name, context)); }},
      {".ply", [](auto bytes, auto& name) { expect_consistent(parse_ply(bytes, name, context)); }},
      {".slice", [](auto bytes, auto& name) { static_cast<void>(decode_frame(bytes, name)); }}};
  return table;
}

/// True if the reader took the bytes; a failure of the test if it ended in anything but that or a proper Error.
bool accepts(const Reader& reader, std::span<const std::byte> bytes, const std::string& name, const std::string& what) {
  try {
    reader(bytes, name);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input) << what << ": " << error.what();
    EXPECT_NE(error.place().find(name), std::string::npos) << what << ": " << error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << what << ": " << error.what();
  }
  return false;
}

Bytes read_bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

Bytes small_slice() {
  AovSet aovs;
  aovs.add(Aov::depth);
  Frame frame(5, 3, aovs);
  for (std::uint32_t pixel = 0; pixel < 15; ++pixel) frame.add_color(pixel, 0, Color(0.1f * static_cast<float>(pixel)));
  return encode_frame(frame, {"identity"}, "{}");
}

/// Small valid files, the same that fuzzing starts from.
const std::map<std::string, Bytes>& seeds() {
  static const std::map<std::string, Bytes> files = [] {
    const fs::path folder = fs::path(testing::TempDir()) / ("damage_seeds_" + std::to_string(::getpid()));
    const std::string command = std::string("'") + SIGHTLINE_PYTHON + "' '" + SIGHTLINE_SEED_MAKER + "' '" + folder.string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    std::map<std::string, Bytes> result;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file() && readers().contains(entry.path().extension().string()))
        result[entry.path().filename().string()] = read_bytes(entry.path());
    }
    fs::remove_all(folder);
    result["small.slice"] = small_slice();
    return result;
  }();
  return files;
}

// A reader that believes a garbled count shall fail here rather than on a user's machine. The sanitizers reserve too much for a limit.
class BoundedMemory : public testing::Environment {
 public:
  void SetUp() override {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    const rlimit limit{std::uint64_t{2} << 30, std::uint64_t{2} << 30};
    ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
#endif
  }
};
[[maybe_unused]] const auto* const bounded_memory = testing::AddGlobalTestEnvironment(new BoundedMemory);

TEST(DamagedFiles, SeedsOfEveryFormatAreValid) {
  std::map<std::string, int> formats;
  for (const auto& [name, bytes] : seeds()) {
    const std::string ending = fs::path(name).extension().string();
    EXPECT_TRUE(accepts(readers().at(ending), bytes, name, name)) << name;
    ++formats[ending];
  }
  for (const auto& [ending, reader] : readers()) EXPECT_GT(formats[ending], 0) << ending;
}

TEST(DamagedFiles, EveryCutEndsInAResultOrAnErrorThatNamesTheFile) {
  for (const auto& [name, bytes] : seeds()) {
    const Reader& reader = readers().at(fs::path(name).extension().string());
    const std::size_t step = std::max<std::size_t>(1, bytes.size() / 1000);
    for (std::size_t size = 0; size < bytes.size(); size += step) {
      // A copy of its own, so that the sanitizers see a step beyond the end.
      const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      accepts(reader, cut, name, name + " cut to " + std::to_string(size));
    }
  }
}

TEST(DamagedFiles, FormatsWithADeclaredSizeNoticeThatHalfIsMissing) {
  for (const auto& [name, bytes] : seeds()) {
    const std::string ending = fs::path(name).extension().string();
    if (ending == ".obj" || ending == ".pbrt") continue;  // half a text may be a whole one
    const Bytes half(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2));
    EXPECT_FALSE(accepts(readers().at(ending), half, name, name)) << name;
  }
}

TEST(DamagedFiles, GarbledBytesEndInAResultOrAnErrorThatNamesTheFile) {
  std::mt19937 random(20260101);
  for (const auto& [name, bytes] : seeds()) {
    const Reader& reader = readers().at(fs::path(name).extension().string());
    for (int round = 0; round < 2000; ++round) {
      Bytes garbled = bytes;
      const int changes = 1 + static_cast<int>(random() % 4);
      std::string what = name + " with";
      for (int i = 0; i < changes; ++i) {
        constexpr std::array<std::uint8_t, 6> favourites = {0x00, 0xff, 0x7f, 0x80, '-', '9'};
        const std::size_t at = random() % garbled.size();
        const auto value = static_cast<std::uint8_t>(random() % 2 ? favourites[random() % favourites.size()] : random());
        garbled[at] = static_cast<std::byte>(value);
        what += " " + std::to_string(at) + "=" + std::to_string(value);
      }
      accepts(reader, garbled, name, what);
    }
  }
}

TEST(DamagedFiles, PiecesMovedOrRepeatedEndInAResultOrAnErrorThatNamesTheFile) {
  std::mt19937 random(20260102);
  for (const auto& [name, bytes] : seeds()) {
    const Reader& reader = readers().at(fs::path(name).extension().string());
    for (int round = 0; round < 200; ++round) {
      Bytes moved = bytes;
      const std::size_t from = random() % bytes.size(), to = random() % bytes.size();
      const std::size_t size = 1 + random() % std::min<std::size_t>(64, bytes.size() - from);
      const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(from);
      moved.insert(moved.begin() + static_cast<std::ptrdiff_t>(to), begin, begin + static_cast<std::ptrdiff_t>(size));
      accepts(reader, moved, name,
              name + " with " + std::to_string(size) + " bytes of " + std::to_string(from) + " at " + std::to_string(to));
    }
  }
}

TEST(DamagedFiles, MaterialLibrariesBesideAnObject) {
  const fs::path folder = fs::path(testing::TempDir()) / ("damage_mtl_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string library = "newmtl a\nKd 0.1 0.2 0.3\nKe 1 1 1\nNs 10\nKs 0.5 0.5 0.5\nmap_Kd -s 2 2 1 a.png\nillum 2\nd 0.5\n";
  std::ofstream(folder / "a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
  std::mt19937 random(20260103);
  const Context context{.threads = 1};
  const auto load = [&](const std::string& text) {
    std::ofstream(folder / "a.mtl") << text;
    const Reader reader = [&](auto, auto&) { expect_consistent(load_obj(folder / "a.obj", {}, context)); };
    accepts(reader, {}, "a.", "a.mtl: " + text);
  };
  for (std::size_t size = 0; size <= library.size(); ++size) load(library.substr(0, size));
  for (int round = 0; round < 200; ++round) {
    std::string garbled = library;
    garbled[random() % garbled.size()] = static_cast<char>(random());
    load(garbled);
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace sightline
