#include <gtest/gtest.h>

#include "base/core/error.h"
#include "image/io/image_io.h"
#include "unit/image/test_pictures.h"

namespace sightline {
namespace {

using test::append;
using test::bytes_of;

TEST(Pfm, RoundTripIsExactWithTheTopRowFirst) {
  const ColorImage image = test::random_picture(13, 5, 4);
  const Image back = parse_image(encode_pfm(image), "x.pfm");
  ASSERT_EQ(back.channels, 3);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 13; ++x) {
      for (int c = 0; c < 3; ++c) ASSERT_EQ(back.value(x, y, c), image.at(x, y)[c]);
    }
  }
}

TEST(Pfm, BigEndianGreyIsReadFromTheBottomUpAndScaled) {
  std::vector<std::byte> bytes = bytes_of("Pf\n1 2\n2.0\n");
  append(bytes, {0x3f, 0x80, 0, 0, 0x40, 0, 0, 0});  // 1, then 2
  const Image image = parse_image(bytes, "x.pfm");
  ASSERT_EQ(image.channels, 1);
  EXPECT_EQ(image.value(0, 0, 0), 4);
  EXPECT_EQ(image.value(0, 1, 0), 2);
}

TEST(Pfm, BadHeadersAreRefused) {
  for (const std::string_view header :
       {"PF\n0 1\n-1\n", "PF\n-1 1\n-1\n", "PF\n1 1\n0\n", "PF\n1 1\nnan\n", "PF\n1 x\n-1\n", "PF\n99999 99999\n-1\n", "PF\n1"}) {
    std::vector<std::byte> bytes = bytes_of(header);
    append(bytes, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    EXPECT_THROW(parse_image(bytes, "x.pfm"), Error) << header;
  }
}

}  // namespace
}  // namespace sightline
