#include "texture/texture_set.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"

namespace sightline {
namespace {

TextureId add(Scene& scene, auto node) {
  scene.textures.push_back({"t", node});
  return TextureId(scene.textures.size() - 1);
}
TextureId constant(Scene& scene, float value) { return add(scene, ConstantTexture{Vec4(value)}); }
ImageId add_image(Scene& scene, int width, int height, std::vector<float> values) {
  scene.images.push_back({"image", std::make_shared<const Image>(Image{width, height, 1, std::move(values)})});
  return ImageId(scene.images.size() - 1);
}

ImageTexture image_texture(ImageId image, TextureFilter filter = TextureFilter::trilinear) {
  ImageTexture texture;
  texture.image = image;
  texture.filter = filter;
  return texture;
}

TEST(TextureSet, InvalidIdIsWhiteAndParametersMultiply) {
  Scene scene;
  const TextureId half = constant(scene, 0.5f);
  const TextureId channels = add(scene, ConstantTexture{{0.1f, 0.2f, 0.3f, 0.9f}});
  const TextureSet set(scene, Context{});
  EXPECT_EQ(set.sample(TextureId{}, {}), Vec4(1));
  EXPECT_EQ(TextureSet().sample(TextureId(std::size_t{3}), {}), Vec4(1));
  ColorParam color{Color(2, 4, 6)};
  EXPECT_EQ(set.sample(color, {}), Color(2, 4, 6));
  color.texture = half;
  EXPECT_EQ(set.sample(color, {}), Color(1, 2, 3));
  FloatParam value{10.f};
  EXPECT_EQ(set.sample(value, {}), 10);
  value.texture = channels;
  EXPECT_NEAR(set.sample(value, {}), 2, 1e-5f);
  value.channel = 3;
  EXPECT_NEAR(set.sample(value, {}), 9, 1e-5f);
}

TEST(TextureSet, ScaleMixInvertAndUvTransform) {
  Scene scene;
  const TextureId a = constant(scene, 2), b = constant(scene, 6), quarter = constant(scene, 0.25f);
  const TextureId scaled = add(scene, ScaleTexture{a, b});
  const TextureId mixed = add(scene, MixTexture{a, b, quarter});
  ImageTexture image = image_texture(add_image(scene, 2, 1, {0.25f, 0.5f}), TextureFilter::nearest);
  image.scale = 3;
  image.invert = true;
  const TextureId inverted = add(scene, image);
  // Mirrors u: the left half shows the right texel.
  image.invert = false;
  image.uv = {glm::mat2(-1, 0, 0, 1), {1, 0}};
  const TextureId mirrored = add(scene, image);
  const TextureSet set(scene, Context{});
  EXPECT_EQ(set.sample(scaled, {}).x, 12);
  EXPECT_EQ(set.sample(mixed, {}).x, 3);
  EXPECT_EQ(set.sample(inverted, {.uv = {0.1f, 0.5f}}).x, 3 * 0.75f);
  EXPECT_EQ(set.sample(mirrored, {.uv = {0.1f, 0.5f}}).x, 3 * 0.5f);
  EXPECT_EQ(set.sample(mirrored, {.uv = {0.9f, 0.5f}}).x, 3 * 0.25f);
}

TEST(TextureSet, CheckerboardFieldsAndFilteredEdges) {
  Scene scene;
  const TextureId black = constant(scene, 0), white = constant(scene, 1);
  const TextureId board = add(scene, CheckerboardTexture{black, white, {}});
  const TextureSet set(scene, Context{});
  const auto at = [&](float u, float v, float du = 0, float dv = 0) {
    return set.sample(board, {.uv = {u, v}, .duv_dx = {du, 0}, .duv_dy = {0, dv}}).x;
  };
  EXPECT_EQ(at(0.5f, 0.5f), 0);
  EXPECT_EQ(at(1.5f, 0.5f), 1);
  EXPECT_EQ(at(-0.5f, 0.5f), 1);
  EXPECT_EQ(at(-0.5f, -0.5f), 0);
  EXPECT_EQ(at(1.5f, 1.5f), 0);
  // A box of width 0.4 centred 0.1 left of the edge: 1/4 of it lies beyond.
  EXPECT_NEAR(at(0.9f, 0.5f, 0.4f, 0.1f), 0.25f, 1e-5f);
  EXPECT_NEAR(at(0.9f, 0.9f, 0.4f, 0.4f), 2 * 0.25f * 0.75f, 1e-5f);
  // A box over exactly one period is grey; a huge one too.
  EXPECT_NEAR(at(0.3f, 0.3f, 2, 0.1f), 0.5f, 1e-5f);
  EXPECT_NEAR(at(0.3f, 0.3f, 1e9f, 1e9f), 0.5f, 1e-5f);
  EXPECT_TRUE(std::isfinite(at(1e20f, NAN, 1, INFINITY)));
}

TEST(TextureSet, MeansAreThoseOfTheUnitSquare) {
  Scene scene;
  const TextureId one = constant(scene, 1), three = constant(scene, 3);
  const TextureId board = add(scene, CheckerboardTexture{one, three, {glm::mat2(4, 0, 0, 4), {0, 0}}});
  const TextureId single = add(scene, CheckerboardTexture{one, three, {}});
  const TextureId image = add(scene, image_texture(add_image(scene, 2, 2, {1, 2, 3, 6}), TextureFilter::nearest));
  const TextureId product = add(scene, ScaleTexture{image, three});
  const TextureSet set(scene, Context{});
  EXPECT_NEAR(set.mean(board).x, 2, 1e-5f);
  EXPECT_NEAR(set.mean(single).x, 1, 1e-5f);
  EXPECT_NEAR(set.mean(image).x, 3, 1e-5f);
  EXPECT_NEAR(set.mean(product).x, 9, 1e-5f);
}

TEST(TextureSet, SharedOperandsCostOneEvaluationEach) {
  // Thirty squarings: evaluated as a tree this would take 2^30 look-ups.
  Scene scene;
  TextureId last = constant(scene, 1.f);
  for (int i = 0; i < 30; ++i) last = add(scene, ScaleTexture{last, last});
  const TextureSet set(scene, Context{});
  EXPECT_EQ(set.sample(last, {}).x, 1);
}

TEST(TextureSet, MissingOperandsAreWhite) {
  Scene scene;
  const TextureId scaled = add(scene, ScaleTexture{constant(scene, 5), {}});
  EXPECT_EQ(TextureSet(scene, Context{}).sample(scaled, {}).x, 5);
}

TEST(TextureSet, RejectsCyclesDeepGraphsAndBrokenImages) {
  {
    Scene scene;
    const TextureId own{std::size_t{0}};
    add(scene, ScaleTexture{own, own});
    EXPECT_THROW(TextureSet(scene, Context{}), Error);
  }
  {
    Scene scene;
    add(scene, ScaleTexture{TextureId(std::size_t{1}), {}});
    add(scene, MixTexture{{}, {}, TextureId(std::size_t{0})});
    EXPECT_THROW(TextureSet(scene, Context{}), Error);
  }
  {
    Scene scene;
    TextureId last = constant(scene, 1);
    for (int i = 0; i < 100; ++i) last = add(scene, ScaleTexture{last, {}});
    EXPECT_THROW(TextureSet(scene, Context{}), Error);
  }
  {
    Scene scene;
    add(scene, ScaleTexture{TextureId(std::size_t{9}), {}});
    EXPECT_THROW(TextureSet(scene, Context{}), Error);
  }
  {
    Scene scene;
    add(scene, ImageTexture{});
    EXPECT_THROW(TextureSet(scene, Context{}), Error);
  }
  {
    Scene scene;
    add(scene, image_texture(add_image(scene, 4, 4, {1, 2, 3})));
    EXPECT_THROW(TextureSet(scene, Context{}), Error);
  }
}

TEST(TextureSet, BatchEqualsSingleSamplesAndImagesAreSharedBetweenTextures) {
  Scene scene;
  std::vector<float> values(256 * 256);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>((i * 2654435761u) % 97u);
  const ImageId image = add_image(scene, 256, 256, values);
  const TextureId first = add(scene, image_texture(image));
  const TextureSet one(scene, Context{});
  ImageTexture clamped = image_texture(image);
  clamped.wrap_u = Wrap::clamp;
  add(scene, clamped);
  const TextureSet two(scene, Context{});
  EXPECT_LT(two.memory_bytes(), one.memory_bytes() + 1000);

  std::vector<TexturePoint> points;
  for (int i = 0; i < 50; ++i) points.push_back({{0.01f * static_cast<float>(i), 0.3f}, {0.002f * static_cast<float>(i), 0}, {0, 0.001f}});
  std::vector<Vec4> batch(points.size());
  one.sample(first, points, batch);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(batch[i], one.sample(first, points[i]));
}

}  // namespace
}  // namespace sightline
