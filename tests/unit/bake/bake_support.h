// Small bakes and a folder to put them in.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <string>
#include <vector>

#include "bake/bake_file.h"
#include "base/core/error.h"

namespace sightline::test {

/// An empty folder that goes away again.
class Folder {
 public:
  explicit Folder(const std::string& name) : path_(std::filesystem::path(testing::TempDir()) / ("sightline-bake-" + name)) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

inline std::vector<char> bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}
inline void write_bytes(const std::filesystem::path& path, const std::vector<char>& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline const BakeId kSmallId{"test.small", 3, {0x0123456789abcdefu, 42}};

/// Three arrays, one of them empty.
struct SmallBake {
  std::vector<float> weights = std::vector<float>(1000);
  std::vector<std::int8_t> codes = std::vector<std::int8_t>(77, -5);
  std::vector<std::uint16_t> nothing;
  SmallBake() { std::iota(weights.begin(), weights.end(), 0.5f); }
  std::vector<BakeSection> sections() const {
    return {bake_section("weights", std::span<const float>(weights)), bake_section("codes", std::span<const std::int8_t>(codes)),
            bake_section("nothing", std::span<const std::uint16_t>(nothing))};
  }
};

/// The message of the Error{code} that `work` throws; fails where it throws none.
template <class F>
std::string message_of(ErrorCode code, F&& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no Error was thrown";
  return {};
}

}  // namespace sightline::test
