#include <unistd.h>

#include <gtest/gtest.h>

#include <filesystem>

#include "image/io/image_io.h"
#include "scene/load/load.h"

namespace sightline {
namespace {

std::filesystem::path fresh_folder(const char* name) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / (std::to_string(::getpid()) + "_" + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

TEST(TextureImage, AnotherEndingOfTheSameStemIsUsedWithAWarning) {
  const std::filesystem::path folder = fresh_folder("texture_image");
  const std::uint8_t pixel[3] = {1, 2, 3};
  write_file(folder / "wood.png", encode_png(1, 1, 3, pixel));
  Context context;
  Scene scene;
  EXPECT_NE(load_texture_image(folder / "wood.png", scene, context), nullptr);
  EXPECT_TRUE(scene.warnings.empty());
  const std::shared_ptr<const Image> other = load_texture_image(folder / "wood.tga", scene, context);
  ASSERT_NE(other, nullptr);
  EXPECT_TRUE(std::holds_alternative<Image::Bytes>(other->data)) << "8 bits stay 8 bits";
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("wood.png is used instead"), std::string::npos) << scene.warnings[0];
}

TEST(TextureImage, MissingOrBrokenImagesAreWarnings) {
  const std::filesystem::path folder = fresh_folder("texture_image_broken");
  write_file(folder / "broken.png", std::as_bytes(std::span("no picture")));
  Context context;
  Scene scene;
  EXPECT_EQ(load_texture_image(folder / "missing.png", scene, context), nullptr);
  EXPECT_EQ(load_texture_image(folder / "broken.png", scene, context), nullptr);
  EXPECT_EQ(scene.warnings.size(), 2u);
}

}  // namespace
}  // namespace sightline
