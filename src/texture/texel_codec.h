// Stored texel values to linear numbers and back, by tables.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace sightline {

/// Linear values of the 256 bytes.
struct ByteDecoder {
  std::array<float, 256> color;  ///< of a colour channel: sRGB or linear
  std::array<float, 256> alpha;  ///< of an alpha channel: always linear
};
ByteDecoder make_byte_decoder(bool is_srgb);

/// The byte whose linear value is nearest, without a power function: a table gives a first guess that the exact thresholds between
/// neighbouring bytes correct.
class ByteEncoder {
 public:
  explicit ByteEncoder(const std::array<float, 256>& decoded);
  std::uint8_t operator()(float linear) const;

 private:
  static constexpr int kGuesses = 4096;
  std::array<float, 256> upper_{};                  ///< values above upper_[b] are nearer to b + 1
  std::array<std::uint8_t, kGuesses + 1> guess_{};  ///< a byte not above the right one
};

/// Linear values of the 65536 words of 16-bit sRGB colour.
std::vector<float> make_srgb_word_decoder();

}  // namespace sightline
