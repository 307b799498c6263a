#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "base/core/error.h"
#include "image/io/image_io.h"
#include "unit/image/test_pictures.h"

namespace sightline {
namespace {

namespace fs = std::filesystem;

class File : public testing::Test {
 protected:
  fs::path folder =
      fs::path(testing::TempDir()) / ("sightline_file_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  void SetUp() override {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }
};

ErrorCode code_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_FALSE(error.place().empty());
    return error.code();
  }
  ADD_FAILURE() << "no error";
  return ErrorCode::bug;
}

TEST_F(File, WhatIsWrittenIsReadAndNothingIsLeftBeside) {
  const fs::path path = folder / "a b.bin";
  write_file(path, test::bytes_of("first"));
  write_file(path, test::bytes_of("second"));
  EXPECT_EQ(read_file(path), test::bytes_of("second"));
  EXPECT_EQ(file_count(), 1u);
  write_file(folder / "empty", {});
  EXPECT_TRUE(read_file(folder / "empty").empty());
}

TEST_F(File, ALinkKeepsBeingALink) {
  write_file(folder / "target", test::bytes_of("old"));
  fs::create_symlink(folder / "target", folder / "link");
  write_file(folder / "link", test::bytes_of("new"));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "target"), test::bytes_of("new"));
}

TEST_F(File, AFullDeviceIsAResourceError) {
  if (!fs::exists("/dev/full")) return;
  EXPECT_EQ(code_of([] { write_file("/dev/full", test::bytes_of("anything")); }), ErrorCode::resource);
}

TEST_F(File, PlacesThatCannotBeWrittenAreKnownBeforehand) {
  EXPECT_EQ(code_of([&] { check_writable(folder / "missing" / "x.exr"); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { check_writable(folder); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { write_file(folder / "missing" / "x.exr", {}); }), ErrorCode::usage);
  EXPECT_NO_THROW(check_writable(folder / "x.exr"));
  EXPECT_NO_THROW(check_writable("-"));
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(File, ReadingRefusesWhatIsMissingAFolderOrTooLarge) {
  write_file(folder / "ten", test::bytes_of("0123456789"));
  EXPECT_EQ(code_of([&] { read_file(folder / "missing"); }), ErrorCode::input);
  EXPECT_EQ(code_of([&] { read_file(folder); }), ErrorCode::input);
  EXPECT_EQ(code_of([&] { read_file(folder / "ten", 9); }), ErrorCode::input);
  EXPECT_EQ(read_file(folder / "ten", 10).size(), 10u);
  if (fs::exists("/dev/zero")) {
    EXPECT_EQ(code_of([] { read_file("/dev/zero", 100000); }), ErrorCode::input);
  }
}

}  // namespace
}  // namespace sightline
