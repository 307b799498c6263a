#include "texture/texel_codec.h"

#include <algorithm>
#include <cstddef>

#include "image/tone_map.h"

namespace sightline {

ByteDecoder make_byte_decoder(bool is_srgb) {
  ByteDecoder decoder;
  for (std::size_t i = 0; i < 256; ++i) {
    const float stored = static_cast<float>(i) / 255.f;
    decoder.alpha[i] = stored;
    decoder.color[i] = is_srgb ? linear_from_srgb(stored) : stored;
  }
  return decoder;
}

ByteEncoder::ByteEncoder(const std::array<float, 256>& decoded) {
  // Both curves are monotonic; the middle between neighbours is taken in linear light, which keeps means best.
  for (std::size_t i = 0; i + 1 < 256; ++i) upper_[i] = 0.5f * (decoded[i] + decoded[i + 1]);
  std::size_t byte = 0;
  for (std::size_t i = 0; i <= kGuesses; ++i) {
    const float value = static_cast<float>(i) / kGuesses;
    while (byte < 255 && value > upper_[byte]) ++byte;
    guess_[i] = static_cast<std::uint8_t>(byte);
  }
}

std::uint8_t ByteEncoder::operator()(float linear) const {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  std::uint8_t byte = guess_[static_cast<std::size_t>(linear * kGuesses)];
  while (byte < 255 && linear > upper_[byte]) ++byte;
  return byte;
}

std::vector<float> make_srgb_word_decoder() {
  std::vector<float> table(65536);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = linear_from_srgb(static_cast<float>(i) / 65535.f);
  return table;
}

}  // namespace sightline
