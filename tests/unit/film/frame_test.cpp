#include "film/frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "base/core/aligned.h"
#include "base/core/error.h"
#include "film/frame_file.h"

namespace sightline {
namespace {

void fill(Frame& frame, SampleRange range) {
  for (std::uint32_t pixel = 0; pixel < static_cast<std::uint32_t>(frame.width() * frame.height()); ++pixel) {
    for (std::uint32_t s = range.begin; s < range.end; ++s) {
      const float v = std::sin(static_cast<float>(pixel * 31 + s)) + 1.1f;
      frame.add_color(pixel, s, Color(v, v * 0.3f, v * v));
      frame.add(Aov::albedo, pixel, Vec3(v));
    }
  }
  for (std::size_t tile = 0; tile < frame.tile_count(); ++tile) frame.set_samples_done(tile, frame.samples_done(tile) + range.count());
}

AovSet some_layers() {
  AovSet aovs = parse_aovs("albedo,variance");
  return aovs;
}

// 16 pixels with `count` samples whose values are drawn by `value`, once in one go and once sample by sample.
template <class Value>
std::pair<Frame, Frame> by_block_and_by_sample(std::uint32_t count, AovSet aovs, Value value) {
  std::pair<Frame, Frame> frames{Frame(16, 1, aovs), Frame(16, 1, aovs)};
  std::vector<std::uint32_t> pixel(16);
  std::vector<std::uint8_t> inside(16, 1);
  std::iota(pixel.begin(), pixel.end(), 0u);
  inside[5] = 0;
  Vec3Batch values;
  values.resize(std::size_t{16} * count);
  for (std::uint32_t i = 0; i < 16 * count; ++i) {
    const Color c(value(), value(), value());
    values.x[i] = c.x, values.y[i] = c.y, values.z[i] = c.z;
    if (i % 16 == 5) continue;
    frames.second.add_color(i % 16, 3 + i / 16, c);
    frames.second.add(Aov::albedo, i % 16, c);
  }
  const PixelBlock block{pixel.data(), inside.data(), 3, count, {values.x.data(), values.y.data(), values.z.data()}};
  frames.first.add_color(block);
  frames.first.add(Aov::albedo, block);
  return frames;
}

TEST(Frame, BlocksOfSamplesGiveTheSameBitsAsSingleOnes) {
  AovSet aovs;
  aovs.add(Aov::albedo);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> ordinary(0.f, 4.f), exponent(-80.f, 80.f);
  const auto compare = [&](std::uint32_t count, AovSet layers, auto value) {
    const auto [block, single] = by_block_and_by_sample(count, layers, value);
    for (const Aov aov : {Aov::color, Aov::albedo, Aov::variance}) {
      const auto a = block.sums(aov), b = single.sums(aov);
      EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
    }
    EXPECT_EQ(block.nonfinite_samples(), single.nonfinite_samples());
    EXPECT_EQ(block.saturated_samples(), single.saturated_samples());
    EXPECT_EQ(block.first_bad_sample().has_value(), single.first_bad_sample().has_value());
  };
  for (const std::uint32_t count : {1u, 2u, 64u, 128u, 129u}) {
    compare(count, aovs, [&] { return ordinary(random); });
    compare(count, aovs, [&] { return random() % 2 ? 0.f : -ordinary(random); });
    compare(count, aovs, [&] { return std::exp2(exponent(random)); });  // most need more than 64 bits
  }
  // The most that 64 bits must hold: 128 samples just below the limit.
  compare(128, aovs, [&] { return std::nextafter(0x1p15f, 0.f); });
  compare(4, aovs, [&] { return random() % 7 ? 1.f : std::numeric_limits<float>::quiet_NaN(); });
  AovSet with_variance = aovs;
  with_variance.add(Aov::variance);
  compare(8, with_variance, [&] { return ordinary(random); });
}

// The same samples, one a pixel, block by block.
std::pair<Frame, Frame> summed_and_single(const std::vector<Color>& samples) {
  std::pair<Frame, Frame> frames{Frame(16, 4, {}), Frame(16, 4, {}, 0, Frame::Colors::single)};
  for (Frame* frame : {&frames.first, &frames.second}) {
    for (std::uint32_t row = 0; row < 4; ++row) {
      std::vector<std::uint32_t> pixel(16);
      std::iota(pixel.begin(), pixel.end(), 16 * row);
      std::vector<std::uint8_t> inside(16, 1);
      inside[row] = 0;
      Vec3Batch values;
      values.resize(16);
      for (std::size_t i = 0; i < 16; ++i)
        values.x[i] = samples[16 * row + i].x, values.y[i] = samples[16 * row + i].y, values.z[i] = samples[16 * row + i].z;
      frame->add_color({pixel.data(), inside.data(), 0, 1, {values.x.data(), values.y.data(), values.z.data()}});
    }
    frame->set_samples_done(0, 1);
  }
  return frames;
}

TEST(Frame, SingleColorsAreThoseOfSumsBitForBit) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> ordinary(-4.f, 4.f), exponent(-80.f, 80.f);
  const auto compare = [&](auto value) {
    std::vector<Color> samples(64);
    for (Color& c : samples) c = {value(), value(), value()};
    const auto [summed, single] = summed_and_single(samples);
    ASSERT_TRUE(single.has_single_colors());
    const ColorImage a = summed.color_image(), b = single.color_image();
    for (std::uint32_t i = 0; i < 64; ++i) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(a.pixels[i][c]), std::bit_cast<std::uint32_t>(b.pixels[i][c]));
        EXPECT_EQ(summed.color(i)[c], single.color(i)[c]);
      }
    }
    EXPECT_EQ(summed.nonfinite_samples(), single.nonfinite_samples());
    EXPECT_EQ(summed.saturated_samples(), single.saturated_samples());
  };
  compare([&] { return ordinary(random); });
  compare([&] { return random() % 2 ? 0.f : -0.f; });
  compare([&] { return std::exp2(exponent(random)); });
  compare([&] { return random() % 9 ? 1.f : std::numeric_limits<float>::infinity(); });
}

TEST(Frame, SingleColorsTakeAQuarterOfTheMemory) {
  const Frame summed(320, 320, {}), single(320, 320, {}, 0, Frame::Colors::single);
  EXPECT_LT(4 * single.memory_bytes(), summed.memory_bytes() + 4 * 4 * single.tile_count());
  // Whose spread is asked for needs its sums.
  AovSet aovs;
  aovs.add(Aov::variance);
  EXPECT_FALSE(Frame(16, 16, aovs, 0, Frame::Colors::single).has_single_colors());
}

TEST(Frame, TilesCoverEveryPixelOnce) {
  const Frame frame(100, 67, {});
  std::vector<int> covered(100 * 67);
  for (std::size_t t = 0; t < frame.tile_count(); ++t) {
    const Tile tile = frame.tile(t);
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) ++covered[static_cast<std::size_t>(y * 100 + x)];
    }
  }
  for (const int count : covered) EXPECT_EQ(count, 1);
}

TEST(Frame, MergedRangesEqualOneRunBitForBit) {
  Frame whole(40, 33, some_layers()), first(40, 33, some_layers()), second(40, 33, some_layers(), 3);
  fill(whole, {0, 10});
  fill(first, {0, 3});
  fill(second, {3, 10});
  second.merge(first);
  EXPECT_EQ(second.first_sample(), 0u);
  EXPECT_EQ(second.samples_done(), 10u);
  for (const AovInfo& info : aov_table()) {
    const std::span<const ExactSum> a = whole.sums(info.id), b = second.sums(info.id);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i], b[i]);
  }
}

TEST(Frame, DropsAndCountsWhatIsNotFinite) {
  Frame frame(4, 4, {});
  frame.add_color(5, 7, Color(std::numeric_limits<float>::quiet_NaN(), 1, 1));
  frame.add_color(3, 9, Color(1, std::numeric_limits<float>::infinity(), 1));
  frame.add_color(3, 1, Color(2, 2, 2));
  frame.set_samples_done(0, 1);
  EXPECT_EQ(frame.nonfinite_samples(), 2u);
  ASSERT_TRUE(frame.first_bad_sample());
  EXPECT_EQ(frame.first_bad_sample()->pixel, 3u);
  EXPECT_EQ(frame.first_bad_sample()->sample, 9u);
  EXPECT_EQ(frame.color(3), Color(2));
  EXPECT_EQ(frame.color(5), Color(0));
}

TEST(Frame, EstimatesTheErrorOfItsMean) {
  // Pixels of value 0 or 2 with equal chance over n samples: relative standard error 1 / sqrt(n - 1).
  Frame frame(8, 8, parse_aovs("variance"));
  constexpr std::uint32_t kSamples = 64;
  for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
    for (std::uint32_t s = 0; s < kSamples; ++s) frame.add_color(pixel, s, Color(s % 2 ? 2.f : 0.f));
  }
  frame.set_samples_done(0, kSamples);
  ASSERT_TRUE(frame.estimated_error());
  EXPECT_NEAR(*frame.estimated_error(), 1 / std::sqrt(kSamples - 1.0), 1e-6);
}

TEST(FrameFile, RoundTripKeepsEveryBit) {
  Frame frame(40, 33, some_layers(), 5);
  fill(frame, {5, 9});
  const std::vector<std::byte> bytes = encode_frame(frame, {"identity"}, "{\"a\":1}");
  const StoredFrame stored = decode_frame(bytes, "test");
  EXPECT_EQ(stored.identity.text, "identity");
  EXPECT_EQ(stored.note, "{\"a\":1}");
  EXPECT_EQ(stored.frame.first_sample(), 5u);
  EXPECT_EQ(stored.frame.samples_done(), 4u);
  for (const AovInfo& info : aov_table()) {
    const std::span<const ExactSum> a = frame.sums(info.id), b = stored.frame.sums(info.id);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i], b[i]);
  }
}

TEST(FrameFile, DamageIsAnInputErrorAtEveryByte) {
  Frame frame(9, 7, {});
  fill(frame, {0, 2});
  const std::vector<std::byte> bytes = encode_frame(frame, {"x"}, "");
  for (std::size_t cut = 0; cut < bytes.size(); cut += 7) EXPECT_THROW(decode_frame(std::span(bytes).first(cut), "cut"), Error);
  for (std::size_t i = 0; i < bytes.size(); i += 5) {
    std::vector<std::byte> damaged = bytes;
    damaged[i] ^= std::byte{0x41};
    EXPECT_THROW(decode_frame(damaged, "damaged"), Error) << "byte " << i;
  }
}

TEST(Aov, UnknownLayerNamesTheNearest) {
  try {
    parse_aovs("albedo,norml");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("normal"), std::string::npos);
  }
  EXPECT_TRUE(parse_aovs("all").has(Aov::depth));
}

TEST(Aov, ColourAndAlphaAreTheChannelsThatReadersLookFor) {
  Frame frame(2, 1, parse_aovs("alpha,albedo"));
  frame.add_color(0, 0, Color(3));
  frame.add(Aov::alpha, 0, Vec3(1));
  frame.set_samples_done(0, 2);
  const LayeredImage image = frame.to_layered_image();
  for (const char* name : {"R", "G", "B", "A", "albedo.R"}) EXPECT_NE(image.find(name), nullptr) << name;
  EXPECT_EQ(image.find("A")->values, (std::vector<float>{0.5f, 0}));
  EXPECT_EQ(image.find("R")->values, (std::vector<float>{1.5f, 0})) << "colour is premultiplied: the mean over covered and empty samples";
  const LayeredImage plain = Frame(2, 1, {}).to_layered_image();
  EXPECT_EQ(plain.find("A"), nullptr);
}

TEST(Frame, ColoursAreTheSumsRoundedOnceHoweverLarge) {
  Frame frame(40, 33, {});
  std::uint32_t random = 1;
  std::span<ExactSum> sums = frame.sums(Aov::color);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    // Any number of leading bits, of either sign, with all the bits that follow.
    Int128 value = 0;
    for (int k = 0; k < 4; ++k) random = random * 1664525u + 1013904223u, value = (value << 32) | random;
    value >>= i % 127;
    sums[i].value = i % 2 ? -value : value;
  }
  for (std::size_t tile = 0; tile < frame.tile_count(); ++tile) frame.set_samples_done(tile, 3);
  const ColorImage image = frame.color_image();
  for (std::uint32_t pixel = 0; pixel < 40 * 33; ++pixel) {
    for (int c = 0; c < 3; ++c) {
      const float expected = static_cast<float>(sums[3 * pixel + static_cast<std::size_t>(c)].to_double() / 3);
      ASSERT_EQ(frame.color(pixel)[c], expected) << pixel;
      ASSERT_EQ(image.pixels[pixel][c], expected) << pixel;
    }
  }
}

}  // namespace
}  // namespace sightline
